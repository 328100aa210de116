#include "studies/fit/scene_report.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "engine/base/text.h"
#include "studies/inverse/data_report.h"

namespace isochor::fit {

namespace {

using Json = nlohmann::ordered_json;

Json finite(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

}  // namespace

std::vector<std::string> scene_table_head() {
  return {"constant", "value", "± 95 %", "began at", ""};
}

std::vector<std::vector<std::string>> scene_table_rows(const SceneFit& fit) {
  std::vector<std::vector<std::string>> rows;
  for (std::size_t i = 0; i < fit.constants.size(); ++i) {
    const FittedConstant& c = fit.constants[i];
    rows.push_back({c.name, studies::text(c.value, 8),
                    std::isfinite(c.half_width) ? studies::text(c.half_width, 2) : "?", number(fit.start[i]),
                    c.at_bound ? "at a bound" : ""});
  }
  return rows;
}

std::string scene_fit_json(const std::vector<Experiment>& experiments, const SceneFit& fit) {
  Json out{{"status", fit.converged ? "converged" : "not_converged"}, {"reason", fit.reason}};
  out["constants"] = Json::array();
  for (std::size_t i = 0; i < fit.constants.size(); ++i) {
    const FittedConstant& c = fit.constants[i];
    out["constants"].push_back({{"path", c.name},
                                {"value", finite(c.value)},
                                {"half_width_95", finite(c.half_width)},
                                {"start", fit.start[i]},
                                {"at_bound", c.at_bound}});
  }
  out["rms"] = finite(fit.rms);
  out["experiments"] = Json::array();
  for (std::size_t k = 0; k < experiments.size(); ++k) {
    Json one{{"name", experiments[k].name},
             {"numbers", experiments[k].data.values.size()},
             {"weight", experiments[k].weight}};
    if (k < fit.experiment_rms.size()) one["rms"] = finite(fit.experiment_rms[k]);
    out["experiments"].push_back(std::move(one));
  }
  out["warnings"] = fit.warnings;
  out["iterations"] = fit.iterations;
  return out.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

studies::Page scene_fit_page(const std::vector<Experiment>& experiments, const SceneFit& fit) {
  studies::Page page;
  page.title = "Constants of " + experiments.front().scene.name;
  page.subtitle = "Fitted to " + std::to_string(experiments.size()) +
                  (experiments.size() == 1 ? " experiment" : " experiments");
  page.footer = "Intervals hold for errors of the measurement that are independent and alike.";
  if (!fit.converged) page.notes.push_back(fit.reason);
  for (const std::string& w : fit.warnings) page.notes.push_back(w);
  studies::Section constants{"Constants", ""};
  constants.tables.push_back({"", scene_table_head(), scene_table_rows(fit)});
  page.sections.push_back(std::move(constants));
  for (std::size_t k = 0; k < experiments.size() && k < fit.fitted.size(); ++k) {
    studies::Section section{experiments[k].name,
                             "Root mean square of the errors, over the largest change of their kind: " +
                                 studies::text(fit.experiment_rms[k])};
    section.diagrams = inverse::data_diagrams(experiments[k].data, "measured", {{"fitted", &fit.fitted[k]}});
    page.sections.push_back(std::move(section));
  }
  return page;
}

}  // namespace isochor::fit
