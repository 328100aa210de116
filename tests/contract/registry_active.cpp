// Growth, muscles, springs, equations between points, and nodes that follow data or several bones.
#include <cmath>

#include "contract/registry.h"
#include "support/meshes.h"

namespace test {

namespace {

using namespace isochor;

MaterialPtr soft(double poisson = 0.3) {
  ElasticConstants c;
  c.young = 2.6;
  c.poisson = poisson;
  return std::move(neo_hookean(c)).value();
}

const std::vector<std::pair<Element, std::string>> kElements = {
    {Element::tet4, "tet4"},
    {Element::tet4_edge_smoothed, "edge-smoothed"},
    {Element::tet10, "tet10 curved"},
    {Element::hex8, "hex8"}};

SceneCase on_block(const std::string& name, Element element, std::vector<std::string> covers,
                   std::vector<EffectPtr> effects) {
  const CellType type = element == Element::tet10  ? CellType::tet10
                        : element == Element::hex8 ? CellType::hex8
                                                   : CellType::tet4;
  return {name,    std::move(covers),    mapped(box({2, 1, 2}, {1, 0.5, 1}, type), wavy),
          element, {{"", soft(), 1000}}, std::move(effects)};
}

EffectPtr rows(VolumeSpace space, VolumeStrain strain) {
  VolumeDef def;
  def.space = space;
  def.strain = strain;
  return volume(def);
}

// As in autodiff.cpp.
GrowthDef some_growth() {
  GrowthDef def;
  def.strain = {0.3, -0.2, 0.1, 0.15, -0.1, 0.2};
  def.amount = Curve::constant(0.7);
  return def;
}

void add_growth(std::vector<SceneCase>& out, Element element, const std::string& name) {
  const auto add = [&](const std::string& what, const GrowthDef& def, std::vector<EffectPtr> more) {
    more.push_back(growth(def));
    SceneCase c = on_block(name + ", growth" + what, element, {"constraints/growth"}, std::move(more));
    c.stress_free = false;
    c.numbered_cells = !def.factors.empty();
    out.push_back(c);
  };
  const GrowthDef def = some_growth();
  add(", one field", def, {});
  for (const auto strain : {VolumeStrain::linear, VolumeStrain::logarithmic, VolumeStrain::mixed}) {
    add(", rows at nodes, strain " + std::to_string(static_cast<int>(strain)), def,
        {rows(VolumeSpace::node, strain)});
  }
  add(", rows of the mean", def, {rows(VolumeSpace::element, VolumeStrain::mean_mixed)});
  GrowthDef swelling;
  swelling.volume = 0.8;
  const std::size_t cells = at(on_block("", element, {}, {}).mesh.cell_count());
  for (std::size_t c = 0; c < cells; ++c) swelling.factors.push_back(0.1 * static_cast<double>(c % 7));
  add(" cell by cell", swelling, {rows(VolumeSpace::node, VolumeStrain::linear)});
}

void add_muscles(std::vector<SceneCase>& out, Element element, const std::string& name) {
  for (const auto tension : {MuscleTension::nominal, MuscleTension::current}) {
    for (const double width : {0.0, 0.6}) {
      MuscleDef def;
      def.direction = {1, 2, 2};
      def.tension = tension;
      def.width = width;
      def.optimal_stretch = width > 0 ? 1.2 : 1;
      def.amount = Curve::constant(0.4);
      SceneCase c = on_block(name + ", muscle, tension " + std::to_string(static_cast<int>(tension)) +
                                 (width > 0 ? ", by length" : ""),
                             element, {"constraints/muscle"}, {muscle(def)});
      c.stress_free = false;
      out.push_back(c);
    }
  }
  MuscleDef def;
  SceneCase c = on_block(name + ", muscle cell by cell", element, {"constraints/muscle"}, {});
  for (Index k = 0; k < c.mesh.cell_count(); ++k) {
    const double turn = 0.1 * k;
    def.directions.push_back((k % 2 == 0 ? 1.0 : -2.0) * Vec3{std::cos(turn), std::sin(turn), 0.2});
  }
  c.effects = {muscle(def)};
  c.stress_free = false;
  c.numbered_cells = true;
  out.push_back(c);
}

void add_springs(std::vector<SceneCase>& out) {
  for (const bool ground : {true, false}) {
    SpringDef def;
    def.from = {0.31, 0.22, 0.43};
    def.to = {0.9, 0.35, 0.8};
    if (!ground) def.to_body = BodyId{0};
    def.stiffness = 3;
    def.pulls_only = ground;
    def.amount = Curve::constant(0.8);
    SceneCase c = on_block(std::string("spring to ") + (ground ? "the ground" : "the body"), Element::tet4,
                           {"constraints/spring", "constraints/segment_pool"}, {spring(def)});
    c.rigid_invariant = !ground;
    out.push_back(c);
  }
}

void add_equations(std::vector<SceneCase>& out) {
  for (const double stiffness : {0.0, 4.0}) {
    LinearConstraintDef def;
    def.terms = {{BodyId{0}, {0.2, 0.1, 0.3}, {1, 2, 0}, 1},
                 {BodyId{0}, {0.8, 0.3, 0.6}, {0, 1, -1}, -0.5},
                 {BodyId{0}, {0.5, 0.2, 0.9}, {1, 0, 0}, 2}};
    def.stiffness = stiffness;
    SceneCase c =
        on_block("equation of stiffness " + std::to_string(stiffness), Element::tet10,
                 {"constraints/linear_constraint", "constraints/point_pool"}, {linear_constraint(def)});
    c.rigid_invariant = false;
    out.push_back(c);
  }
}

void add_current_tractions(std::vector<SceneCase>& out) {
  for (const auto& [element, name] : kElements) {
    for (const bool lagged : {false, true}) {
      SceneCase c = on_block(name + ", traction on the present area" + (lagged ? ", lagged" : ""), element,
                             {"constraints/varying_load", "constraints/loads"}, {});
      MeshField paint;
      paint.name = "paint";
      for (const Vec3& X : c.mesh.nodes) paint.values.push_back(1 + X.y - 0.5 * X.z);
      c.mesh.fields.push_back(paint);
      TractionDef def;
      def.surface = "x1";
      def.traction = {0.3, -0.1, 0.2};
      def.field = "paint";
      def.current_area = true;
      def.lagged = lagged;
      c.effects = {traction(def)};
      c.stress_free = false;
      c.rigid_invariant = false;
      c.numbered_cells = true;  // the field is by node
      out.push_back(c);
    }
  }
}

// Loads with a formula: tractions on the area at rest and as it is, and a pressure, which has no potential.
void add_profiles(std::vector<SceneCase>& out) {
  for (const auto& [element, name] : kElements) {
    SceneCase c =
        on_block(name + ", profiles", element, {"constraints/varying_load", "constraints/pressure"}, {});
    c.stress_free = false;
    c.rigid_invariant = false;
    TractionDef pull;
    pull.surface = "x1";
    pull.traction = {0.3, -0.1, 0.2};
    pull.profile = "1 + x*y - t/2";
    TractionDef current = pull;
    current.name = "current";
    current.current_area = true;
    for (const bool lagged : {false, true}) {
      PressureDef press;
      press.surfaces = {"z1", "y1"};
      press.amount = Curve::constant(0.3);
      press.profile = "cos(x) + 0.3*y*t";
      press.lagged = lagged;
      c.name = name + ", profiles" + (lagged ? ", lagged" : "");
      c.effects = {traction(pull), traction(current), pressure(press)};
      out.push_back(c);
    }
  }
}

void add_given(std::vector<SceneCase>& out) {
  SceneCase c = on_block("driven nodes and a skin", Element::tet4, {"constraints/driven"}, {});
  DrivenDef data;
  data.nodes = {1, 0};
  data.times = {0, 1};
  const Vec3 a = c.mesh.nodes[1], b = c.mesh.nodes[0];
  data.positions = {{a, b}, {a + Vec3{0.1, 0, 0}, b + Vec3{0, 0.1, 0}}};
  SkinDef bones;
  bones.where.nodes = {3, 4, 5};
  SkinDef::Bone bone;
  bone.weights.assign(at(c.mesh.node_count()), 1);
  bone.track.keys = {{0, {0, 0, 0}, {1, 0, 0, 0}}};
  bones.bones = {bone, bone};
  bones.bones[1].track.keys.push_back({1, {0.1, 0, 0.05}, {0.8, 0, 0.6, 0}});
  c.effects = {driven(data), skin(bones)};
  c.numbered_cells = true;  // nodes and weights by number
  out.push_back(c);
}

}  // namespace

void add_active(std::vector<SceneCase>& out) {
  for (const auto& [element, name] : kElements) {
    add_growth(out, element, name);
    add_muscles(out, element, name);
  }
  add_springs(out);
  add_equations(out);
  add_current_tractions(out);
  add_profiles(out);
  add_given(out);
}

}  // namespace test
