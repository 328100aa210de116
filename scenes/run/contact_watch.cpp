#include "scenes/run/contact_watch.h"

#include <cmath>
#include <limits>

#include "engine/base/text.h"

namespace isochor {

void ContactWatch::look(double time, const std::vector<Gauge>& gauges) {
  struct Step {
    double force = 0, gap = std::numeric_limits<double>::infinity(), depth = 0, pressure = 0;
  };
  std::map<std::string, Step> steps;
  for (const Gauge& g : gauges) {
    if (g.kind != "contact") continue;
    Step& s = steps[g.effect];
    if (g.quantity == "normal_force") s.force = g.value;
    if (g.quantity == "smallest_gap") s.gap = g.value;
    if (g.quantity == "depth_over_face") s.depth = g.value;
    if (g.quantity == "largest_pressure") s.pressure = g.value;
  }
  for (const auto& [name, s] : steps) {
    const auto [it, fresh] = contacts_.try_emplace(name);
    Contact& c = it->second;
    c.touched = c.touched || s.force > 0;
    if (fresh || s.gap < c.smallest_gap) {
      c.smallest_gap = s.gap;
      c.gap_time = time;
    }
    if (!(s.depth > c.deepest)) continue;
    c.deepest = s.depth;
    c.depth_time = time;
    c.pressure = s.pressure;
  }
}

std::vector<std::string> ContactWatch::findings() const {
  constexpr double deep = 0.05;  // of a face
  std::vector<std::string> out;
  for (const auto& [name, c] : contacts_) {
    const std::string who = "contact \"" + name + "\"";
    if (!c.touched) {
      std::string text = who + " never touched: nothing pressed at the end of any step";
      if (std::isfinite(c.smallest_gap))
        text += ", the smallest distance was " + number(c.smallest_gap) + " m at t = " + number(c.gap_time);
      out.push_back(text +
                    "; if it should, check its surfaces, where they are, and which way the obstacle or the "
                    "bodies move");
    }
    if (c.deepest > deep) {
      out.push_back(
          who + ": the layer between its surfaces gave way by " + number(std::round(1000 * c.deepest) / 10) +
          " % of the size of a face at t = " + number(c.depth_time) + ", under " + number(c.pressure) +
          " Pa, so shapes and forces there are off by about as much; give it a smaller compliance, or "
          "leave compliance out");
    }
  }
  return out;
}

}  // namespace isochor
