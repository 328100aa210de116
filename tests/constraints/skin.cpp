// Epidermis and membrane: what they ask for, what they do, and what they refuse.
#include <cmath>
#include <limits>

#include "numbers/cube.h"
#include "support/worlds.h"

using namespace isochor;
using test::gauge;
using test::value;

namespace {

// A unit block so soft that its skin on z1 does the work.
struct Block {
  World world = test::make_world(test::static_options());
  BodyId body;
  explicit Block(CellType type = CellType::tet4, double young = 1e-6)
      : body(test::add_body(world, test::box({2, 2, 2}, {1, 1, 1}, type),
                            type == CellType::tet10 ? Element::tet10 : Element::tet4,
                            test::neo_hookean(young, 0.3))) {}
  double reaction(EffectId support, int direction) { return std::abs(world.reaction(support)[0][direction]); }
};

EpidermisDef skin_of(const Block& block, double stiffness, double gamma = 0) {
  EpidermisDef def;
  def.body = block.body;
  def.surfaces = {"z1"};
  def.stiffness = stiffness;
  def.gamma = gamma;
  return def;
}

std::string refusal(EffectPtr effect) {
  Block block;
  auto added = block.world.add(std::move(effect));
  if (!added) return added.error();
  auto compiled = block.world.compile();
  return compiled ? "" : compiled.error();
}

}  // namespace

TEST_CASE("a stretched skin pulls with the tension of its law") {
  // Stretched by s along x, held in y: area ratio 1 + s, line tension lambda_e U'(1 + s) over the width of 1.
  for (const CellType type : {CellType::tet4, CellType::tet10}) {
    for (const double gamma : {0.0, 6.0}) {
      Block block(type);
      const EffectId wall = test::hold(block.world, block.body, {"x0"}, {{1, 0, 0}});
      test::hold(block.world, block.body, {"x1"}, {{1, 0, 0}}, {0.4, 0, 0});
      test::hold(block.world, block.body, {"y0", "y1"}, {{0, 1, 0}});
      test::hold(block.world, block.body, {"z0", "z1"}, {{0, 0, 1}});
      value(block.world.add(epidermis(skin_of(block, 3, gamma))));
      test::must_advance(block.world);
      const double s = 0.4, tension = 3 * s * (gamma * s * s + 3) / 3;
      CHECK(block.reaction(wall, 0) == Approx(tension).epsilon(1e-5));
      CHECK(gauge(block.world, "area") == Approx(1.4).epsilon(1e-9));
      // The multiplier belongs to Phi; the line tension is lambda Phi'.
      const double square = gamma * s * s, slope = (1 + square / 3) / std::sqrt(1 + square / 6);
      CHECK(gauge(block.world, "mean tension") * slope == Approx(tension).epsilon(1e-9));
    }
  }
}

TEST_CASE("a layer given by E, nu and thickness is the skin of that stiffness") {
  double force[2];
  for (int k = 0; k < 2; ++k) {
    Block block;
    const EffectId wall = test::hold(block.world, block.body, {"x0"}, {{1, 0, 0}});
    test::hold(block.world, block.body, {"x1"}, {{1, 0, 0}}, {0.2, 0, 0});
    test::hold(block.world, block.body, {"y0", "y1"}, {{0, 1, 0}});
    test::hold(block.world, block.body, {"z0", "z1"}, {{0, 0, 1}});
    EpidermisDef def = skin_of(block, k == 0 ? 200 * 0.4 / (1.4 * 0.2) * 0.01 : 0);
    if (k == 1) def.young = 200, def.poisson = 0.4, def.thickness = 0.01;
    value(block.world.add(epidermis(def)));
    test::must_advance(block.world);
    force[k] = block.reaction(wall, 0);
  }
  CHECK(force[0] == Approx(force[1]).epsilon(1e-10));
}

TEST_CASE("a skin of infinite stiffness keeps the area of every face") {
  Block block(CellType::tet4, 1e5);
  test::hold(block.world, block.body, {"z0"});
  value(block.world.add(epidermis(skin_of(block, std::numeric_limits<double>::infinity()))));
  TractionDef pull;
  pull.body = block.body;
  pull.surface = "x1";
  pull.traction = {2e4, 0, 1e4};
  value(block.world.add(traction(pull)));
  test::must_advance(block.world);
  const Mesh& mesh = block.world.mesh(block.body);
  const auto x = block.world.positions(block.body);
  double moved = 0;
  for (const auto& surface : mesh.surfaces) {
    if (surface.name != "z1") continue;
    for (std::size_t f = 0; f < surface.faces.size(); f += 3) {
      const auto p = [&](std::size_t k) { return x[static_cast<std::size_t>(surface.faces[f + k])]; };
      const Vec3 n = cross(p(1) - p(0), p(2) - p(0));
      CHECK(0.5 * std::sqrt(dot(n, n)) == Approx(0.125).epsilon(1e-9));
      const auto first = static_cast<std::size_t>(surface.faces[f]);
      const Vec3 u = x[first] - block.world.rest_positions(block.body)[first];
      moved = std::max(moved, std::sqrt(dot(u, u)));
    }
  }
  CHECK(moved > 0.05);
}

