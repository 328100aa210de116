// Materials with constants of their own, fibers and fields: what is refused, and with which words.
#include "isochor/materials.h"

#include "engine/elements/material_model.h"
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
  CHECK_THAT(refusal(mooney_rivlin({-2, 1, 0.5})), ContainsSubstring("2 (c1 + c2) = -2"));
  CHECK_THAT(refusal(mooney_rivlin({std::nan(""), 5, 0.5})), ContainsSubstring("c1 = nan"));
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
  CHECK_THAT(refusal(ogden({{{1, 2}, {3, -2}}, 0.5})), ContainsSubstring("sum of mu alpha / 2 = -2"));
  CHECK_THAT(refusal(ogden({{{1, 2}, {3, 0}}, 0.5})),
             ContainsSubstring("term 2") && ContainsSubstring("alpha = 0"));
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
  g.exponent = 1;
  CHECK_THAT(refusal(with_fibers(matrix, {g})), ContainsSubstring("exponent = 1"));
  g.exponent = 2;
  g.straight_stretch = 1.2;
  CHECK_THAT(refusal(with_fibers(matrix, {g})), ContainsSubstring("straight_stretch = 1.2"));
  g.law = FiberLaw::toe;
  CHECK_THAT(refusal(with_fibers(matrix, {g})), ContainsSubstring("k2 = 0"));
  g.k2 = 1;
  g.straight_stretch = 0.9;
  CHECK_THAT(refusal(with_fibers(matrix, {g})), ContainsSubstring("straight_stretch = 0.9"));
  g = f;
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

namespace {

// A bar of two halves with ratios of their own, by regions or by a field on one region, pulled at its end.
std::vector<Vec3> two_ratios(Element element, double low, double high, bool rows, bool by_field) {
  const Mesh whole =
      box({4, 2, 2}, {2, 1, 1}, element == Element::tet10 ? CellType::tet10 : cells_for(element));
  const Mesh halves = divided(whole, 1);
  World world = make_world(static_options());
  BodyDef def;
  def.element = element;
  def.guard_stiffness = 0;
  if (by_field) {
    std::vector<double> poisson;
    for (const Index r : halves.cell_region) poisson.push_back(r == 0 ? low : high);
    def.mesh = whole;
    const auto law = [](double nu) { return Result<MaterialPtr>(test::neo_hookean(1e5, nu)); };
    def.materials = {{"", value(with_poisson_field(law, poisson)), 1000}};
  } else {
    def.mesh = halves;
    def.materials = {{"low", test::neo_hookean(1e5, low), 1000},
                     {"high", test::neo_hookean(1e5, high), 1000}};
  }
  const BodyId body = value(world.add_body(def));
  if (rows) add_volume(world, body, VolumeSpace::element);
  hold(world, body, {"x0"});
  TractionDef load;
  load.body = body;
  load.surface = "x1";
  load.traction = {3e4, 0, 5e3};
  value(world.add(traction(load)));
  must_advance(world);
  const auto x = world.positions(body);
  return {x.begin(), x.end()};
}

}  // namespace

TEST_CASE("a field of Poisson's ratio says what regions with those ratios say") {
  for (const Element element : {Element::tet4, Element::tet10, Element::hex8}) {
    for (const bool rows : {false, true}) {
      if (rows && element == Element::tet10) continue;  // a linear pressure jumps at an interface of regions
      INFO(name_of(element) << (rows ? ", rows" : ", one field"));
      // Hard rows, one a tet, would be more than the nodes can follow.
      const double high = !rows ? 0.45 : element == Element::hex8 ? 0.5 : 0.49;
      const auto field = two_ratios(element, 0.2, high, rows, true);
      const auto regions = two_ratios(element, 0.2, high, rows, false);
      REQUIRE(field.size() == regions.size());
      double off = 0;
      for (std::size_t i = 0; i < field.size(); ++i) {
        const Vec3 d = field[i] - regions[i];
        off = std::max(off, std::sqrt(dot(d, d)));
      }
      CHECK(off < 1e-8);
    }
  }
}

