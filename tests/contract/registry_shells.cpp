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

// Stretched where the body is at rest, with fibers that pull there and such that do not.
void add_prepared(std::vector<SceneCase>& out) {
  const std::vector<std::string> covers{"constraints/sheet_pool", "constraints/membrane_pool",
                                        "constraints/sheet_fields"};
  for (const double poisson : {0.0, 0.5}) {
    isochor::ShellDef def = sheet(poisson);
    def.prestretch.along = 1.3;
    def.prestretch.across = 0.9;
    def.prestretch.direction = {1, 2, 0.1};
    isochor::FiberFamily along, toe;
    along.k1 = 30;
    along.k2 = 0.5;
    along.direction = {1, 0.2, 0};
    toe.law = isochor::FiberLaw::toe;
    toe.k1 = 20;
    toe.k2 = 2;
    toe.straight_modulus = 60;
    toe.straight_stretch = 1.15;
    toe.direction = {-1, 1, 0};
    def.fibers = {along, toe};
    SceneCase c{"thin body, stretched, with fibers, nu = " + std::to_string(poisson),
                covers,
                curved_sheet(),
                Element::tri3,
                {},
                {isochor::shell(def)}};
    c.stress_free = false;
    c.own_scale = true;
    out.push_back(c);
  }
  isochor::ShellDef fibers = sheet(0.3);
  fibers.fibers.resize(1);
  fibers.fibers[0].k1 = 50;
  SceneCase c{"thin body with fibers", covers, curved_sheet(), Element::tri3, {}, {isochor::shell(fibers)}};
  c.own_scale = true;
  out.push_back(c);
  isochor::ElasticConstants soft;
  soft.young = 2.6;
  soft.poisson = 0.3;
  for (const auto& [element, type] : {std::pair(Element::tet4, CellType::tet4),
                                      {Element::tet10, CellType::tet10},
                                      {Element::hex8, CellType::hex8}}) {
    isochor::MembraneDef skin;
    skin.surfaces = {"z1", "x1"};
    skin.young = 100;
    skin.thickness = 0.01;
    skin.poisson = 0.4;
    skin.prestretch.along = skin.prestretch.across = 1.2;
    SceneCase m{
        "stretched membrane on a solid of " + std::to_string(isochor::nodes_per_cell(type)) + " nodes a cell",
        covers,
        mapped(box({2, 2, 1}, {1, 1, 1}, type), wavy),
        element,
        {{"", isochor::neo_hookean(soft).value(), 1000}},
        {isochor::membrane(skin)}};
    m.stress_free = false;
    out.push_back(m);
  }
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
  add_prepared(out);
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
