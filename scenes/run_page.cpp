#include "scenes/run_page.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "page_surface.h"
#include "scenes/section_plane.h"

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
  return std::abs(scene.analysis.options.gravity.z) > std::abs(scene.analysis.options.gravity.y) ? 'z' : 'y';
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

namespace {

// Triangles of the bodies that bound a chamber, all of their corners being nodes of its surfaces; all
// triangles where there is none.
std::vector<Index> triangles_to_cut(const RunView& view, const PageScene& scene,
                                    std::span<const std::vector<Index>> node_of_vertex) {
  std::vector<bool> on_chamber(scene.rest.size(), false);
  std::size_t first = 0;
  for (std::size_t b = 0; b < node_of_vertex.size(); ++b) {
    const Mesh& mesh = view.built.world.mesh(view.built.bodies[b]);
    std::vector<bool> wall(mesh.nodes.size(), false);
    for (const CavityDef& cavity : view.scene.cavities) {
      if (static_cast<std::size_t>(cavity.body) != b) continue;
      for (const MeshSurface& s : mesh.surfaces) {
        if (std::find(cavity.surfaces.begin(), cavity.surfaces.end(), s.name) == cavity.surfaces.end())
          continue;
        for (const Index n : s.faces) wall[static_cast<std::size_t>(n)] = true;
      }
    }
    for (std::size_t v = 0; v < node_of_vertex[b].size(); ++v)
      on_chamber[first + v] = wall[static_cast<std::size_t>(node_of_vertex[b][v])];
    first += node_of_vertex[b].size();
  }
  std::vector<Index> out;
  for (std::size_t t = 0; t < scene.triangles.size(); t += 3) {
    const auto corners = std::span(scene.triangles).subspan(t, 3);
    if (std::all_of(corners.begin(), corners.end(),
                    [&](Index v) { return on_chamber[static_cast<std::size_t>(v)]; }))
      out.insert(out.end(), corners.begin(), corners.end());
  }
  return out.empty() ? scene.triangles : out;
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
  std::vector<std::vector<Index>> nodes;
  for (const Vertices& v : vertices)
    nodes.push_back(v.nodes.empty() ? std::vector<Index>(v.points.size(), 0) : v.nodes);
  std::vector<Index> to_cut = triangles_to_cut(view, scene, nodes);
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
      new RunPage(std::move(recorder).value(), std::move(vertices), std::move(overlays), std::move(to_cut)));
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
  if (!to_cut_.empty()) section_ = section_through(frame.positions, to_cut_, up_axis(view.scene));
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
  if (!failure_.empty()) return Error{failure_};
  PageReport page = report(view);
  page.section = section_;
  return recorder_.write(path, page);
}

}  // namespace isochor
