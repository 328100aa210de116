#include "studies/paper_cases.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "studies/formulations.h"

namespace isochor::studies {

SceneDef paper_block(const char* name, const Vec3& size, std::array<int, 3> divisions, double young,
                     double poisson, double density) {
  SceneDef s;
  s.name = name;
  SceneBody b;
  BoxMeshDef box;
  box.upper = size;
  box.divisions = divisions;
  b.mesh = box;
  MaterialDef m;
  m.constants.young = young;
  m.constants.poisson = poisson;
  m.density = density;
  b.materials = {m};
  s.bodies = {b};
  return s;
}

DirichletDef paper_hold(const char* name, const char* surface, std::vector<Vec3> directions) {
  DirichletDef d;
  d.name = name;
  d.where.surfaces = {surface};
  d.directions = std::move(directions);
  return d;
}

void watch_volume(SceneDef& scene) {
  const auto add = [&](const char* name, Quantity quantity) {
    MetricDef m;
    m.name = name;
    m.quantity = quantity;
    scene.metrics.push_back(std::move(m));
  };
  add("volume", Quantity::volume_change);
  add("smallest J", Quantity::min_J);
  add("iterations", Quantity::newton_iterations);
}

namespace {

PaperCase with_scene(std::string id, std::string figure, std::string what, std::string setting,
                     SceneDef scene, std::vector<ShownNumber> shown) {
  PaperCase c;
  c.figure = std::move(figure);
  c.what = std::move(what);
  c.setting = std::move(setting);
  c.shown = std::move(shown);
  c.cell.id = std::move(id);
  c.cell.labels = {{"case", c.what}, {"formulation", c.setting}};
  c.cell.scene = std::move(scene);
  if (!c.shown.empty()) c.cell.metric = c.shown.front().metric;
  return c;
}

// Where the first probe of the scene is nearest to.
std::size_t watched_node(const SceneDef& scene, std::span<const Vec3> rest) {
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < rest.size() && !scene.probes.empty(); ++i) {
    const Vec3 d = rest[i] - scene.probes[0].point;
    if (dot(d, d) >= least) continue;
    least = dot(d, d);
    best = i;
  }
  return best;
}

}  // namespace

PaperCase paper_case(std::string id, std::string figure, std::string what, std::string_view formulation_name,
                     SceneDef scene, std::vector<ShownNumber> shown) {
  const Formulation& f = formulation(formulation_name);
  apply(f, scene);
  return with_scene(std::move(id), std::move(figure), std::move(what), std::string(f.label), std::move(scene),
                    std::move(shown));
}

PaperCase one_field_case(std::string id, std::string figure, std::string what, std::string setting,
                         SceneDef scene, std::vector<ShownNumber> shown) {
  VolumeRows none;
  none.none = true;
  scene.volumes = {none};
  return with_scene(std::move(id), std::move(figure), std::move(what), std::move(setting), std::move(scene),
                    std::move(shown));
}

Result<Numbers> motion(const SceneDef& scene, int threads) {
  auto built = build(scene, {threads});
  if (!built) return built.failure();
  World& world = built.value().world;
  const BodyId body = built.value().bodies[0];
  const auto rest = world.rest_positions(body);
  const std::size_t node = watched_node(scene, rest);
  const Vec3 start = rest[node];
  const StepPlan plan = plan_steps(scene.analysis);
  const double first = world.energies().total();
  double before = first, least = first, most = first, rise = 0;
  double least_potential = std::numeric_limits<double>::infinity();
  Numbers n{{"volume least", 1}, {"volume most", 1}, {"deflection most", 0}, {"deflection", 0}};
  for (int step = 0; step < plan.steps; ++step) {
    const StepReport report = world.advance(plan.h);
    if (report.status != StepStatus::converged)
      return Error{"step " + std::to_string(step + 1) + ": " + report.reason};
    const Energies e = world.energies();
    rise = std::max(rise, e.total() - before);
    before = e.total();
    least = std::min(least, before);
    most = std::max(most, before);
    const BodyMeasures m = world.measures(body);
    n["volume least"] = std::min(n["volume least"], m.volume / m.rest_volume);
    n["volume most"] = std::max(n["volume most"], m.volume / m.rest_volume);
    n["iterations"] += report.iterations;
    const Vec3 d = world.positions(body)[node] - start;
    const double deflection = std::sqrt(dot(d, d));
    n["deflection most"] = std::max(n["deflection most"], deflection);
    if (e.potential() < least_potential) {
      least_potential = e.potential();
      n["deflection"] = deflection;
    }
  }
  n["largest rise"] = most > least ? rise / (most - least) : 0;
  n["potential least"] = least_potential;
  return n;
}

std::vector<PaperPart> paper_parts(bool quick) {
  return {locking_proof_tetrahedra(quick), volume_preserving_skin(quick), stable_neo_hookean_flesh(quick),
          open_questions(quick)};
}

}  // namespace isochor::studies
