#include <algorithm>
#include <limits>

#include "contract/registry.h"
#include "isochor/viscoelastic.h"
#include "support/meshes.h"

namespace test {

namespace {

using isochor::BodyId;
using isochor::CavityControl;
using isochor::CellType;
using isochor::Curve;
using isochor::Element;
using isochor::VolumeSpace;
using isochor::VolumeStrain;

isochor::MaterialPtr material(double poisson) {
  isochor::ElasticConstants c;
  c.young = 2.6;
  c.poisson = poisson;
  return std::move(isochor::neo_hookean(c)).value();
}

isochor::EffectPtr volume_rows(VolumeSpace space, VolumeStrain strain, double stabilization = 1) {
  isochor::VolumeDef def;
  def.body = BodyId{0};
  def.space = space;
  def.strain = strain;
  def.stabilization = stabilization;
  return isochor::volume(def);
}

CellType cells_of(Element element) {
  return element == Element::tet10  ? CellType::tet10
         : element == Element::hex8 ? CellType::hex8
                                    : CellType::tet4;
}

Mesh solid_mesh(Element element) {
  return mapped(box({2, 1, 2}, {1, 0.5, 1}, cells_of(element)), wavy);
}

const std::vector<std::pair<Element, std::string>> kElements = {
    {Element::tet4, "tet4"},
    {Element::tet4_edge_smoothed, "edge-smoothed"},
    {Element::tet10, "tet10 curved"},
    {Element::hex8, "hex8"}};

// Two painted zones over two regions of different stiffness, and one over all that is hard.
SceneCase painted_case(SceneCase c, const std::string& element) {
  c.name = element + ", painted zones across regions";
  c.covers = {"constraints/painted_zones", "constraints/surface_feet", "constraints/volume_zones"};
  c.mesh = divided(c.mesh, 0.5);
  c.materials = {{"low", material(0.3), 1000}, {"high", material(0.4), 1000}};
  isochor::VolumeDef def;
  def.space = VolumeSpace::zone;
  def.across_regions = true;
  for (const char* field : {"left", "right"}) {
    isochor::MeshField paint;
    paint.name = field;
    for (const Vec3& x : c.mesh.nodes) {
      const double w = std::clamp(1.5 * x.x - 0.25, 0.0, 1.0);
      paint.values.push_back(std::string(field) == "left" ? 1 - w : w);
    }
    c.mesh.fields.push_back(paint);
    isochor::VolumeZone zone;
    zone.name = zone.field = field;
    def.zones.push_back(zone);
  }
  isochor::VolumeDef whole;
  whole.name = "whole";
  whole.space = VolumeSpace::body;
  whole.across_regions = true;
  whole.hard = true;
  whole.carries_bulk = false;
  c.effects = {isochor::volume(def), isochor::volume(whole)};
  c.numbered_cells = true;  // the fields are by node
  return c;
}

void add_volumes(std::vector<SceneCase>& out) {
  const std::vector<std::string> covers = {"constraints/volume", "constraints/volume_rows"};
  for (const auto& [element, name] : kElements) {
    SceneCase one_field{name + ", one field",        {}, solid_mesh(element), element,
                        {{"", material(0.3), 1000}}, {}};
    out.push_back(one_field);
    for (const auto strain : {VolumeStrain::linear, VolumeStrain::logarithmic}) {
      for (const auto space : {VolumeSpace::node, VolumeSpace::element, VolumeSpace::body}) {
        SceneCase c = one_field;
        c.name = name + ", volume rows, space " + std::to_string(static_cast<int>(space)) + ", strain " +
                 std::to_string(static_cast<int>(strain));
        c.covers = covers;
        c.effects = {volume_rows(space, strain)};
        out.push_back(c);
      }
    }
    for (const auto& [space, strain] : {std::pair{VolumeSpace::node, VolumeStrain::mixed},
                                        {VolumeSpace::element, VolumeStrain::mixed},
                                        {VolumeSpace::element, VolumeStrain::mean_logarithmic},
                                        {VolumeSpace::element, VolumeStrain::mean_mixed},
                                        {VolumeSpace::body, VolumeStrain::mean_logarithmic}}) {
      SceneCase c = one_field;
      c.name = name + ", volume rows, space " + std::to_string(static_cast<int>(space)) + ", strain " +
               std::to_string(static_cast<int>(strain));
      c.covers = covers;
      c.effects = {volume_rows(space, strain)};
      out.push_back(c);
    }
    for (const auto strain : {VolumeStrain::linear, VolumeStrain::logarithmic}) {
      for (const bool hard : {false, true}) {
        isochor::VolumeZone low{"low", {}, {0, 1, 2}, {}, {}, hard ? 0.0 : 1.0};
        isochor::VolumeZone all{"all", {}, {}, {{Vec3{-9, -9, -9}, Vec3{9, 9, 9}}}, {}, 2};
        isochor::VolumeDef def;
        def.space = hard ? VolumeSpace::zone : VolumeSpace::ring;
        def.strain = strain;
        def.rings = 2;
        if (hard) def.zones = {low, all};
        SceneCase c = one_field;
        c.name = name + (hard ? ", hard zone in a compliant one" : ", rings") + ", strain " +
                 std::to_string(static_cast<int>(strain));
        c.covers = covers;
        c.effects = {isochor::volume(def)};
        c.numbered_cells = hard;
        out.push_back(c);
      }
    }
    out.push_back(painted_case(one_field, name));
    SceneCase regions = one_field;
    regions.name = name + ", two regions at nu = 0.5";
    regions.mesh = divided(solid_mesh(element), 0.5);
    regions.materials = {{"low", material(0.5), 1000}, {"", material(0.499), 500}};
    regions.effects = {volume_rows(VolumeSpace::node, VolumeStrain::linear)};
    regions.covers = covers;
    out.push_back(regions);
  }
  // Both sides of the guard's threshold: J of about 0.34 and just around 0.5.
  for (const double stretch : {0.7, 0.795}) {
    SceneCase guarded{"guard, stretch " + std::to_string(stretch),
                      covers,
                      solid_mesh(Element::tet4_edge_smoothed),
                      Element::tet4_edge_smoothed,
                      {{"", material(0.5), 1000}},
                      {volume_rows(VolumeSpace::node, VolumeStrain::linear)}};
    guarded.stretch = stretch;
    out.push_back(guarded);
  }
}

void add_cavities(std::vector<SceneCase>& out) {
  for (const auto& [element, name] : kElements) {
    for (const bool open : {false, true}) {
      for (const auto control : {CavityControl::pressure, CavityControl::volume_ratio}) {
        isochor::CavityDef def;
        def.body = BodyId{0};
        def.surfaces = {"chamber"};
        def.control = control;
        def.amount = Curve::constant(1.2);
        def.cap_free_openings = open;
        const auto smaller = [](const Vec3& p) { return wavy((1.0 / 3) * p); };
        SceneCase c{name + (open ? ", open" : ", closed") + ", chamber control " +
                        std::to_string(static_cast<int>(control)),
                    {"constraints/cavity", "constraints/face_pool"},
                    mapped(hollow_box(open, cells_of(element)), smaller),
                    element,
                    {{"", material(0.3), 1000}},
                    {isochor::cavity(def)}};
        c.stress_free = false;
        out.push_back(c);
      }
    }
  }
}

// On all of a chamber; and on two sides of a solid, with a free rim that is lagged or part of the system.
void add_pressures(std::vector<SceneCase>& out) {
  for (const auto& [element, name] : kElements) {
    isochor::PressureDef def;
    def.amount = Curve::constant(0.3);
    SceneCase c{name,
                {"constraints/pressure", "constraints/surface_nodes", "constraints/face_pool"},
                {},
                element,
                {{"", material(0.3), 1000}},
                {}};
    c.stress_free = false;
    const auto smaller = [](const Vec3& p) { return wavy((1.0 / 3) * p); };
    def.surfaces = {"chamber"};
    c.name = name + ", pressure in a chamber";
    c.mesh = mapped(hollow_box(false, cells_of(element)), smaller);
    c.effects = {isochor::pressure(def)};
    out.push_back(c);
    c.rigid_invariant = false;
    c.mesh = solid_mesh(element);
    def.surfaces = {"z1", "x1"};
    for (const bool lagged : {false, true}) {
      def.lagged = lagged;
      c.name = name + ", pressure on open faces" + (lagged ? ", lagged" : "");
      c.effects = {isochor::pressure(def)};
      out.push_back(c);
    }
  }
}

void add_supports_and_loads(std::vector<SceneCase>& out) {
  SceneCase c{
      "supports",    {"constraints/dirichlet"},   solid_mesh(Element::tet4),
      Element::tet4, {{"", material(0.5), 1000}}, {volume_rows(VolumeSpace::node, VolumeStrain::linear)}};
  isochor::DirichletDef clamp;
  clamp.where.surfaces = {"x0"};
  isochor::DirichletDef slide;
  slide.name = "slide";
  slide.where.surfaces = {"y0"};
  slide.directions = {{0.3, 1, 0.2}};
  isochor::DirichletDef turn;
  turn.name = "turn";
  turn.where.nearest = {{1, 0.5, 1}};
  turn.directions = {{1, 1, 0}, {1, 0, 0}};
  turn.axis = {0, 0, 1};
  turn.angle = 0.4;
  turn.displacement = {0, 0, 0.1};
  turn.amount = Curve::ramp(1);
  c.effects.push_back(isochor::dirichlet(clamp));
  c.effects.push_back(isochor::dirichlet(slide));
  c.effects.push_back(isochor::dirichlet(turn));
  out.push_back(c);

  SceneCase loads = c;
  loads.name = "loads";
  loads.covers = {"constraints/loads", "constraints/face_pool"};
  isochor::TractionDef pull;
  pull.surface = "x1";
  pull.traction = {0.1, 0, 0.02};
  isochor::TractionDef push;
  push.name = "push";
  push.surface = "z1";
  push.total_force = {0, 0, -0.3};
  isochor::PointForceDef point;
  point.where.nearest = {{1, 0.5, 1}};
  point.force = {0, 0.2, 0};
  loads.materials = {{"", material(0.3), 1000}};
  loads.effects = {isochor::traction(pull), isochor::traction(push), isochor::point_force(point)};
  out.push_back(loads);
}

// The probe gives it an increment from rest.
void add_damping(std::vector<SceneCase>& out) {
  isochor::DampingDef def;
  def.viscosity = 0.4;
  def.mass_rate = 2;
  for (const auto& [element, name] : kElements) {
    SceneCase c{name + ", damping",          {"constraints/damping"}, solid_mesh(element), element,
                {{"", material(0.3), 1000}}, {isochor::damping(def)}};
    out.push_back(c);
  }
}

// Flat and curved faces; a skin with and without give, a membrane at both ends of Poisson's ratio.
void add_skins(std::vector<SceneCase>& out) {
  for (const auto& [element, name] : kElements) {
    if (element == Element::tet4_edge_smoothed) continue;
    SceneCase c{name, {}, solid_mesh(element), element, {{"", material(0.3), 1000}}, {}};
    for (const double stiffness : {2.0, std::numeric_limits<double>::infinity()}) {
      isochor::EpidermisDef skin;
      skin.surfaces = {"z1", "x1"};
      skin.stiffness = stiffness;
      skin.gamma = 3;
      c.name = name + ", epidermis of stiffness " + std::to_string(stiffness);
      c.covers = {"constraints/epidermis", "constraints/face_strain"};
      c.effects = {isochor::epidermis(skin)};
      if (stiffness < 10 || element == Element::tet10) out.push_back(c);
    }
    for (const double poisson : {0.0, 0.3, 0.5}) {
      isochor::MembraneDef skin;
      skin.surfaces = {"z1", "x1"};
      skin.young = 100;
      skin.thickness = 0.01;
      skin.poisson = poisson;
      c.name = name + ", membrane, nu = " + std::to_string(poisson);
      c.covers = {"constraints/membrane", "constraints/face_strain"};
      c.effects = {isochor::membrane(skin)};
      out.push_back(c);
    }
  }
}

// Fibers along a field of directions, in a matrix whose stiffness varies from cell to cell.
void add_fields(std::vector<SceneCase>& out) {
  for (const auto& [element, name] : kElements) {
    const Mesh mesh = solid_mesh(element);
    const auto cells = static_cast<std::size_t>(mesh.cell_count());
    isochor::FiberFamily along, mixed;
    along.k1 = 3;
    along.direction = {1, 0.2, 0};
    mixed.k1 = 1;
    mixed.k2 = 2;
    mixed.dispersion = 0.1;
    std::vector<double> factor;
    for (std::size_t k = 0; k < cells; ++k) {
      mixed.directions.push_back({1, 0.1 * static_cast<double>(k % 7), 0.3});
      factor.push_back(1 + 0.05 * static_cast<double>(k));
    }
    auto matrix = isochor::with_stiffness_field(material(0.4), factor).value();
    SceneCase c{name + ", fields",
                {"materials/fibers", "materials/stiffness_field"},
                mesh,
                element,
                {{"", isochor::with_fibers(matrix, {along, mixed}).value(), 1000}},
                {volume_rows(VolumeSpace::node, VolumeStrain::linear)}};
    c.numbered_cells = true;
    out.push_back(c);
    // Poisson's ratio up to 0.5 itself, a sixth of the cells, and the factor on top.
    std::vector<double> poisson;
    for (std::size_t k = 0; k < cells; ++k) poisson.push_back(0.25 + 0.05 * static_cast<double>(k % 6));
    const auto law = [](double nu) -> isochor::Result<isochor::MaterialPtr> { return material(nu); };
    auto field = isochor::with_poisson_field(law, poisson).value();
    c.name = name + ", field of Poisson's ratio";
    c.covers = {"materials/poisson_field"};
    c.materials = {{"", isochor::with_stiffness_field(field, factor).value(), 1000}};
    out.push_back(c);
    // Springs beside a solid.
    isochor::ElasticConstants isochoric;
    isochoric.young = 2.6;
    isochoric.poisson = 0.4;
    auto instant = isochor::isochoric_neo_hookean(isochoric).value();
    c.name = name + ", memory";
    c.covers = {"materials/viscoelastic"};
    c.numbered_cells = false;
    c.materials = {{"", isochor::with_prony_series(instant, {{0.3, 0.05}, {0.2, 2}}).value(), 1000}};
    out.push_back(c);
  }
}

}  // namespace

std::vector<SceneCase> scene_cases() {
  std::vector<SceneCase> out;
  add_volumes(out);
  add_cavities(out);
  add_pressures(out);
  add_supports_and_loads(out);
  add_damping(out);
  add_fields(out);
  add_skins(out);
  add_shells(out);
  add_attachments(out);
  add_active(out);
  add_worked_example(out);
  return out;
}

}  // namespace test
