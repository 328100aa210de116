// Thin sheets: by themselves, and on what is soft.
#include "scenes/programs/parts.h"

namespace isochor {

using namespace programs;

SceneDef thin_strip(const SceneVariant&) {
  SceneDef s;
  s.name = "thin_strip";
  s.title = "Thin strip";
  s.description = "A strip of 10 x 1 x 0.1 m, clamped at one end and bent by a force of 4 N at the other.";
  s.folder = scenes_folder();
  SceneBody strip;
  strip.name = "strip";
  BoxMeshDef box;
  box.upper = {10, 1, 0};
  box.divisions = {32, 4, 1};
  box.cell_type = CellType::tri3;
  strip.mesh = box;
  strip.element = Element::tri3;
  s.bodies = {strip};
  s.analysis.steps = 4;
  Selection root, tip;
  root.node_sets = {"x0"};
  tip.node_sets = {"x1"};
  DirichletDef wall;
  wall.name = "wall";
  wall.where = root;
  s.dirichlet = {wall};
  ShellDef sheet;
  sheet.name = "sheet";
  sheet.young = 1.2e6;
  sheet.poisson = 0;
  sheet.thickness = 0.1;
  sheet.density = 1000;
  sheet.clamped = root;
  s.shells = {sheet};
  PointForceDef force;
  force.where = tip;
  force.force = {0, 0, 4};
  force.amount = Curve::ramp(1);
  s.forces = {force};
  s.probes = {{"tip", {}, {10, 0.5, 0}}};
  const char* source = "Sze, Liu & Lo, Finite Elem. Anal. Des. 40 (2004)";
  s.metrics = {against(displacement("tip along", "tip", Component::x), -3.286, 0.01, source),
               against(displacement("tip up", "tip", Component::z), 6.698, 0.01, source)};
  return s;
}

// A bimetal strip (Timoshenko 1925) with a sheet in place of the second metal. With the extension e and the
// curvature k of the sheet's plane, p = E_s t / (E H) and q = E_s t^3 / (12 E H^3),
//   (1 + p) e = g - k H / 2,   k H (1/3 + q) = (g - e) / 2,
// so that k = 14.08 / m: an arc whose end is at (53.1, -23.9) mm.
SceneDef paper_strip(const SceneVariant&) {
  SceneDef s;
  s.name = "paper_strip";
  s.title = "Strip on paper";
  s.description =
      "A soft strip of 60 x 6 x 2 mm on a sheet of paper of 0.1 mm becomes 2 % longer, which the paper does "
      "not, "
      "and curls.";
  s.folder = scenes_folder();
  SceneBody strip;
  strip.name = "strip";
  BoxMeshDef box;
  box.upper = {0.06, 0.006, 0.002};
  box.divisions = {24, 2, 2};
  strip.mesh = box;
  strip.element = Element::tet10;
  strip.materials = {rubber(1e6, 0, 1000)};
  s.bodies = {strip};
  s.analysis.steps = 2;
  DirichletDef line = hold("line", "x0", {{1, 0, 0}}), point = line, side = line;
  point.name = "point";
  point.where.surfaces = {};
  point.where.nearest = {{0, 0, 0}};
  point.directions = {{0, 1, 0}, {0, 0, 1}};
  side.name = "side";
  side.where = point.where;
  side.where.nearest = {{0, 0.006, 0}};
  side.directions = {{0, 0, 1}};
  s.dirichlet = {line, point, side};
  s.volumes = std::vector<VolumeRows>{};
  ShellDef paper;
  paper.name = "paper";
  paper.surfaces = {"z0"};
  paper.young = 2e9;
  paper.poisson = 0;
  paper.thickness = 1e-4;
  paper.density = 800;
  s.shells = {paper};
  GrowthDef swelling;
  swelling.name = "swelling";
  swelling.along = 0.02;
  swelling.amount = Curve::ramp(1);
  s.growth = {swelling};
  s.probes = {{"tip", {}, {0.06, 0.003, 0}}};
  const char* source = "strip of two layers, by hand";
  s.metrics = {against(displacement("tip along", "tip", Component::x), -0.00688, 0.05, source),
               against(displacement("tip up", "tip", Component::z), -0.02387, 0.03, source)};
  return s;
}

}  // namespace isochor
