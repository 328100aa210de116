#include "scenes/run/run_page.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "scenes/run/section_plane.h"

namespace isochor {

namespace {

std::string number(double v, const char* format = "%.4g") {
  char text[48];
  std::snprintf(text, sizeof text, format, v);
  return text;
}

}  // namespace

namespace {

template <class Value>
PageSeries series(const RunResult& r, const char* group, const std::string& name, const char* unit,
                  Value value) {
  PageSeries s{group, name, unit};
  for (const StepRecord& record : r.records) {
    s.x.push_back(record.time);
    s.y.push_back(value(record));
  }
  return s;
}

// Volumes, energies and momentum.
void add_measures(const RunView& view, std::vector<PageSeries>& out) {
  const RunResult& r = view.result;
  const std::size_t parts = r.records.empty() ? 0 : r.records.front().parts.size();
  for (std::size_t p = 0; p < parts; ++p) {
    out.push_back(series(r, "Change of volume", r.records.front().parts[p].name, "%",
                         [p](const StepRecord& s) { return 100 * s.parts[p].volume_change(); }));
  }
  const bool moves = view.scene.analysis.type == AnalysisType::dynamics;
  const auto energy = [&](const char* name, auto value) {
    auto s = series(r, "Energies", name, "J", value);
    // Of what the scene does not have there is no curve.
    if (std::any_of(s.y.begin(), s.y.end(), [](double v) { return v != 0; })) out.push_back(std::move(s));
  };
  energy("elastic", [](const StepRecord& s) { return s.energy.elastic; });
  energy("kinetic", [](const StepRecord& s) { return s.energy.kinetic; });
  energy("of the weight", [](const StepRecord& s) { return s.energy.gravity; });
  energy("of loads", [](const StepRecord& s) { return s.load_potential(); });
  energy("total", [](const StepRecord& s) { return s.total_energy(); });
  for (std::size_t kind = 0; moves && kind < 2; ++kind) {
    for (int k = 0; k < 3; ++k) {
      out.push_back(series(r, kind == 0 ? "Linear momentum" : "Angular momentum", std::string(1, "xyz"[k]),
                           kind == 0 ? "kg m/s" : "kg m\u00b2/s",
                           [kind, k](const StepRecord& s) { return s.momentum[kind][k]; }));
    }
  }
}

std::vector<PageSeries> all_series(const RunView& view) {
  const RunResult& r = view.result;
  std::vector<PageSeries> out;
  for (std::size_t c = 0; c < r.cavities.size(); ++c) {
    out.push_back(series(r, "Chambers", r.cavities[c] + " pressure", "Pa",
                         [c](const StepRecord& s) { return s.cavities[c].pressure; }));
    out.push_back(series(r, "Chambers", r.cavities[c] + " volume", "m\u00b3",
                         [c](const StepRecord& s) { return s.cavities[c].volume; }));
  }
  for (std::size_t i = 0; !r.records.empty() && i < r.records.front().gauges.size(); ++i) {
    const Gauge& g = r.records.front().gauges[i];
    const bool turn = g.kind == "orientation";
    const std::string unit = g.unit == "1" ? "" : g.unit;
    out.push_back(series(r, turn ? "Orientations" : "Gauges", g.effect + " " + g.quantity, unit.c_str(),
                         [i](const StepRecord& s) { return s.gauges[i].value; }));
  }
  for (std::size_t p = 0; p < r.probes.size(); ++p) {
    for (int k = 0; k < 3; ++k) {
      out.push_back(series(r, "Probes", r.probes[p] + " " + "xyz"[k], "m",
                           [p, k](const StepRecord& s) { return s.probes[p][k]; }));
    }
  }
  add_measures(view, out);
  out.push_back(series(r, "Newton iterations", "iterations", "",
                       [](const StepRecord& s) { return s.work.iterations; }));
  // A logarithmic chart cannot show the zero of the rest state.
  const auto positive = [](double v) { return std::max(v, 1e-18); };
  out.push_back(series(r, "Errors", "left by volume rows", "",
                       [&](const StepRecord& s) { return positive(s.volume_row_residual); }));
  out.push_back(series(r, "Errors", "force residual", "",
                       [&](const StepRecord& s) { return positive(s.force_residual); }));
  out.push_back(
      series(r, "Errors", "row residual", "", [&](const StepRecord& s) { return positive(s.row_residual); }));
  for (auto& s : out) s.log = s.group == "Errors";
  return out;
}

// The unit of a metric as the charts have it, and what it takes to get there.
std::pair<std::string, double> chart_unit(const std::string& unit) {
  struct Unit {
    const char *name, *base;
    double factor;
  };
  static constexpr Unit kUnits[] = {{"m", "m", 1},
                                    {"mm", "m", 1e-3},
                                    {"cm", "m", 1e-2},
                                    {"um", "m", 1e-6},
                                    {"Pa", "Pa", 1},
                                    {"kPa", "Pa", 1e3},
                                    {"MPa", "Pa", 1e6},
                                    {"bar", "Pa", 1e5},
                                    {"N", "N", 1},
                                    {"mN", "N", 1e-3},
                                    {"kN", "N", 1e3},
                                    {"J", "J", 1},
                                    {"mJ", "J", 1e-3},
                                    {"s", "s", 1},
                                    {"ms", "s", 1e-3},
                                    {"m^3", "m\u00b3", 1},
                                    {"cm^3", "m\u00b3", 1e-6},
                                    {"mm^3", "m\u00b3", 1e-9},
                                    {"mL", "m\u00b3", 1e-6},
                                    {"L", "m\u00b3", 1e-3},
                                    {"m\u00b3", "m\u00b3", 1},
                                    {"cm\u00b3", "m\u00b3", 1e-6}};
  for (const Unit& u : kUnits) {
    if (unit == u.name) return {u.base, u.factor};
  }
  return {"", 1};
}

PageEntry metric_entry(const MetricValue& m) {
  const auto [unit, factor] = chart_unit(m.def.unit);
  if (!unit.empty() && std::isfinite(m.value)) {
    PageEntry entry{m.def.name, m.error ? "#0 (reference #1)" : "#0", {factor * m.value}, unit};
    if (m.error) entry.numbers.push_back(factor * *m.def.reference);
    return entry;
  }
  std::string text = number(m.value, "%.5g") + (m.def.unit.empty() ? "" : " " + m.def.unit);
  if (m.error) text += " (reference " + number(*m.def.reference, "%.5g") + ")";
  return {m.def.name, text};
}

PageReport report(const RunView& view) {
  const RunResult& r = view.result;
  const SceneDef& scene = view.scene;
  PageReport page;
  page.title = scene.title.empty() ? scene.name : scene.title;
  page.subtitle = scene.description;
  page.footer = "isochor " + version() + " \u00b7 scene " + scene.name;
  page.run = {{"Elements", std::to_string(r.elements)},
              {"Unknowns", std::to_string(r.size.displacement_unknowns) + " displacements, " +
                               std::to_string(r.size.multipliers) + " multipliers"},
              {"Steps", std::to_string(r.records.back().step) + " of " + std::to_string(r.steps_asked)},
              {"Newton iterations", std::to_string(r.work.iterations)},
              {"Wall time", number(r.wall_s, "%.2f") + " s, " + std::to_string(r.threads) +
                                (r.threads == 1 ? " thread" : " threads")}};
  const StepRecord& end = r.records.back();
  page.summary = {{"Status", to_string(r.status)},
                  {"Left by volume rows", number(end.volume_row_residual, "%.1e")}};
  for (const VolumeMeasures& p : end.parts) {
    page.summary.push_back({"Volume of " + p.name, number(100 * p.volume_change(), "%+.3g") + " %, J " +
                                                       number(p.min_J) + " to " + number(p.max_J)});
  }
  for (const MetricValue& m : r.metrics) {
    if (m.def.quantity != Quantity::volume_row_residual) page.summary.push_back(metric_entry(m));
  }
  for (const auto& w : r.warnings) page.notes.push_back(w);
  if (r.status != RunStatus::converged) {
    page.notes.push_back("Shown up to step " + std::to_string(r.records.back().step) + " of " +
                         std::to_string(r.steps_asked) + ": " + r.reason);
  }
  if (scene.analysis.type == AnalysisType::statics) {
    page.x_label = "Load factor";
    page.x_symbol = "\u03bb";
    page.x_unit = "";
  }
  page.series = all_series(view);
  return page;
}

}  // namespace

std::unique_ptr<RunPage> RunPage::start(const RunView& view) {
  if (!results_page_available()) return nullptr;
  PageShape shape(view);
  auto recorder = ResultsRecorder::start(shape.scene());
  if (!recorder) {
    view.result.warnings.push_back("no results page: " + recorder.error());
    return nullptr;
  }
  return std::unique_ptr<RunPage>(new RunPage(std::move(recorder).value(), std::move(shape)));
}

PageFrame RunPage::append(const RunView& view, const std::vector<BodyFields>& fields) {
  PageFrame frame = shape_.frame(view, fields);
  if (!shape_.to_cut().empty())
    section_ = section_through(frame.positions, shape_.to_cut(), up_axis(view.scene));
  if (auto r = recorder_.append(frame); !r) failure_ = r.error();
  return frame;
}

void RunPage::append(PageFrame frame) {
  frame.fields.resize(shape_.scene().fields.size(), std::vector<double>(frame.positions.size()));
  if (auto r = recorder_.append(frame); !r) failure_ = r.error();
}

Result<void> RunPage::write(const RunView& view, const std::string& path) {
  if (!failure_.empty()) return Error{failure_};
  PageReport page = report(view);
  page.section = section_;
  return recorder_.write(path, page);
}

}  // namespace isochor