TEST_CASE("a skin covers the part that is named, and every face once") {
  for (const bool twice : {false, true}) {
    Block block;
    const EffectId wall = test::hold(block.world, block.body, {"x0"}, {{1, 0, 0}});
    test::hold(block.world, block.body, {"x1"}, {{1, 0, 0}}, {0.1, 0, 0});
    test::hold(block.world, block.body, {"y0", "y1"}, {{0, 1, 0}});
    test::hold(block.world, block.body, {"z0", "z1"}, {{0, 0, 1}});
    EpidermisDef def = skin_of(block, 1);
    if (twice) def.surfaces.push_back("z1");
    value(block.world.add(epidermis(def)));
    test::must_advance(block.world);
    CHECK(gauge(block.world, "area") == Approx(1.1).epsilon(1e-9));
    CHECK(block.reaction(wall, 0) == Approx(0.1).epsilon(1e-5));
  }
}

TEST_CASE("a membrane in uniaxial tension obeys plane stress") {
  // Free in y: for stretch l along x the width follows from zero stress, w^2 = l^(-2 c/(1 + c)), and the
  // force over the unit width is mu t (l - (l w)^(-2 c) / l).
  for (const CellType type : {CellType::tet4, CellType::tet10}) {
    for (const double nu : {0.0, 0.3, 0.5}) {
      Block block(type);
      const EffectId wall = test::hold(block.world, block.body, {"x0"}, {{1, 0, 0}});
      test::hold(block.world, block.body, {"x1"}, {{1, 0, 0}}, {0.6, 0, 0});
      test::hold(block.world, block.body, {"y0"}, {{0, 1, 0}});
      test::hold(block.world, block.body, {"z0", "z1"}, {{0, 0, 1}});
      MembraneDef def;
      def.body = block.body;
      def.surfaces = {"z1"};
      def.young = 100;
      def.poisson = nu;
      def.thickness = 0.02;
      value(block.world.add(membrane(def)));
      test::must_advance(block.world);
      const double mu = 100 * 0.02 / (2 * (1 + nu)), l = 1.6, c = nu / (1 - nu);
      const double w = std::pow(l, -c / (1 + c));
      CHECK(block.reaction(wall, 0) == Approx(mu * (l - std::pow(l * w, -2 * c) / l)).epsilon(2e-5));
      // At nu = 0.5 that is mu t (l - 1/l^2), the incompressible one.
      if (nu == 0.5) CHECK(block.reaction(wall, 0) == Approx(mu * (l - 1 / (l * l))).epsilon(2e-5));
      CHECK(gauge(block.world, "area") == Approx(l * w).epsilon(1e-5));
    }
  }
}

TEST_CASE("a membrane resists shear, an epidermis does not") {
  double force[2];
  for (int k = 0; k < 2; ++k) {
    Block block;
    const EffectId floor = test::hold(block.world, block.body, {"y0"}, {{1, 0, 0}});
    test::hold(block.world, block.body, {"y1"}, {{1, 0, 0}}, {0.3, 0, 0});
    test::hold(block.world, block.body, {"x0", "x1", "y0", "y1", "z0", "z1"}, {{0, 1, 0}, {0, 0, 1}});
    MembraneDef sheet;
    sheet.body = block.body;
    sheet.surfaces = {"z1"};
    sheet.young = 3;
    sheet.thickness = 1;
    value(block.world.add(k == 0 ? membrane(sheet) : epidermis(skin_of(block, 1))));
    test::must_advance(block.world);
    force[k] = block.reaction(floor, 0);
  }
  CHECK(force[0] == Approx(0.3).epsilon(1e-4));  // mu t times the shear
  CHECK(force[1] < 1e-5);
}

TEST_CASE("skins that mean nothing are refused with what, value and remedy") {
  const auto with = [](auto change) {
    EpidermisDef def;
    def.surfaces = {"z1"};
    change(def);
    return refusal(epidermis(def));
  };
  using Def = EpidermisDef&;
  CHECK_THAT(with([](Def d) { d.stiffness = 1, d.surfaces = {"top"}; }), ContainsSubstring("\"top\""));
  CHECK_THAT(with([](Def d) { d.stiffness = 1, d.surfaces.clear(); }),
             ContainsSubstring("surfaces is empty"));
  CHECK_THAT(with([](Def) {}), ContainsSubstring("give exactly one of the two"));
  CHECK_THAT(with([](Def d) { d.stiffness = 1, d.young = 5; }),
             ContainsSubstring("give exactly one of the two"));
  CHECK_THAT(with([](Def d) { d.stiffness = -2; }), ContainsSubstring("stiffness = -2"));
  CHECK_THAT(with([](Def d) { d.young = 1, d.poisson = 0.6, d.thickness = 1; }),
             ContainsSubstring("poisson = 0.6"));
  CHECK_THAT(with([](Def d) { d.young = 1, d.poisson = 0.4; }), ContainsSubstring("thickness = 0"));
  CHECK_THAT(with([](Def d) { d.stiffness = 1, d.gamma = -1; }), ContainsSubstring("gamma = -1"));
  MembraneDef sheet;
  sheet.surfaces = {"z1"};
  CHECK_THAT(refusal(membrane(sheet)), ContainsSubstring("young = 0"));
  sheet.young = 1;
  CHECK_THAT(refusal(membrane(sheet)), ContainsSubstring("thickness = 0"));
  sheet.thickness = 1;
  sheet.poisson = -0.1;
  CHECK_THAT(refusal(membrane(sheet)), ContainsSubstring("poisson = -0.1"));
}
