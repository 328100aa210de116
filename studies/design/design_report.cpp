#include "studies/design/design_report.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "studies/inverse/data_report.h"

namespace isochor::design {

namespace {

using inverse::full;
using studies::text;

std::string name_of(const BodyMove& move) {
  return move.body + ":" + move.surface + (move.along == 'n' ? "" : std::string(".") + move.along);
}

double mean_deviation(const Design& design) {
  double squares = 0;
  for (const double d : design.deviation) squares += d * d;
  return std::sqrt(squares / static_cast<double>(std::max<std::size_t>(1, design.deviation.size())));
}

}  // namespace

const char* word(const Design& design) {
  return design.reached ? "reached" : design.converged ? "nearest" : "not converged";
}

std::string design_json(const Design& design) {
  using Json = nlohmann::ordered_json;
  Json out{{"end", word(design)},
           {"reason", design.reason},
           {"note", design.note},
           {"noise", design.noise},
           {"error_before", design.error_before},
           {"error", design.error}};
  out["moves"] = Json::array();
  for (const DesignedMove& m : design.moves) {
    out["moves"].push_back({{"surface", name_of(m.move)},
                            {"value", m.value},
                            {"least", m.move.least},
                            {"most", m.move.most},
                            {"at_bound", m.at_bound}});
  }
  if (!design.moves.empty()) {
    out["quality"] = design.quality;
    out["volume_before"] = design.volume_before;
    out["volume"] = design.volume;
  }
  if (!design.factor.empty()) {
    const auto [least, most] = std::minmax_element(design.factor.begin(), design.factor.end());
    out["field"] = {{"cells", design.factor.size()},
                    {"least", *least},
                    {"most", *most},
                    {"deviation", mean_deviation(design)}};
  }
  return out.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string history_csv(const Design& design) {
  std::string out = "iteration,error,quality,volume";
  for (const DesignedMove& m : design.moves) out += "," + name_of(m.move);
  out += "\n";
  for (const DesignStep& s : design.history) {
    out += std::to_string(s.iteration) + "," + full(s.error) + "," + full(s.quality) + "," + full(s.volume);
    for (const double v : s.moves) out += "," + full(v);
    out += "\n";
  }
  return out;
}

std::string field_csv(const Design& design) {
  std::string out = "cell,factor,deviation\n";
  for (std::size_t c = 0; c < design.factor.size(); ++c)
    out += std::to_string(c) + "," + full(design.factor[c]) + "," + full(design.deviation[c]) + "\n";
  return out;
}

std::vector<std::string> summary_lines(const Design& design) {
  std::vector<std::string> out;
  for (const DesignedMove& m : design.moves)
    out.push_back(name_of(m.move) + " moves by " + text(1e3 * m.value, 5) + " mm" +
                  (m.at_bound ? ", at a bound" : ""));
  if (!design.moves.empty()) {
    out.push_back("volume " + text(1e6 * design.volume, 5) + " cm^3, before " +
                  text(1e6 * design.volume_before, 5) + "; least J of the mesh against itself before " +
                  text(design.quality));
  }
  if (!design.factor.empty()) {
    const auto [least, most] = std::minmax_element(design.factor.begin(), design.factor.end());
    out.push_back(std::to_string(design.factor.size()) + " cells, factors " + text(*least) + " to " +
                  text(*most) + "; the data leave ± " + text(mean_deviation(design)) +
                  " of their logarithms (standard deviation, root mean square over cells)");
  }
  out.push_back("errors " + text(design.error * design.noise) + " of the largest change (before " +
                text(design.error_before * design.noise) + ", to be met " + text(design.noise) +
                "): " + word(design));
  return out;
}

studies::Page design_page(const Design& design) {
  studies::Page page;
  page.title = "Design of " + design.scene.name;
  page.subtitle = word(design);
  if (!design.reason.empty()) page.notes.push_back(design.reason);
  if (!design.reached && !design.note.empty()) page.notes.push_back(design.note);
  studies::Section found{"What was found", ""};
  studies::Table table{"", {"surface", "moves by [mm]", "least [mm]", "most [mm]", ""}, {}};
  for (const DesignedMove& m : design.moves) {
    table.rows.push_back({name_of(m.move), text(1e3 * m.value, 5), text(1e3 * m.move.least, 5),
                          text(1e3 * m.move.most, 5), m.at_bound ? "at a bound" : ""});
  }
  if (!table.rows.empty()) found.tables.push_back(std::move(table));
  for (const std::string& line : summary_lines(design)) found.text += (found.text.empty() ? "" : ". ") + line;
  page.run = {{"Scene", design.scene.name},
              {"Steps", std::to_string(std::max<std::size_t>(design.history.size(), 1) - 1)}};
  studies::Diagram way;
  way.title = "The way";
  way.x = "step";
  way.y = "error, over the largest change";
  way.log_y = true;
  way.lines.push_back({"error", {}, {}});
  for (const DesignStep& s : design.history) {
    way.lines[0].x.push_back(s.iteration);
    way.lines[0].y.push_back(std::max(1e-16, s.error * design.noise));
  }
  found.diagrams.push_back(std::move(way));
  for (studies::Diagram& d :
       inverse::data_diagrams(design.data, "wanted", {{"found", &design.found}, {"before", &design.before}}))
    found.diagrams.push_back(std::move(d));
  page.sections.push_back(std::move(found));
  return page;
}

}  // namespace isochor::design
