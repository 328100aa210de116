// Bodies that are computed on cubes around their surface, after Smith, de Goes & Kim 2018.
#include "scenes/programs/parts.h"

namespace isochor {

using namespace programs;

SceneDef finger_lattice(const SceneVariant& v) {
  SceneDef s =
      on_mesh("finger_lattice", "Finger in a lattice",
              "The bellows of the finger cut out of cubes of 2.5 mm, clamped at one end, hanging under "
              "its own weight; the surface moves with the cubes.",
              "finger", "finger", v);
  LatticeMesh cubes;
  cubes.surface = std::get<MeshFile>(s.bodies[0].mesh).path;
  cubes.spacing = 0.0025;
  s.bodies[0].mesh = cubes;
  s.bodies[0].element = v.element.value_or(Element::hex8);
  s.bodies[0].materials = {rubber(100e3, 0.49)};
  s.analysis.options.gravity = {0, -9.8, 0};
  s.analysis.options.gravity_curve = Curve::ramp(1);
  DirichletDef clamp;
  clamp.name = "clamp";
  clamp.where.boxes = {{Vec3{-1, -1, -1}, Vec3{0.001, 1, 1}}};
  s.dirichlet = {clamp};
  s.analysis.steps = 4;
  s.probes = {{"tip", {}, {0.109, -0.001, 0}}};
  s.metrics = {displacement("tip across", "tip", Component::y)};
  keep_volume(s);
  return s;
}

}  // namespace isochor
