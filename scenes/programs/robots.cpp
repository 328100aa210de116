// Pneumatic robots of our own design, modeled on those of Frâncu et al. 2021 (Locking-Proof Tetrahedra).
#include "scenes/programs/parts.h"

namespace isochor {

using namespace programs;

SceneDef tube(const SceneVariant& v) {
  SceneDef s =
      on_mesh("tube", "Inflated tube", "A thick-walled silicone tube, both ends held, inflated to 10 kPa.",
              "tube", "tube", v);
  s.bodies[0].materials = {rubber(90e3, 0.499)};
  s.dirichlet = {hold("ends", "ends")};
  s.cavities = {chamber("chamber", 10e3)};
  s.analysis.steps = 10;
  s.probes = {{"inside", {}, {0.010, 0.040, 0}}, {"outside", {}, {0.018, 0.040, 0}}};
  s.metrics = {displacement("widening inside", "inside", Component::x),
               displacement("widening outside", "outside", Component::x)};
  add_robot_metrics(s);
  keep_volume(s);
  return s;
}

SceneDef cushion(const SceneVariant& v) {
  SceneDef s =
      on_mesh("cushion", "Cushion", "A flat pillow with one chamber, held from below, inflated to 10 kPa.",
              "cushion", "cushion", v);
  s.bodies[0].materials = {rubber(90e3, 0.499)};
  s.dirichlet = {hold("table", "clamped")};
  s.cavities = {chamber("chamber", 10e3)};
  s.probes = {{"top", {}, {0, 0.030, 0}}};
  s.metrics = {displacement("rise of the top", "top", Component::y)};
  add_robot_metrics(s);
  keep_volume(s);
  return s;
}

SceneDef bubble(const SceneVariant& v) {
  SceneDef s = on_mesh("bubble", "Bubble", "A thin dome on a held base plate, inflated to 4 kPa.", "bubble",
                       "bubble", v);
  s.bodies[0].materials = {rubber(100e3, 0.499)};
  s.dirichlet = {hold("base", "clamped")};
  s.cavities = {chamber("chamber", 4e3)};
  s.probes = {{"top", {}, {0, 0.0418, 0}}};
  s.metrics = {displacement("rise of the top", "top", Component::y)};
  add_robot_metrics(s);
  keep_volume(s);
  return s;
}

SceneDef finger(const SceneVariant& v) {
  SceneDef s =
      on_mesh("finger", "Bending finger",
              "A row of bellows on a sole with a stiff limiting layer, clamped at one end, inflated to "
              "10 kPa: it curls.",
              "finger", "finger_large", v);
  // The limiting layer stands for fabric in silicone: thirty times as stiff, just as incompressible.
  s.bodies[0].materials = {rubber(100e3, 0.499, 1000, "body"), rubber(3e6, 0.499, 1000, "limiting_layer")};
  s.dirichlet = {hold("clamp", "clamped")};
  s.cavities = {chamber("chamber", 10e3)};
  s.probes = {{"tip", {}, {0.110, 0, 0}}};
  s.metrics = {displacement("tip along", "tip", Component::x),
               displacement("tip across", "tip", Component::y)};
  add_robot_metrics(s);
  keep_volume(s);
  return s;
}

SceneDef spine(const SceneVariant& v) {
  SceneDef s = on_mesh("spine", "Spine arm",
                       "A slender arm of discs on a core, held at one end, under its own weight.", "spine",
                       "spine", v);
  s.bodies[0].materials = {rubber(266e3, 0.499, 1070)};
  s.dirichlet = {hold("root", "clamped")};
  s.analysis.options.gravity = {0, -9.8, 0};
  s.analysis.options.gravity_curve = Curve::ramp(1);
  s.analysis.steps = 5;
  s.probes = {{"tip", {}, {0.280, 0, 0}}};
  s.metrics = {displacement("tip along", "tip", Component::x), displacement("tip down", "tip", Component::y)};
  keep_volume(s);
  return s;
}

}  // namespace isochor
