// Materials with constants of their own, fibers and fields: what is refused, and with which words.
#include "isochor/materials.h"

#include "numbers/cube.h"
#include "support/worlds.h"

using namespace isochor;
using namespace test;

namespace {

template <class T>
std::string refusal(const Result<T>& r) {
  return r ? std::string("accepted") : r.error();
}

}  // namespace

TEST_CASE("constants of single laws are refused with name, value and reason") {
  CHECK_THAT(refusal(mooney_rivlin({-2, 5, 0.5})), ContainsSubstring("c1 = -2"));
  CHECK_THAT(refusal(mooney_rivlin({0, 0, 0.5})),
             ContainsSubstring("2 (c1 + c2) = 0") && ContainsSubstring("positive"));
  CHECK_THAT(refusal(mooney_rivlin({1, 1, 0.7})), ContainsSubstring("0.7") && ContainsSubstring("0.5"));
  CHECK_THAT(refusal(fung({1, -1, 1, 0.5})), ContainsSubstring("mu1 = -1"));
  // 2 gamma mu1^2 = 18 against lambda_L + mu_L = 4 at nu = 0: refused, and fine where the ratio is larger.
  CHECK_THAT(refusal(fung({1, 3, 1, 0})),
             ContainsSubstring("negative modulus (-14 Pa)") && ContainsSubstring("larger ratio"));
  CHECK(refusal(fung({1, 3, 1, 0.49})) == "accepted");
  CHECK(refusal(fung({1, 3, 1, 0.5})) == "accepted");
  CHECK_THAT(refusal(arruda_boyce({1, 0, -0.1, 0.5})), ContainsSubstring("beta2 = -0.1"));
  CHECK_THAT(refusal(arruda_boyce({1, 0, 1, -0.5})), ContainsSubstring("negative modulus"));
  CHECK_THAT(refusal(ogden({{}, 0.5})), ContainsSubstring("no terms"));
  CHECK_THAT(refusal(ogden({{{1, 2}, {3, -2}}, 0.5})),
             ContainsSubstring("term 2") && ContainsSubstring("3") && ContainsSubstring("-2"));
  ElasticConstants c;
  c.young = 1;
  c.poisson = 0.3;
  CHECK_THAT(refusal(isochoric_extended(c, 1.5)), ContainsSubstring("threshold = 1.5"));
  CHECK_THAT(refusal(stvk_resistant(c, 0)), ContainsSubstring("resistance = 0"));
  c.poisson = -0.1;
  for (const auto& make : {corotated, fixed_corotated, stvk, neo_hookean_ogden}) {
    CHECK_THAT(refusal(make(c)), ContainsSubstring("-0.1"));
  }
  CHECK(refusal(isochoric_neo_hookean(c)) == "accepted");
}

TEST_CASE("fibers and fields are refused with name, value and reason") {
  const MaterialPtr matrix = test::neo_hookean(1e5, 0.4);
  FiberFamily f;
  CHECK_THAT(refusal(with_fibers(matrix, {f})), ContainsSubstring("fibers[0]: k1 = 0"));
  f.k1 = 1;
  FiberFamily g = f;
  g.k2 = -1;
  CHECK_THAT(refusal(with_fibers(matrix, {f, g})), ContainsSubstring("fibers[1]: k2 = -1"));
  g.k2 = 0;
  g.dispersion = 0.5;
  CHECK_THAT(refusal(with_fibers(matrix, {g})), ContainsSubstring("dispersion = 0.5"));
  g.dispersion = 0;
  g.direction = {};
  CHECK_THAT(refusal(with_fibers(matrix, {g})), ContainsSubstring("direction = (0, 0, 0)"));
  g.directions = {{1, 0, 0}, {}};
  CHECK_THAT(refusal(with_fibers(matrix, {g})), ContainsSubstring("directions[1]"));
  CHECK_THAT(refusal(with_fibers(matrix, {})), ContainsSubstring("no family"));
  CHECK_THAT(refusal(with_fibers(nullptr, {f})), ContainsSubstring("empty"));
  CHECK_THAT(refusal(with_stiffness_field(matrix, {})), ContainsSubstring("no entry"));
  CHECK_THAT(refusal(with_stiffness_field(matrix, {1, -2})), ContainsSubstring("factor[1] = -2"));
  g.directions = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  CHECK_THAT(refusal(with_fibers(value(with_stiffness_field(matrix, {1, 2})), {g})),
             ContainsSubstring("3 entries") && ContainsSubstring("2"));
  // A field of another mesh is found out where the two meet.
  World world = make_world(static_options());
  add_body(world, box({1, 1, 1}), Element::tet4, value(with_fibers(matrix, {g})));
  const auto compiled = world.compile();
  REQUIRE_FALSE(compiled.ok());
  CHECK_THAT(compiled.error(), ContainsSubstring("3 entries") && ContainsSubstring("6 cells"));
}

