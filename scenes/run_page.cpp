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

// What the nodes of a cell say at a point in it.
template <class Read>
auto interpolated(const EmbeddedPoint& p, const Read& read) {
  auto sum = p.weights[0] * read(static_cast<std::size_t>(p.nodes[0]));
  for (std::size_t a = 1; a < 8; ++a) sum += p.weights[a] * read(static_cast<std::size_t>(p.nodes[a]));
  return sum;
}

// Gravity tells which way is up; without it the y axis of these scenes is.
char up_axis(const SceneDef& scene) {
  return std::abs(scene.gravity.z) > std::abs(scene.gravity.y) ? 'z' : 'y';
}

}  // namespace

bool has_contact(const SceneDef& scene) {
  return !scene.contacts.empty() || !scene.surface_contacts.empty();
}

std::vector<PageField> page_fields(const SceneDef& scene) {
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
  if (has_contact(scene)) fields.push_back({"contact_pressure", "Contact pressure", "Pa"});
  return fields;
}

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
              {"Wall time", number(r.wall_s, "%.2f") + " s, " + std::to_string(r.threads) +
                                (r.threads == 1 ? " thread" : " threads")}};
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

namespace {

// The surface in a lattice as a part of its own, in place of the cubes.
std::vector<EmbeddedPoint> add_page_surface(PageScene& scene, const Mesh& mesh, const DisplaySurface& surface,
                                            const PagePart& part) {
  const auto first = static_cast<Index>(scene.rest.size()), number = static_cast<Index>(scene.parts.size());
  scene.parts.push_back(part);
  for (const EmbeddedPoint& p : surface.points)
    scene.rest.push_back(interpolated(p, [&](std::size_t n) { return mesh.nodes[n]; }));
  for (const Index i : surface.triangles) scene.triangles.push_back(first + i);
  scene.triangle_part.resize(scene.triangles.size() / 3, number);
  scene.triangle_edges.resize(scene.triangles.size() / 3, 7);
  return surface.points;
}

}  // namespace

std::unique_ptr<RunPage> RunPage::start(const RunView& view) {
  if (!results_page_available()) return nullptr;
  PageScene scene;
  std::vector<Vertices> vertices;
  std::vector<std::vector<Index>> triangle_cell(view.built.bodies.size());
  for (std::size_t b = 0; b < view.built.bodies.size(); ++b) {
    PagePart part;
    part.name = view.scene.bodies[b].name;
    const Mesh& mesh = view.built.world.mesh(view.built.bodies[b]);
    const DisplaySurface& surface = view.built.surfaces[b];
    PageMeshOptions options;
    options.triangle_cell = &triangle_cell[b];
    if (surface.points.empty())
      vertices.push_back({add_page_mesh(scene, mesh, part, options), {}});
    else
      vertices.push_back({{}, add_page_surface(scene, mesh, surface, part)});
  }
  scene.fields = page_fields(view.scene);
  scene.probes = view.result.probes;
  scene.up = up_axis(view.scene);
  RunOverlays overlays;
  overlays.start(view, scene, triangle_cell);
  auto recorder = ResultsRecorder::start(std::move(scene));
  if (!recorder) {
    view.result.warnings.push_back("no results page: " + recorder.error());
    return nullptr;
  }
  return std::unique_ptr<RunPage>(
      new RunPage(std::move(recorder).value(), std::move(vertices), std::move(overlays)));
}

PageFrame RunPage::append(const RunView& view, const std::vector<BodyFields>& fields) {
  PageFrame frame;
  frame.time = view.result.records.back().time;
  const bool contact = has_contact(view.scene);
  frame.fields.resize(contact ? 5 : 4);
  for (std::size_t b = 0; b < vertices_.size(); ++b) {
    const World& world = view.built.world;
    const BodyId id = view.built.bodies[b];
    const auto x = world.positions(id), rest = world.rest_positions(id);
    const auto von_mises = at_nodes(world.mesh(id), fields[b].cell_von_mises);
    const auto J = at_nodes(world.mesh(id), fields[b].cell_J);
    const auto add = [&](const Vec3& here, const Vec3& start, double pressure, double mises, double ratio) {
      const Vec3 u = here - start;
      frame.positions.push_back(here);
      frame.fields[0].push_back(std::sqrt(dot(u, u)));
      frame.fields[1].push_back(pressure);
      frame.fields[2].push_back(mises);
      frame.fields[3].push_back(ratio);
    };
    const auto& pressure = fields[b].node_pressure;
    // Empty where no contact is about this body.
    const auto& touch = fields[b].node_contact_pressure;
    const auto touched = [&](std::size_t n) { return touch.empty() ? 0.0 : touch[n]; };
    for (const Index node : vertices_[b].nodes) {
      const auto n = static_cast<std::size_t>(node);
      add(x[n], rest[n], pressure[n], von_mises[n], J[n]);
      if (contact) frame.fields[4].push_back(touched(n));
    }
    for (const EmbeddedPoint& p : vertices_[b].points) {
      const auto of = [&](const auto& list) {
        return interpolated(p, [&](std::size_t n) { return list[n]; });
      };
      add(of(x), of(rest), of(pressure), of(von_mises), of(J));
      if (contact) frame.fields[4].push_back(interpolated(p, touched));
    }
  }
  overlays_.append(view, frame);
  const auto& displacement = view.result.records.back().probes;
  for (std::size_t p = 0; p < displacement.size(); ++p) {
    frame.probes.push_back(view.scene.probes[p].point + displacement[p]);
  }
  append(frame);
  return frame;
}

void RunPage::append(const PageFrame& frame) {
  if (auto r = recorder_.append(frame); !r) failure_ = r.error();
}

Result<void> RunPage::write(const RunView& view, const std::string& path) {
  return recorder_.write(path, report(view));
}

}  // namespace isochor
