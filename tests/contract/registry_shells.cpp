// Shells: as thin bodies, free and clamped, and as layers on solid ones.
#include "contract/registry.h"
#include "isochor/materials.h"
#include "support/meshes.h"

namespace test {

using isochor::Element;

namespace {

Mesh curved_sheet() {
  isochor::BoxMeshDef def;
  def.upper = {1, 1, 0};
  def.divisions = {3, 2, 1};
  def.cell_type = CellType::tri3;
  Mesh sheet = isochor::box_mesh(def).value();
  return mapped(std::move(sheet), [](const Vec3& p) {
    return wavy({p.x, p.y, 0.3 * p.x * p.x - 0.2 * p.x * p.y});
  });
}

isochor::ShellDef sheet(double poisson) {
  isochor::ShellDef def;
  def.young = 100;
  def.poisson = poisson;
  def.thickness = 0.05;
  def.density = 900;
  return def;
}

}  // namespace

void add_shells(std::vector<SceneCase>& out) {
  const std::vector<std::string> covers{"constraints/shell", "constraints/shell_rows",
                                        "constraints/hinge_pool"};
  for (const double poisson : {0.0, 0.3, 0.5}) {
    SceneCase c{"thin body, nu = " + std::to_string(poisson),
                covers,
                curved_sheet(),
                Element::tri3,
                {},
                {isochor::shell(sheet(poisson))}};
    c.own_scale = true;
    out.push_back(c);
  }
  isochor::ShellDef held = sheet(0.3);
  held.clamped.boxes = {{Vec3{-0.2, -0.2, -1}, Vec3{0.2, 1.2, 1}}};
  SceneCase clamped{"thin body, clamped", covers, curved_sheet(), Element::tri3, {}, {isochor::shell(held)}};
  clamped.rigid_invariant = false;
  clamped.own_scale = true;
  out.push_back(clamped);
  isochor::ShellDef flat = sheet(0.3);
  flat.flat = true;
  SceneCase bent{"thin body, flat by itself", covers, curved_sheet(), Element::tri3, {},
                 {isochor::shell(flat)}};
  bent.stress_free = false;
  bent.own_scale = true;
  out.push_back(bent);
  isochor::ElasticConstants soft;
  soft.young = 2.6;
  soft.poisson = 0.3;
  for (const auto& [element, type] : {std::pair(Element::tet4, CellType::tet4),
                                      {Element::tet10, CellType::tet10},
                                      {Element::hex8, CellType::hex8}}) {
    isochor::ShellDef layer = sheet(0.4);
    layer.surfaces = {"z1", "x1"};
    layer.bending = 0.02;
    SceneCase c{"shell on a solid of " + std::to_string(isochor::nodes_per_cell(type)) + " nodes a cell",
                covers,
                mapped(box({2, 2, 1}, {1, 1, 1}, type), wavy),
                element,
                {{"", isochor::neo_hookean(soft).value(), 1000}},
                {isochor::shell(layer)}};
    c.own_scale = true;
    out.push_back(c);
  }
}

}  // namespace test