TEST_CASE("a field of Poisson's ratio keeps E, and the choice of the bulk modulus stays with the rows") {
  ElasticConstants c;
  c.young = 1e5;
  c.bulk_choice = BulkChoice::bulk_modulus;
  const auto law = [&](double nu) {
    c.poisson = nu;
    return stable_neo_hookean(c);
  };
  const MaterialPtr field = value(with_poisson_field(law, {0.1, 0.4, 0.25}));
  for (const auto& [cell, nu] : {std::pair(0, 0.1), {1, 0.4}, {2, 0.25}}) {
    const MaterialPtr one = value(law(nu));
    CHECK(field->shear_modulus() * field->stiffness_factor(cell) == Approx(one->shear_modulus()));
    CHECK(field->inverse_bulk_of(cell) == Approx(one->inverse_bulk()));
    CHECK(field->poisson_of(cell) == Approx(nu));
    PointBatch points{};
    ResponseBatch of_field, of_one;
    const double F[9] = {1.2, 0.3, -0.1, 0.05, 0.8, 0.2, -0.15, 0.1, 1.1};
    for (std::size_t l = 0; l < kLanes; ++l) {
      for (std::size_t i = 0; i < 9; ++i) points.F[i][l] = F[i];
      points.element[l] = cell;
    }
    value(field->complete())->evaluate(Want::hessian, points, of_field);
    value(one->complete())->evaluate(Want::hessian, points, of_one);
    CHECK(of_field.psi[0] == Approx(of_one.psi[0]).epsilon(1e-12));
    for (std::size_t i = 0; i < 9; ++i) CHECK(of_field.P[i][0] == Approx(of_one.P[i][0]).epsilon(1e-11));
    for (std::size_t i = 0; i < 45; ++i)
      CHECK(of_field.A[i][0] == Approx(of_one.A[i][0]).epsilon(1e-11).margin(1e-6));
  }
}

TEST_CASE("fields of Poisson's ratio are refused with entry, value and reason") {
  const auto law = [](double nu) {
    ElasticConstants c;
    c.young = 1e5;
    c.poisson = nu;
    return neo_hookean(c);
  };
  CHECK_THAT(refusal(with_poisson_field(law, {})), ContainsSubstring("no entry"));
  CHECK_THAT(refusal(with_poisson_field(nullptr, {0.3})), ContainsSubstring("no law"));
  CHECK_THAT(refusal(with_poisson_field(law, {0.3, 0.6})),
             ContainsSubstring("entry 1") && ContainsSubstring("0.6"));
  CHECK_THAT(refusal(with_poisson_field(law, {0.3, 0})),
             ContainsSubstring("entry 1") && ContainsSubstring("kappa"));
  CHECK_THAT(refusal(with_poisson_field(law, {0.3, std::nan("")})), ContainsSubstring("not a number"));
  // Without rows 0.5 in one cell is as impossible as everywhere.
  World world = make_world(static_options());
  add_body(world, box({1, 1, 1}, {1, 1, 1}, CellType::hex8), Element::hex8,
           value(with_poisson_field(law, {0.5})));
  CHECK_THAT(world.compile().error(), ContainsSubstring("0.5"));
}

TEST_CASE("the element guard is as stiff as the cells that it guards") {
  // Pressed flat beyond the guard's threshold: twice the stiffness by a field is twice the force.
  const auto force = [](const MaterialPtr& material) {
    World world = make_world(static_options());
    BodyDef def;
    def.mesh = box({2, 2, 2});
    def.guard_stiffness = 1;
    def.materials = {{"", material, 1000}};
    const BodyId body = value(world.add_body(def));
    add_volume(world, body);
    hold(world, body, {"x0", "x1"}, {{1, 0, 0}});
    hold(world, body, {"y0", "y1"}, {{0, 1, 0}});
    hold(world, body, {"z0"}, {{0, 0, 1}});
    const EffectId lid = hold(world, body, {"z1"}, {{0, 0, 1}}, {0, 0, -0.6});
    must_advance(world);
    CHECK(world.measures(body).min_J < 0.5);
    return world.reaction(lid)[0].z;
  };
  const std::vector<double> twice(48, 2.0);
  const double plain = force(test::neo_hookean(1e5, 0.3));
  CHECK(force(value(with_stiffness_field(test::neo_hookean(1e5, 0.3), twice))) ==
        Approx(2 * plain).epsilon(1e-9));
}
