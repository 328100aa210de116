// The constrained neo-Hookean method (Sheen, Larionov & Pai 2021): zones that keep their volume, an isochoric
// energy that lives through inversion, a local penalty on compression, and skin.
#include <limits>

#include "scenes/programs/parts.h"

namespace isochor {

using namespace programs;

namespace {

constexpr double kShear = 10e3;

MaterialDef constrained_neo_hookean(double beta) {
  MaterialDef m;
  m.law = MaterialLaw::isochoric_extended;
  m.constants.mu = kShear;
  m.constants.bulk = std::numeric_limits<double>::infinity();
  m.compression_penalty = {25 * kShear, beta};
  return m;
}

EpidermisDef skin_on(std::vector<std::string> surfaces) {
  EpidermisDef skin;
  skin.name = "skin";
  skin.surfaces = std::move(surfaces);
  skin.stiffness = 25 * kShear * 0.0025;
  skin.gamma = 1;
  return skin;
}

VolumeRows rows(const char* name, VolumeSpace space) {
  VolumeRows r;
  r.def.name = name;
  r.def.space = space;
  return r;
}

DirichletDef pressed_in(const char* surface, const Vec3& displacement) {
  DirichletDef d = hold("press", surface);
  d.displacement = displacement;
  d.amount = Curve::ramp(1);
  return d;
}

MetricDef of_scene(const char* name, Quantity quantity) {
  MetricDef m;
  m.name = name;
  m.quantity = quantity;
  return m;
}

void add_constrained_metrics(SceneDef& s) {
  MetricDef force = of_scene("force", Quantity::reaction_force);
  force.of = "press";
  force.unit = "N";
  s.metrics.push_back(force);
  s.metrics.push_back(of_scene("smallest J", Quantity::min_J));
  s.metrics.push_back(of_scene("iterations", Quantity::newton_iterations));
  keep_volume(s);
}

SceneDef pressed_puck(const char* name, const char* title, const SceneVariant& v) {
  SceneDef s =
      on_mesh(name, title,
              "A flat cylinder whose top is pressed in by half of its height at its middle. One hard "
              "zone keeps the whole volume, the local penalty keeps single elements from being "
              "crushed.",
              "puck", "puck", v);
  s.bodies[0].element = v.element.value_or(Element::tet4);
  s.bodies[0].materials = {constrained_neo_hookean(9)};
  s.volumes = {rows("whole", VolumeSpace::body)};
  s.dirichlet = {hold("base", "bottom"), pressed_in("pressed", {0, 0, -0.015})};
  s.analysis.steps = 50;
  s.analysis.options.smallest_fraction = 1.0 / 256;
  s.outputs.every = 5;
  s.probes = {{"rim", {}, {0.05, 0, 0.03}}};
  s.metrics = {displacement("rim up", "rim", Component::z)};
  add_constrained_metrics(s);
  return s;
}

}  // namespace

SceneDef puck(const SceneVariant& v) {
  return pressed_puck("puck", "Puck pressed in by half", v);
}

SceneDef puck_skin(const SceneVariant& v) {
  SceneDef s = pressed_puck("puck_skin", "Puck with skin, pressed in by half", v);
  s.epidermis = {skin_on({"top", "pressed", "side"})};
  return s;
}

SceneDef painted_arm(const SceneVariant& v) {
  SceneDef s =
      on_mesh("painted_arm", "Arm with painted muscles",
              "Soft tissue around a bone, with two muscles painted on its skin. Each keeps its volume, the "
              "arm as a whole does too, and skin covers it. A bar presses into the upper muscle.",
              "arm", "arm", v);
  s.bodies[0].element = v.element.value_or(Element::tet4);
  s.bodies[0].materials = {constrained_neo_hookean(9)};
  VolumeRows whole = rows("whole", VolumeSpace::body);
  VolumeRows muscles = rows("muscles", VolumeSpace::zone);
  muscles.def.carries_bulk = false;
  muscles.def.painted_surfaces = {"skin"};
  for (const char* field : {"upper", "lower"}) {
    VolumeZone zone;
    zone.name = field;
    zone.field = field;
    muscles.def.zones.push_back(zone);
  }
  s.volumes = {whole, muscles};
  s.epidermis = {skin_on({"skin"})};
  DirichletDef bar = pressed_in("", {0, -0.012, 0});
  bar.where = {};
  bar.where.boxes = {{Vec3{0.085, 0.035, -0.02}, Vec3{0.115, 0.05, 0.02}}};
  s.dirichlet = {hold("bone", "bone"), bar};
  s.analysis.steps = 10;
  s.probes = {{"below", {}, {0.1, -0.045, 0}}, {"beside", {}, {0.1, 0, 0.045}}};
  s.metrics = {displacement("below down", "below", Component::y),
               displacement("beside out", "beside", Component::z)};
  add_constrained_metrics(s);
  return s;
}

}  // namespace isochor
