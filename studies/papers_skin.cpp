// Cases of Sheen, Larionov & Pai 2021.
#include <array>
#include <cmath>
#include <limits>

#include "isochor/effects.h"
#include "isochor/materials.h"
#include "isochor/schemes.h"
#include "scenes/library.h"
#include "studies/formulations.h"
#include "studies/paper_cases.h"

namespace isochor::studies {

namespace {

constexpr const char* kPercent = "%";

// Figure 2: two tets on a common face, one of which is pressed flat into it.
Result<Numbers> two_tets(bool constrained, int threads) {
  WorldOptions options;
  options.scheme = statics();
  options.threads = threads;
  auto world = World::create(options);
  if (!world) return world.failure();
  BodyDef body;
  const double h = std::sqrt(2.0), s = std::sqrt(3.0) / 2;
  body.mesh.cell_type = CellType::tet4;
  body.mesh.nodes = {{0, 1, 0}, {0, -0.5, s}, {0, -0.5, -s}, {-h, 0, 0}, {h, 0, 0}};
  body.mesh.cells = {0, 2, 1, 3, 0, 1, 2, 4};
  body.element = Element::tet4;
  const std::vector<Vec3> body_at_rest = body.mesh.nodes;
  auto law = constrained ? isochoric_extended({.mu = 16e3, .bulk = std::numeric_limits<double>::infinity()})
                         : stable_neo_hookean({.mu = 16e3, .bulk = 2 * 16e3 * 1.495 / (3 * 0.01)});
  if (!law) return law.failure();
  body.materials = {{"", law.value(), 1000}};
  auto added = world.value().add_body(std::move(body));
  if (!added) return added.failure();
  const BodyId id = added.value();
  const auto hold = [&](const char* name, std::vector<Index> nodes, std::vector<Vec3> directions) {
    DirichletDef d;
    d.name = name;
    d.where.body = id;
    d.where.nodes = std::move(nodes);
    d.directions = std::move(directions);
    return d;
  };
  DirichletDef flat = hold("flat", {3}, {});
  flat.displacement = {h, 0, 0};
  flat.amount = Curve::ramp(1);
  std::vector<EffectPtr> effects{dirichlet(flat), dirichlet(hold("face", {1, 2}, {{1, 0, 0}})),
                                 dirichlet(hold("corner", {0}, {{1, 0, 0}, {0, 0, 1}}))};
  VolumeDef rows;
  rows.body = id;
  rows.space = VolumeSpace::body;
  if (constrained) effects.push_back(volume(rows));
  for (const EffectPtr& e : effects)
    if (auto r = world.value().add(e); !r) return r.failure();
  const auto size = [&](std::span<const Vec3> x, std::array<std::size_t, 4> n) {
    return std::abs(dot(cross(x[n[1]] - x[n[0]], x[n[2]] - x[n[0]]), x[n[3]] - x[n[0]])) / 6;
  };
  const std::array<std::size_t, 4> left{0, 2, 1, 3}, right{0, 1, 2, 4};
  const double rest = size(body_at_rest, right);
  const StepReport report = world.value().advance(1);
  if (report.status != StepStatus::converged) return Error{report.reason};
  const auto x = world.value().positions(id);
  return Numbers{{"all", (size(x, left) + size(x, right)) / (2 * rest)},
                 {"right", size(x, right) / rest},
                 {"iterations", report.iterations}};
}

void add_two_tets(std::vector<PaperCase>& out) {
  for (const bool constrained : {false, true}) {
    PaperCase c = one_field_case(
        std::string("two_tets/") + (constrained ? "zone" : "none"), "2", "two tets, one of them pressed flat",
        constrained ? "Tet4, one zone" : "Tet4, one field, nu = 0.495", {},
        {{"volume of both", "all", 100, kPercent, constrained ? "100 %" : "46.6 %"},
         {"volume of the other", "right", 100, kPercent, constrained ? "200 %" : ""}});
    c.cell.probe = [constrained](const SceneDef&, int threads) { return two_tets(constrained, threads); };
    out.push_back(std::move(c));
  }
}

// Figure 5: a beam of 16 x 4 x 4 nodes under gravity, by zones. `penalty`: the nu whose lambda the local
// penalty has; 0: none.
SceneDef beam(double penalty) {
  constexpr double shear = 90e3;
  SceneDef s = paper_block("beam", {1, 0.2, 0.2}, {15, 3, 3}, 0, 0);
  s.bodies[0].element = Element::tet4;
  MaterialDef& m = s.bodies[0].materials[0];
  m.law = MaterialLaw::isochoric_extended;
  m.constants = {};
  m.constants.mu = shear;
  m.constants.bulk = 2 * shear * 1.4999 / (3 * 0.0002);
  if (penalty > 0) m.compression_penalty = {2 * shear * penalty / (1 - 2 * penalty), 9};
  s.dirichlet = {paper_hold("wall", "x0")};
  s.analysis.options.gravity = {0, 0, -9.81};
  s.analysis.options.gravity_curve = Curve::ramp(1);
  s.analysis.options.max_iterations = 200;
  s.analysis.steps = 1;
  s.probes = {{"tip", {}, {1, 0.1, 0.1}}};
  MetricDef tip;
  tip.name = "tip";
  tip.of = "tip";
  tip.component = Component::z;
  s.metrics = {tip};
  watch_volume(s);
  return s;
}

PaperCase zoned(std::string id, std::string figure, std::string setting, SceneDef scene, VolumeSpace space) {
  PaperCase c = one_field_case(
      std::move(id), std::move(figure), "beam under gravity, nu = 0.4999", std::move(setting),
      std::move(scene), {{"end sinks by", "tip", -1, "m", ""}, {"iterations", "iterations", 1, "", ""}});
  VolumeRows rows;
  rows.def.space = space;
  c.cell.scene.volumes = {rows};
  return c;
}

void add_beams(std::vector<PaperCase>& out) {
  out.push_back(zoned("beam/body", "5 a", "Tet4, one zone", beam(0), VolumeSpace::body));
  out.push_back(zoned("beam/ring", "5 d", "Tet4, one ring a node", beam(0), VolumeSpace::ring));
  out.push_back(zoned("beam/penalty", "5 e", "Tet4, one zone and penalty", beam(0.45), VolumeSpace::body));
  out.back().shown[0].stated = "as one ring, 11.15 times as fast";
  out.push_back(zoned("beam/element", "5 f", "Tet4, a zone an element", beam(0), VolumeSpace::element));
  out.back().shown[0].stated = "locks";
  out.push_back(paper_case("beam/tet10_node", "", "beam under gravity, nu = 0.4999", "tet10_node", beam(0),
                           {{"end sinks by", "tip", -1, "m", ""}}));
}

// Figure 8: a cube on the ground that gravity takes hold of, 8 ms a step.
void add_settling_cubes(std::vector<PaperCase>& out, bool quick) {
  const int n = quick ? 4 : 8, steps = quick ? 40 : 500;
  SceneDef s = paper_block("cube", {1, 1, 1}, {n, n, n}, 0, 0);
  MaterialDef& m = s.bodies[0].materials[0];
  m.law = MaterialLaw::isochoric_extended;
  m.constants = {};
  m.constants.mu = 100e3;
  m.constants.bulk = std::numeric_limits<double>::infinity();
  s.dirichlet = {paper_hold("ground", "z0")};
  s.analysis.type = AnalysisType::dynamics;
  s.analysis.scheme = SchemeWord::implicit_euler;
  s.analysis.steps = steps;
  s.analysis.duration = 0.008 * steps;
  s.analysis.options.gravity = {0, 0, -9.81};
  s.analysis.options.gravity_curve = Curve::constant(1);
  s.probes = {{"top", {}, {0.5, 0.5, 1}}};
  const auto add = [&](const char* f, const char* error, const char* rise) {
    SceneDef scene = s;
    if (std::string_view(f) == "tet4_node_plain") set_poisson(scene, kPlainPoisson);
    out.push_back(paper_case("settling/" + std::string(f), "8", "cube that settles, 8 ms a step", f, scene,
                             {{"smallest volume", "volume least", 100, kPercent, error},
                              {"energy from nothing", "largest rise", 100, kPercent, rise}}));
    out.back().cell.probe = motion;
  };
  add("tet4_node_plain", "97.6 % (rings by projection)", "oscillates (rings by projection)");
  add("tet4_zone", "", "none");
  add("edge_node", "", "");
}

// Figure 9: the puck, pressed in by a quarter and a half of its height.
void add_pucks(std::vector<PaperCase>& out, bool quick) {
  const auto watched = [&](SceneDef s) {
    s.metrics.clear();
    watch_volume(s);
    MetricDef half;
    half.name = "volume at a quarter";
    half.quantity = Quantity::volume_change;
    half.time = 0.5;
    s.metrics.push_back(half);
    if (quick) s.analysis.steps = 10;
    return s;
  };
  const auto show = [](const char* quarter, const char* whole) {
    return std::vector<ShownNumber>{
        {"change of volume at 25 %", "volume at a quarter", 100, kPercent, quarter},
        {"change of volume at 50 %", "volume", 100, kPercent, whole},
        {"smallest J", "smallest J", 1, "", ""},
        {"iterations", "iterations", 1, "", ""}};
  };
  struct Row {
    double nu;
    const char *quarter, *half;
  };
  for (const Row& row :
       {Row{0.495, "-0.6 %", "-1.8 %"}, Row{0.4545, "-2.1 %", "-5.1 %"}, Row{0.4, "", "-22 %"}}) {
    SceneDef s = watched(puck());
    MaterialDef& m = s.bodies[0].materials[0];
    m.law = MaterialLaw::stable_neo_hookean;
    m.compression_penalty = {};
    set_poisson(s, row.nu);
    out.push_back(one_field_case("puck/" + text(row.nu, 4), "9", "puck, nu = " + text(row.nu, 4),
                                 "Tet4, one field, stable neo-Hookean", s, show(row.quarter, row.half)));
  }
  PaperCase plain =
      one_field_case("puck/zone", "9 c", "puck", "Tet4, one zone and penalty", {}, show("0", "0"));
  plain.cell.scene = watched(puck());
  out.push_back(plain);
  PaperCase skin = plain;
  skin.figure = "9 d";
  skin.cell.id = "puck/skin";
  skin.setting = "the same with epidermis";
  skin.cell.scene = watched(puck_skin());
  out.push_back(skin);
}

// Figures 10 and 11: a ball that falls on the ground.
void add_balls(std::vector<PaperCase>& out, bool quick) {
  SceneDef s = ball_drop();
  s.metrics.clear();
  s.contacts[0].obstacle.position = {0, 0, -0.051};
  s.bodies[0].velocity = {0, 0, -8};
  s.bodies[0].materials[0].constants = {};
  s.bodies[0].materials[0].constants.mu = 16e3;
  s.bodies[0].materials[0].constants.bulk = 16e3;
  s.analysis.step = 0.001;
  s.analysis.duration = quick ? 0.02 : 0.08;
  const auto add = [&](const char* f, double nu, const char* least, const char* most) {
    SceneDef scene = s;
    set_poisson(scene, nu);
    if (std::string_view(f) == "tet4_zone")
      scene.bodies[0].materials[0].law = MaterialLaw::isochoric_extended;
    out.push_back(paper_case("ball/" + std::string(f) + "/" + text(nu, 4), "10, 11",
                             "ball at 8 m/s, 1 ms a step, nu = " + text(nu, 4), f, scene,
                             {{"smallest volume", "volume least", 100, kPercent, least},
                              {"largest volume", "volume most", 100, kPercent, most},
                              {"iterations", "iterations", 1, "", ""}}));
    out.back().cell.probe = motion;
  };
  add("tet4", 0.45, "47.2 % (4.7k tets), 49 % (64k)", "136 % (4.7k)");
  add("tet4", 0.495, "87.3 % (64k); fails (4.7k)", "");
  add("tet4_zone", 0.5, "100 %", "100 %");
  add("edge_node", 0.5, "", "");
}

}  // namespace

PaperPart volume_preserving_skin(bool quick) {
  PaperPart part{
      "Volume-preserving soft tissue with skin (2021)",
      "Sizes were not published: the beam is 1 x 0.2 x 0.2 m with a shear modulus of 90 kPa, the cube 1 m "
      "(8 cells a side in place of 16, 500 steps of 1,000), the puck has 4,527 tets in place of 22,000, "
      "the ball a radius of 5 cm, 5,687 tets, and falls at 8 m/s. Shapes of the two tets are regular "
      "here. Pressures and zones have studies of their own (isochor study pressure, zones).",
      {}};
  add_two_tets(part.cases);
  add_beams(part.cases);
  add_settling_cubes(part.cases, quick);
  add_pucks(part.cases, quick);
  add_balls(part.cases, quick);
  return part;
}

}  // namespace isochor::studies
