// Bodies that are driven by a cable, by a given amount of gas, by gas that flows from one chamber to another.
#include "scenes/programs/parts.h"

namespace isochor {

using namespace programs;

SceneDef cable_finger(const SceneVariant& v) {
  SceneDef s =
      on_mesh("cable_finger", "Cable-driven finger",
              "A slender arm of discs, held at one end. A cable runs through eyelets in its discs along the "
              "lower side and is shortened by a tenth; the cable on the upper side is given out and hangs "
              "slack.",
              "finger", "spine", v);
  s.bodies[0].materials = {rubber(266e3, 0.499, 1070)};
  s.dirichlet = {hold("root", "clamped")};
  CableDef low, high;
  low.name = "low";
  high.name = "high";
  // One eyelet in the middle of each disc.
  for (int k = 0; k < 7; ++k) {
    const double x = (k + 0.5) * 0.040;
    low.points.push_back({x, -0.030, 0});
    high.points.push_back({x, 0.030, 0});
  }
  // From the wall that holds the arm.
  low.from = Vec3{0, -0.030, 0};
  high.from = Vec3{0, 0.030, 0};
  low.amount = Curve{{{0, 1}, {1, 0.9}}};
  high.amount = Curve{{{0, 1}, {1, 1.2}}};
  s.cables = {low, high};
  s.analysis.steps = 5;
  s.probes = {{"tip", {}, {0.280, 0, 0}}};
  s.metrics = {displacement("tip along", "tip", Component::x), displacement("tip down", "tip", Component::y)};
  MetricDef length;
  length.name = "shortened to";
  length.quantity = Quantity::cable_length;
  length.of = "low";
  length.unit = "m";
  s.metrics.push_back(against(length, 0.9 * 0.260, 1e-9, "the length asked for"));
  MetricDef tension;
  tension.name = "tension";
  tension.quantity = Quantity::cable_tension;
  tension.of = "low";
  tension.unit = "N";
  s.metrics.push_back(tension);
  tension.name = "slack tension";
  tension.of = "high";
  tension.reference = 0;
  tension.tolerance = 0;
  tension.source = "a slack cable carries nothing";
  s.metrics.push_back(tension);
  keep_volume(s);
  return s;
}

SceneDef gas_tube(const SceneVariant& v) {
  SceneDef s =
      on_mesh("gas_tube", "Tube filled with air",
              "The inflated tube, closed: air flows in until it holds a fifth more than at rest, at constant "
              "temperature.",
              "tube", "tube", v);
  s.bodies[0].materials = {rubber(90e3, 0.499)};
  s.dirichlet = {hold("ends", "ends")};
  CavityDef air = chamber("chamber", 0);
  air.control = CavityControl::gas;
  air.amount = Curve{{{0, 1}, {1, 1.2}}};
  s.cavities = {air};
  s.probes = {{"inside", {}, {0.010, 0.040, 0}}};
  s.metrics = {displacement("widening inside", "inside", Component::x), pressure("pressure", "chamber")};
  add_robot_metrics(s);
  keep_volume(s);
  return s;
}

SceneDef two_chambers(const SceneVariant& v) {
  SceneDef s =
      on_mesh("two_chambers", "Two connected domes",
              "Air is pumped into the first of two domes during the first second; then a valve to the second "
              "opens and the pressures equalize.",
              "first", "bubble", v);
  SceneBody second = s.bodies[0];
  second.name = "second";
  std::get<MeshFile>(second.mesh).offset = {0.12, 0, 0};
  s.bodies.push_back(second);
  for (auto& body : s.bodies) body.materials = {rubber(100e3, 0.499)};
  s.dirichlet = {hold("first base", "clamped"), hold("second base", "clamped")};
  s.dirichlet[1].where.body = BodyId{1};
  CavityDef air = chamber("chamber", 0);
  air.control = CavityControl::gas;
  air.name = "pumped";
  air.amount = Curve{{{0, 1}, {1, 1.3}}};
  s.cavities = {air, air};
  s.cavities[1].name = "filled";
  s.cavities[1].body = BodyId{1};
  s.cavities[1].amount = Curve::constant(1);
  ValveDef valve;
  valve.name = "valve";
  valve.from = "pumped";
  valve.to = "filled";
  valve.conductance = 2e-7;
  valve.amount = Curve{{{1, 0}, {1.5, 1}}};
  s.valves = {valve};
  s.analysis.duration = 5;
  s.analysis.steps = 10;
  s.probes = {{"first top", BodyId{0}, {0, 0.0418, 0}}, {"second top", BodyId{1}, {0.12, 0.0418, 0}}};
  s.metrics = {displacement("first top", "first top", Component::y),
               displacement("second top", "second top", Component::y),
               at_time(pressure("pumped up to", "pumped"), 1), pressure("pressure in the first", "pumped"),
               pressure("pressure in the second", "filled")};
  keep_volume(s);
  return s;
}

}  // namespace isochor
