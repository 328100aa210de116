#include "studies/fit/report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <tuple>

#include "engine/elements/material_model.h"

namespace isochor::fit {

namespace {

using Json = nlohmann::ordered_json;

std::string shown(const char* format, double a, double b = 0) {
  char text[80];
  std::snprintf(text, sizeof text, format, a, b);
  return text;
}

std::string with_interval(const FittedConstant& c) {
  const bool stress = c.unit == "Pa";
  const double scale = stress ? 1e-3 : 1;
  std::string text = c.name + " " + shown("%.4g", scale * c.value);
  text += std::isfinite(c.half_width) ? shown(" ± %.2g", scale * c.half_width) : " ± ?";
  return text + (stress ? " kPa" : "");
}

Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json fit_json(const Fit& fit) {
  Json constants = Json::array();
  for (const FittedConstant& c : fit.constants) {
    constants.push_back({{"name", c.name},
                         {"unit", c.unit},
                         {"value", number(c.value)},
                         {"half_width_95", number(c.half_width)},
                         {"at_bound", c.at_bound}});
  }
  Json uncertainty = Json::object();
  for (const auto& [mode, value] : fit.uncertainty) uncertainty[mode] = number(value);
  Json out{
      {"law", fit.law}, {"status", fit.converged ? "converged" : "not_converged"}, {"reason", fit.reason}};
  out["constants"] = constants;
  out["material"] = fit.keys.empty() ? Json(nullptr) : Json::parse(fit.keys);
  out["shear_modulus"] = number(fit.shear_modulus);
  out["r2"] = number(fit.r2);
  out["rms"] = number(fit.rms);
  out["worst"] = number(fit.worst);
  out["stable"] = {number(fit.stable_from), number(fit.stable_to)};
  out["stable_in_data"] = fit.stable_in_data;
  out["looked_at"] = {number(fit.looked_from), number(fit.looked_to)};
  out["uncertainty_95"] = uncertainty;
  out["warnings"] = fit.warnings;
  return out;
}

studies::Line predicted(const Fit& fit, Mode mode, double from, double to) {
  studies::Line line{fit.law, {}, {}};
  const auto material = material_of(fit);
  constexpr int points = 48;
  for (int i = 0; material && i <= points; ++i) {
    const double s = from + (to - from) * i / points;
    const double y = stress(*material.value(), mode, s);
    if (!std::isfinite(y)) continue;
    line.x.push_back(s);
    line.y.push_back(1e-3 * y);
  }
  return line;
}

studies::Diagram diagram_of(const Curve& curve, const std::vector<Fit>& fits) {
  studies::Diagram d;
  d.title = curve.name + ", " + word(curve.mode);
  d.text = curve.note;
  d.x = "stretch";
  d.y = "nominal stress [kPa]";
  studies::Line measured{"measured", curve.stretch, {}};
  measured.dashed = true;
  for (const double s : curve.stress) measured.y.push_back(1e-3 * s);
  d.lines.push_back(measured);
  const auto [from, to] = std::minmax_element(curve.stretch.begin(), curve.stretch.end());
  for (const Fit* f : by_error(fits)) {
    if (!f->keys.empty())
      d.lines.push_back(predicted(*f, curve.mode, std::min(1.0, *from), std::max(1.0, *to)));
  }
  return d;
}

// Where laws differ that the data do not tell apart.
studies::Section unmeasured(const std::vector<Curve>& curves, const std::vector<Fit>& fits) {
  studies::Section section{
      "Modes that were not measured",
      "What the fitted laws answer there, in the range of stretch that was measured: their spread is what "
      "these data leave open. Laws that turn over inside the data are left out."};
  const Range measured = range_of(curves);
  for (const Mode mode : {Mode::uniaxial, Mode::equibiaxial, Mode::pure_shear}) {
    if (std::any_of(curves.begin(), curves.end(), [&](const Curve& c) { return c.mode == mode; })) continue;
    studies::Diagram d;
    d.title = word(mode);
    d.x = "stretch";
    d.y = "nominal stress [kPa]";
    for (const Fit* f : by_error(fits)) {
      if (f->stable_in_data) d.lines.push_back(predicted(*f, mode, measured.least, measured.most));
    }
    section.diagrams.push_back(d);
  }
  return section;
}

}  // namespace

std::string constants_text(const Fit& fit) {
  std::string text;
  for (const FittedConstant& c : fit.constants) text += (text.empty() ? "" : ", ") + with_interval(c);
  return text;
}

std::vector<const Fit*> by_error(const std::vector<Fit>& fits) {
  std::vector<const Fit*> order;
  for (const Fit& f : fits) order.push_back(&f);
  std::stable_sort(order.begin(), order.end(), [](const Fit* a, const Fit* b) {
    return std::tuple(!a->converged, !a->stable_in_data, a->rms) <
           std::tuple(!b->converged, !b->stable_in_data, b->rms);
  });
  return order;
}

std::vector<std::string> table_head() {
  return {"law", "R2", "rms kPa", "mu kPa", "stable stretch", "constants (± 95 %)"};
}

std::vector<std::string> table_row(const Fit& fit) {
  if (fit.keys.empty()) return {fit.law, "-", "-", "-", "-", fit.reason};
  return {fit.law,
          shown("%.5f", fit.r2),
          shown("%.3g", 1e-3 * fit.rms),
          shown("%.4g", 1e-3 * fit.shear_modulus),
          shown("%.3g to %.3g", fit.stable_from, fit.stable_to),
          constants_text(fit) + (fit.converged ? "" : " (" + fit.reason + ")")};
}

std::string fits_json(const std::vector<Curve>& curves, const std::vector<Fit>& fits) {
  Json out{{"curves", Json::array()}, {"fits", Json::array()}};
  for (const Curve& c : curves) {
    out["curves"].push_back({{"name", c.name},
                             {"mode", word(c.mode)},
                             {"points", c.stretch.size()},
                             {"note", c.note},
                             {"largest_stretch", *std::max_element(c.stretch.begin(), c.stretch.end())}});
  }
  for (const Fit* f : by_error(fits)) out["fits"].push_back(fit_json(*f));
  return out.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string fits_csv(const std::vector<Curve>& curves, const std::vector<Fit>& fits) {
  std::string out = "curve,mode,stretch,measured_Pa";
  std::vector<MaterialPtr> materials;
  for (const Fit* f : by_error(fits)) {
    auto material = material_of(*f);
    if (!material) continue;
    materials.push_back(material.value());
    out += "," + f->law + "_Pa";
  }
  out += "\n";
  for (const Curve& c : curves) {
    for (std::size_t i = 0; i < c.stretch.size(); ++i) {
      std::string name = c.name;
      std::replace(name.begin(), name.end(), ',', ' ');
      out += name + "," + word(c.mode) + shown(",%.10g,%.10g", c.stretch[i], c.stress[i]);
      for (const MaterialPtr& m : materials) out += shown(",%.10g", stress(*m, c.mode, c.stretch[i]));
      out += "\n";
    }
  }
  return out;
}

studies::Page fits_page(const std::vector<Curve>& curves, const std::vector<Fit>& fits) {
  studies::Page page;
  page.title = curves.size() == 1 ? curves.front().name : std::to_string(curves.size()) + " curves";
  page.subtitle = "Material laws fitted to measured stress; incompressible";
  page.footer =
      "Intervals hold for errors of the measurement that are independent and alike; how far a law is from "
      "the "
      "material they do not say.";
  studies::Section section{
      "Fits", "In the order of their errors, those that turn over inside the data behind the others."};
  for (const Curve& curve : curves) section.diagrams.push_back(diagram_of(curve, fits));
  studies::Table table{"", table_head(), {}};
  studies::Table warnings{"What to mind", {"law", "warning"}, {}};
  for (const Fit* f : by_error(fits)) {
    if (!f->converged) table.failed.push_back(table.rows.size());
    table.rows.push_back(table_row(*f));
    for (const std::string& w : f->warnings) warnings.rows.push_back({f->law, w});
  }
  section.tables.push_back(table);
  if (!warnings.rows.empty()) section.tables.push_back(warnings);
  page.sections.push_back(section);
  if (auto more = unmeasured(curves, fits); !more.diagrams.empty()) page.sections.push_back(more);
  return page;
}

}  // namespace isochor::fit