TEST_CASE("a bar of two stiffnesses by a field stretches as two springs in a row") {
  // Cells with x < 1/2 three times as stiff; nu = 0 keeps the state uniaxial.
  const Mesh mesh = box({4, 1, 1});
  std::vector<double> factor;
  for (std::size_t c = 0; c < mesh.cells.size(); c += 4) {
    double middle = 0;
    for (std::size_t k = 0; k < 4; ++k)
      middle += mesh.nodes[static_cast<std::size_t>(mesh.cells[c + k])].x / 4;
    factor.push_back(middle < 0.5 ? 3 : 1);
  }
  const double young = 1e5, stress = 1;
  for (const bool rows : {true, false}) {
    World world = make_world(static_options());
    const BodyId body =
        add_body(world, mesh, Element::tet4,
                 value(with_stiffness_field(test::neo_hookean(young, rows ? 0.3 : 0), factor)));
    if (rows) {
      VolumeDef def;
      def.body = body;
      def.space = VolumeSpace::element;
      value(world.add(volume(def)));
    }
    slide_on_axes(world, body);
    if (rows) {
      // Sides held: uniaxial strain, modulus lambda + 2 mu in each half.
      hold(world, body, {"y1"}, {{0, 1, 0}});
      hold(world, body, {"z1"}, {{0, 0, 1}});
    }
    TractionDef load;
    load.body = body;
    load.surface = "x1";
    load.traction = {stress, 0, 0};
    value(world.add(traction(load)));
    must_advance(world);
    const double modulus = rows ? young * 0.7 / (1.3 * 0.4) : young;
    const double expected = stress / modulus * (0.5 / 3 + 0.5);
    CHECK(displacement_at(world, body, {1, 1, 1}).x == Approx(expected).epsilon(1e-4));
  }
}

TEST_CASE("fibers carry their part of a small stretch along them, and nothing across") {
  const double young = 1e5, k1 = 2e4, strain = 1e-4;
  FiberFamily f;
  f.k1 = k1;
  f.direction = {3, 0, 0};
  for (const Element element : test::kElements) {
    INFO(name_of(element));
    for (const bool along : {true, false}) {
      World world = make_world(static_options());
      const Mesh mesh = uneven_cube();
      const BodyId body =
          add_body(world, mesh, element, value(with_fibers(test::neo_hookean(young, 0), {f})));
      slide_on_axes(world, body);
      hold(world, body, {along ? "x1" : "y1"}, {along ? Vec3{1, 0, 0} : Vec3{0, 1, 0}},
           along ? Vec3{strain, 0, 0} : Vec3{0, strain, 0});
      must_advance(world);
      const double modulus = world.fields(body).cell_stress[along ? 0 : 1] / strain;
      CHECK(modulus == Approx(young + (along ? 4 * k1 : 0)).epsilon(1e-3));
    }
  }
}
