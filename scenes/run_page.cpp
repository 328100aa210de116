#include "scenes/run_page.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "page_surface.h"

namespace isochor {

namespace {

std::string number(double v, const char* format = "%.4g") {
  char text[48];
  std::snprintf(text, sizeof text, format, v);
  return text;
}

// Mean of the cells around each node: what a surface with colors at vertices can show.
std::vector<double> at_nodes(const Mesh& mesh, const std::vector<double>& cells) {
  std::vector<double> sum(mesh.nodes.size(), 0), count(mesh.nodes.size(), 0);
  const auto stride = static_cast<std::size_t>(nodes_per_cell(mesh.cell_type));
  for (std::size_t i = 0; i < mesh.cells.size(); ++i) {
    const auto n = static_cast<std::size_t>(mesh.cells[i]);
    sum[n] += cells[i / stride];
    count[n] += 1;
  }
  for (std::size_t n = 0; n < sum.size(); ++n) sum[n] /= std::max(count[n], 1.0);
  return sum;
}

// Gravity tells which way is up; without it the y axis of these scenes is.
char up_axis(const SceneDef& scene) {
  return std::abs(scene.gravity.z) > std::abs(scene.gravity.y) ? 'z' : 'y';
}

std::vector<PageField> page_fields() {
  std::vector<PageField> fields(4);
  fields[0].name = "displacement";
  fields[0].label = "Displacement";
  fields[0].unit = "m";
  fields[1].name = "pressure";
  fields[1].label = "Mean stress";
  fields[1].unit = "Pa";
  fields[1].diverging = true;
  fields[2].name = "von_mises";
  fields[2].label = "Von Mises stress";
  fields[2].unit = "Pa";
  fields[3].name = "J";
  fields[3].label = "Volume ratio J";
  fields[3].diverging = true;
  fields[3].center = 1;
  return fields;
}

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
    out.push_back(series(r, "Gauges", g.effect + " " + g.quantity, g.unit.c_str(),
                         [i](const StepRecord& s) { return s.gauges[i].value; }));
  }
  for (std::size_t p = 0; p < r.probes.size(); ++p) {
    for (int k = 0; k < 3; ++k) {
      out.push_back(series(r, "Probes", r.probes[p] + " " + "xyz"[k], "m",
                           [p, k](const StepRecord& s) { return s.probes[p][k]; }));
    }
  }
  out.push_back(series(r, "Energies", "elastic", "J", [](const StepRecord& s) { return s.elastic_energy; }));
  if (view.scene.analysis.type == AnalysisType::dynamics) {
    out.push_back(
        series(r, "Energies", "kinetic", "J", [](const StepRecord& s) { return s.kinetic_energy; }));
  }
  out.push_back(
      series(r, "Newton iterations", "iterations", "", [](const StepRecord& s) { return s.iterations; }));
  // A logarithmic chart cannot show the zero of the rest state.
  const auto positive = [](double v) { return std::max(v, 1e-18); };
  out.push_back(
      series(r, "Errors", "volume error", "", [&](const StepRecord& s) { return positive(s.volume_error); }));
  out.push_back(series(r, "Errors", "force residual", "",
                       [&](const StepRecord& s) { return positive(s.force_residual); }));
  out.push_back(
      series(r, "Errors", "row residual", "", [&](const StepRecord& s) { return positive(s.row_residual); }));
  for (auto& s : out) s.log = s.group == "Errors";
  return out;
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
              {"Newton iterations", std::to_string(r.newton_iterations)},
              {"Wall time", number(r.wall_s, "%.2f") + " s, " + std::to_string(r.threads) + " threads"}};
  const StepRecord& end = r.records.back();
  page.summary = {{"Status", to_string(r.status)},
                  {"Volume error", number(end.volume_error, "%.1e")},
                  {"J", number(end.min_J) + " to " + number(end.max_J)}};
  for (const MetricValue& m : r.metrics) {
    std::string text = number(m.value, "%.5g") + (m.def.unit.empty() ? "" : " " + m.def.unit);
    if (m.error) text += " (reference " + number(*m.def.reference, "%.5g") + ")";
    page.summary.push_back({m.def.name, text});
  }
  for (const auto& w : r.warnings) page.notes.push_back(w);
  if (r.status != RunStatus::converged) page.notes.push_back(r.reason);
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
  PageScene scene;
  std::vector<std::vector<Index>> vertices;
  for (std::size_t b = 0; b < view.built.bodies.size(); ++b) {
    PagePart part;
    part.name = view.scene.bodies[b].name;
    vertices.push_back(add_page_mesh(scene, view.built.world.mesh(view.built.bodies[b]), part));
  }
  scene.fields = page_fields();
  scene.probes = view.result.probes;
  scene.up = up_axis(view.scene);
  auto recorder = ResultsRecorder::start(std::move(scene));
  if (!recorder) {
    view.result.warnings.push_back("no results page: " + recorder.error());
    return nullptr;
  }
  return std::unique_ptr<RunPage>(new RunPage(std::move(recorder).value(), std::move(vertices)));
}

void RunPage::append(const RunView& view, const std::vector<BodyFields>& fields) {
  PageFrame frame;
  frame.time = view.result.records.back().time;
  frame.fields.resize(4);
  for (std::size_t b = 0; b < vertices_.size(); ++b) {
    const World& world = view.built.world;
    const BodyId id = view.built.bodies[b];
    const auto x = world.positions(id), rest = world.rest_positions(id);
    const auto von_mises = at_nodes(world.mesh(id), fields[b].cell_von_mises);
    const auto J = at_nodes(world.mesh(id), fields[b].cell_J);
    for (const Index node : vertices_[b]) {
      const auto n = static_cast<std::size_t>(node);
      const Vec3 u = x[n] - rest[n];
      frame.positions.push_back(x[n]);
      frame.fields[0].push_back(std::sqrt(dot(u, u)));
      frame.fields[1].push_back(fields[b].node_pressure[n]);
      frame.fields[2].push_back(von_mises[n]);
      frame.fields[3].push_back(J[n]);
    }
  }
  const auto& displacement = view.result.records.back().probes;
  for (std::size_t p = 0; p < displacement.size(); ++p) {
    frame.probes.push_back(view.scene.probes[p].point + displacement[p]);
  }
  if (auto r = recorder_.append(frame); !r) failure_ = r.error();
}

Result<void> RunPage::write(const RunView& view, const std::string& path) {
  if (!failure_.empty()) return Error{failure_};
  return recorder_.write(path, report(view));
}

}  // namespace isochor
