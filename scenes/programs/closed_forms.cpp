// Scenes with exact answers: thick tube and sphere of inner radius 1 and outer radius 2, and torsion; mu = 1,
// incompressible.
#include <limits>

#include "scenes/programs/parts.h"

namespace isochor {

using namespace programs;

namespace {

MaterialDef unit_material() {
  MaterialDef m;
  m.constants.mu = 1;
  m.constants.bulk = std::numeric_limits<double>::infinity();
  return m;
}

std::string mesh_of(const char* name, const SceneVariant& v) {
  return v.element == Element::tet10 ? std::string(name) + "_tet10" : name;
}

// A quarter of the ring between two rigid planes.
SceneDef quarter_tube(const char* name, const char* title, const char* description, const SceneVariant& v) {
  SceneDef s = on_mesh(name, title, description, "tube", mesh_of("thick_tube", v).c_str(), v);
  s.bodies[0].materials = {unit_material()};
  s.dirichlet = {hold("symmetry x", "symmetry_x", {{1, 0, 0}}), hold("symmetry y", "symmetry_y", {{0, 1, 0}}),
                 hold("plane", "faces_z", {{0, 0, 1}})};
  s.cavities = {chamber("inner", 0)};
  s.probes = {{"inside", {}, {1, 0, 0}}, {"outside", {}, {2, 0, 0}}};
  return s;
}

// An eighth of the shell.
SceneDef eighth_sphere(const char* name, const char* title, const char* description, const SceneVariant& v) {
  SceneDef s = on_mesh(name, title, description, "sphere", mesh_of("thick_sphere", v).c_str(), v);
  s.bodies[0].materials = {unit_material()};
  s.dirichlet = {hold("symmetry x", "symmetry_x", {{1, 0, 0}}), hold("symmetry y", "symmetry_y", {{0, 1, 0}}),
                 hold("symmetry z", "symmetry_z", {{0, 0, 1}})};
  s.cavities = {chamber("inner", 0)};
  s.probes = {{"inside", {}, {1, 0, 0}}, {"outside", {}, {2, 0, 0}}};
  return s;
}

const char* const kTube = "closed form, thick tube";
const char* const kSphere = "closed form, thick sphere";
const char* const kTorsion = "closed form, torsion";

}  // namespace

SceneDef thick_tube(const SceneVariant& v) {
  SceneDef s =
      quarter_tube("thick_tube", "Thick tube, pressure given",
                   "A long tube of inner radius 1 and outer radius 2 inflated by pressure until its inner "
                   "radius has grown by half.",
                   v);
  s.cavities[0].amount = Curve::ramp(0.4282284090965022);
  s.analysis.steps = 5;
  s.metrics = {against(displacement("inner radius grows by", "inside", Component::x), 0.5, 0.01, kTube),
               against(displacement("outer radius grows by", "outside", Component::x), 0.291287847477920,
                       0.01, kTube)};
  keep_volume(s);
  return s;
}

SceneDef thick_tube_volume(const SceneVariant& v) {
  SceneDef s =
      quarter_tube("thick_tube_volume", "Thick tube, volume given",
                   "A long tube of inner radius 1 and outer radius 2 filled until its inner radius has "
                   "doubled; the pressure is the answer.",
                   v);
  s.cavities[0].control = CavityControl::volume_ratio;
  // Inner stretches 1.25, 1.5 and 2, squared.
  s.cavities[0].amount = Curve{{{0, 1}, {1, 1.5625}, {2, 2.25}, {3, 4}}};
  s.analysis.duration = 3;
  s.analysis.steps = 12;
  s.metrics = {
      against(at_time(pressure("pressure at stretch 1.25", "chamber"), 1), 0.2757115368034118, 0.01, kTube),
      against(at_time(pressure("pressure at stretch 1.5", "chamber"), 2), 0.4282284090965022, 0.01, kTube),
      against(pressure("pressure at stretch 2", "chamber"), 0.5740535723065197, 0.01, kTube),
      against(displacement("outer radius grows by", "outside", Component::x), 0.645751311064591, 0.01,
              kTube)};
  keep_volume(s);
  return s;
}

SceneDef thick_sphere(const SceneVariant& v) {
  SceneDef s =
      eighth_sphere("thick_sphere", "Thick sphere, pressure given",
                    "A shell of inner radius 1 and outer radius 2 inflated by pressure until its inner "
                    "radius has grown by half.",
                    v);
  s.cavities[0].amount = Curve::ramp(0.7554331187123394);
  s.analysis.steps = 5;
  s.metrics = {against(displacement("inner radius grows by", "inside", Component::x), 0.5, 0.01, kSphere),
               against(displacement("outer radius grows by", "outside", Component::x), 0.181035335727419,
                       0.01, kSphere)};
  keep_volume(s);
  return s;
}

SceneDef thick_sphere_volume(const SceneVariant& v) {
  SceneDef s =
      eighth_sphere("thick_sphere_volume", "Thick sphere through its limit point",
                    "A shell of inner radius 1 and outer radius 2 filled until its inner radius has doubled: "
                    "past the greatest pressure it can hold, at stretch 1.828.",
                    v);
  s.cavities[0].control = CavityControl::volume_ratio;
  // Inner stretches 1.25, 1.5 and 2, cubed.
  s.cavities[0].amount = Curve{{{0, 1}, {1, 1.953125}, {2, 3.375}, {3, 8}}};
  s.analysis.duration = 3;
  s.analysis.steps = 12;
  s.metrics = {
      against(at_time(pressure("pressure at stretch 1.25", "chamber"), 1), 0.5518685419794458, 0.01, kSphere),
      against(at_time(pressure("pressure at stretch 1.5", "chamber"), 2), 0.7554331187123394, 0.01, kSphere),
      against(pressure("pressure at stretch 2", "chamber"), 0.8069266031066276, 0.01, kSphere),
      against(displacement("outer radius grows by", "outside", Component::x), 0.466212074330470, 0.01,
              kSphere)};
  keep_volume(s);
  return s;
}

SceneDef torsion(const SceneVariant& v) {
  SceneDef s =
      on_mesh("torsion", "Torsion of a cylinder",
              "A solid cylinder of radius 1 and length 1 whose top is turned by 1 rad at constant length.",
              "cylinder", mesh_of("torsion_cylinder", v).c_str(), v);
  s.bodies[0].materials = {unit_material()};
  DirichletDef top = hold("top", "top");
  top.axis = {0, 0, 1};
  top.angle = 1;
  top.amount = Curve::ramp(1);
  s.dirichlet = {hold("bottom", "bottom"), top};
  s.analysis.steps = 4;
  s.probes = {{"rim", {}, {1, 0, 0.5}}};
  MetricDef torque;
  torque.name = "torque";
  torque.quantity = Quantity::reaction_moment;
  torque.of = "top";
  torque.component = Component::z;
  torque.unit = "N m";
  MetricDef force = torque;
  force.name = "axial force";
  force.quantity = Quantity::reaction_force;
  force.unit = "N";
  s.metrics = {against(torque, 1.570796326794897, 0.02, kTorsion),
               against(force, -0.7853981633974483, 0.02, kTorsion)};
  keep_volume(s);
  return s;
}

}  // namespace isochor
