#include "studies/problem_scenes.h"

namespace isochor::studies {

SceneDef compressed_block(const SceneVariant& variant) {
  SceneDef s;
  s.name = "compressed_block";
  SceneBody b;
  b.name = "block";
  BoxMeshDef box;
  box.upper = {0.1, 0.1, 0.2};
  box.divisions = {4, 4, 8};
  b.mesh = box;
  b.element = variant.element.value_or(Element::tet4_edge_smoothed);
  MaterialDef m;
  m.constants.young = 66e3;
  m.constants.poisson = 0.4999;
  m.constants.bulk_choice = BulkChoice::bulk_modulus;
  b.materials = {m};
  s.bodies = {b};
  const auto hold = [](const char* name, const char* surface, std::vector<Vec3> directions) {
    DirichletDef d;
    d.name = name;
    d.where.surfaces = {surface};
    d.directions = std::move(directions);
    return d;
  };
  s.dirichlet = {hold("table", "z0", {}), hold("symmetry x", "x0", {{1, 0, 0}}),
                 hold("symmetry y", "y0", {{0, 1, 0}})};
  TractionDef load;
  load.name = "load";
  load.surface = "z1";
  load.traction = {0, 0, -15e3};
  load.amount = Curve::ramp(1);
  s.tractions = {load};
  s.analysis.steps = 2;
  s.probes = {{"top", {}, {0, 0, 0.2}}};
  MetricDef top;
  top.name = "top down";
  top.of = "top";
  top.component = Component::z;
  top.unit = "m";
  s.metrics = {top};
  return s;
}

SceneDef swing(const SceneVariant& variant) {
  SceneDef s = cantilever(variant);
  s.name = "swing";
  s.analysis.options.gravity_curve = Curve::constant(1);
  s.analysis.type = AnalysisType::dynamics;
  s.analysis.scheme = SchemeWord::bdf2;
  s.analysis.duration = kSwingDuration;
  s.analysis.steps = 32;
  for (MetricDef& m : s.metrics) m.reference.reset();
  return s;
}

}  // namespace isochor::studies
