#include "constraints/contact/contact_effect.h"

#include <cmath>

#include "engine/base/text.h"

namespace isochor {

Result<void> check_numbers(const std::string& who, std::span<const ContactNumber> numbers) {
  for (const auto& [key, value, unit] : numbers) {
    if (value >= 0 && std::isfinite(value)) continue;
    return Error{who + key + " = " + number(value) + (*unit ? " " : "") + unit +
                 "; it must be zero or positive"};
  }
  return {};
}

Result<void> check_static_friction(const std::string& who, double friction, double static_friction) {
  if (!(static_friction > 0 && static_friction < friction)) return {};
  return Error{who + "static_friction = " + number(static_friction) + " with friction = " + number(friction) +
               "; it must not be the smaller one, or 0 for the same"};
}

Result<void> check_resolve_time(const std::string& who, double resolve_time) {
  if (resolve_time > 0) return {};
  return Error{who + "resolve_time = " + number(resolve_time) + " s; it must be positive"};
}

Overlap take_overlap(std::span<const double> gap, double groove, double length, ContactRows& rows) {
  const double rounding = -1e-9 * length;
  Overlap out;
  std::vector<double> overlap(gap.size(), 0.0), allowed = overlap;
  bool grooved = false;
  for (std::size_t r = 0; r < gap.size(); ++r) {
    if (!(gap[r] < 0)) continue;
    if (gap[r] >= -groove) {
      allowed[r] = gap[r];
      grooved = true;
      continue;
    }
    overlap[r] = gap[r];
    if (gap[r] >= rounding) continue;
    ++out.count;
    if (out.worst >= 0 && gap[r] >= out.deepest) continue;
    out.worst = static_cast<Index>(r);
    out.deepest = gap[r];
  }
  if (grooved) rows.allowed = std::move(allowed);
  if (out.worst >= 0) rows.overlap = std::move(overlap);
  return out;
}

void add_gauges(std::string_view effect, const ContactTotals& t, std::vector<Gauge>& out) {
  const auto put = [&](const char* quantity, const char* unit, double value) {
    out.push_back({std::string(effect), "contact", quantity, unit, value});
  };
  put("force_x", "N", t.force.x);
  put("force_y", "N", t.force.y);
  put("force_z", "N", t.force.z);
  put("normal_force", "N", t.normal);
  put("friction_force", "N", t.tangential);
  put("contact_area", "m2", t.area);
  put("largest_pressure", "Pa", t.pressure);
  put("smallest_gap", "m", t.gap);
  put("depth_over_face", "", t.depth);
}

}  // namespace isochor
