// Growth: free swelling and constrained stress in closed form for all elements and laws, a bilayer against
// Timoshenko's curvature, the state, gradients, refusals.
#include <functional>

#include "engine/elements/material_model.h"
#include "isochor/gradients.h"
#include "isochor/viscoelastic.h"
#include "numbers/cube.h"

using namespace isochor;
using test::value;

namespace {

const std::vector<Element> kElements = {Element::tet4, Element::tet4_edge_smoothed, Element::tet10,
                                        Element::hex8};

CellType cells_of(Element e) {
  return e == Element::hex8 ? CellType::hex8 : e == Element::tet10 ? CellType::tet10 : CellType::tet4;
}

ElasticConstants constants(double poisson, double young = 1e5) {
  ElasticConstants c;
  c.young = young;
  c.poisson = poisson;
  return c;
}

EffectId add_growth(World& world, BodyId body, GrowthDef def, const Curve& amount = Curve::ramp(1)) {
  def.body = body;
  def.amount = amount;
  return value(world.add(growth(def)));
}

// Held so that it may swell.
struct Cube {
  World world;
  BodyId body{};
  EffectId grown{};

  Cube(Element element, const MaterialPtr& material, const GrowthDef& def, bool rows = true,
       const Curve& amount = Curve::ramp(1), WorldOptions options = test::static_options())
      : world(test::make_world(options)) {
    body = test::add_body(world, test::uneven_cube(cells_of(element)), element, material);
    if (rows) test::add_volume(world, body);
    test::slide_on_axes(world, body);
    grown = add_growth(world, body, def, amount);
  }
};

double largest(std::span<const double> list) {
  double out = 0;
  for (const double v : list) out = std::max(out, std::abs(v));
  return out;
}

std::string refusal(const GrowthDef& def, const MaterialPtr& material) {
  World world = test::make_world(test::static_options());
  const BodyId body = test::add_body(world, test::uneven_cube(), Element::tet4, material);
  test::slide_on_axes(world, body);
  GrowthDef own = def;
  own.body = body;
  auto added = world.add(growth(own));
  if (!added) return added.error();
  const auto compiled = world.compile();
  return compiled ? "" : compiled.error();
}

}  // namespace

TEST_CASE("what nothing holds takes the size that it has grown to, free of stress") {
  struct Case {
    GrowthDef def;
    Vec3 stretch;
  };
  std::vector<Case> cases(3);
  cases[0].def.linear = 0.3;
  cases[0].stretch = {1.3, 1.3, 1.3};
  cases[1].def.volume = -0.4;
  const double third = std::cbrt(0.6);
  cases[1].stretch = {third, third, third};
  cases[2].def.along = 0.5;
  cases[2].def.across = -0.1;
  cases[2].def.direction = {0, 3, 0};
  cases[2].stretch = {0.9, 1.5, 0.9};
  const std::vector<std::function<Result<MaterialPtr>(const ElasticConstants&)>> laws = {
      neo_hookean, stable_neo_hookean, isochoric_neo_hookean,
      [](const ElasticConstants& c) { return isochoric_extended(c); }};
  for (const Element element : kElements) {
    for (std::size_t law = 0; law < laws.size(); ++law) {
      for (const double poisson : {0.3, 0.5}) {
        for (const bool rows : {true, false}) {
          if (!rows && poisson == 0.5) continue;
          for (const Case& c : cases) {
            Cube cube(element, value(laws[law](constants(poisson))), c.def, rows);
            INFO(test::name_of(element) << ", law " << law << ", nu " << poisson << (rows ? ", rows" : ""));
            test::must_advance(cube.world);
            const auto way = [&](const Vec3& p) {
              return Vec3{c.stretch.x * p.x, c.stretch.y * p.y, c.stretch.z * p.z};
            };
            CHECK(test::distance_from(cube.world, cube.body, way) < 1e-8);
            const BodyFields fields = cube.world.fields(cube.body);
            CHECK(largest(fields.cell_stress) < 1e-3);  // of 1e5
            CHECK(largest(fields.node_stress) < 1e-3);
            const double J = c.stretch.x * c.stretch.y * c.stretch.z;
            CHECK(fields.cell_J.front() == Approx(J).epsilon(1e-8));
            CHECK(cube.world.measures(cube.body).volume_change() == Approx(J - 1).epsilon(1e-8));
          }
        }
      }
    }
  }
}

TEST_CASE("a body that is held all around is under the stress of what it could not become") {
  // F_e = 1/g: p = kappa (1/J_g - 1), the same by rows and without.
  for (const Element element : kElements) {
    for (const VolumeSpace space :
         {VolumeSpace::node, VolumeSpace::element, VolumeSpace::body, VolumeSpace::ring}) {
      for (const bool rows : {true, false}) {
        World world = test::make_world(test::static_options());
        const MaterialPtr material = value(isochoric_neo_hookean(constants(0.4)));
        const BodyId body = test::add_body(world, test::uneven_cube(cells_of(element)), element, material);
        if (rows) test::add_volume(world, body, space);
        test::hold(world, body, {"x0", "x1", "y0", "y1", "z0", "z1"});
        GrowthDef def;
        def.linear = 0.2;
        add_growth(world, body, def);
        test::must_advance(world);
        const double J = 1.2 * 1.2 * 1.2, pressure = (1 / J - 1) / material->inverse_bulk();
        const BodyFields fields = world.fields(body);
        INFO(test::name_of(element) << ", space " << static_cast<int>(space) << (rows ? ", rows" : ""));
        for (const double p : fields.cell_pressure) CHECK(p == Approx(pressure).epsilon(1e-7));
        for (const double p : fields.node_pressure) CHECK(p == Approx(pressure).epsilon(1e-7));
        // J_g kappa (1/J_g - 1)^2/2 of the unit volume.
        CHECK(world.elastic_energy() ==
              Approx(0.5 * J / material->inverse_bulk() * (1 / J - 1) * (1 / J - 1)).epsilon(1e-7));
      }
    }
  }
}

TEST_CASE("a bar that heats up between walls pushes as its law says") {
  // nu = 0.5, lengthwise F_e = 1/g, sideways sqrt(g): sigma = mu (1/g^2 - g) on g^3 of the area.
  constexpr double g = 1.25;
  for (const Element element : kElements) {
    World world = test::make_world(test::static_options());
    const BodyId body =
        test::add_body(world, test::uneven_cube(cells_of(element)), element, test::neo_hookean(3e5, 0.5));
    test::add_volume(world, body);
    test::slide_on_axes(world, body);
    const EffectId wall = test::hold(world, body, {"x1"}, {{1, 0, 0}});
    GrowthDef def;
    def.linear = 1e-3;  // a coefficient of expansion
    add_growth(world, body, def, Curve::ramp(250));
    test::must_advance(world);
    INFO(test::name_of(element));
    CHECK(world.reaction(wall)[0].x == Approx(1e5 * (1 / (g * g) - g) * g * g * g).epsilon(1e-7));
    CHECK(test::stress_error(world.fields(body), 0, 1e5 * (1 / (g * g) - g)) < 1);
  }
}

TEST_CASE("a layer that grows along bends the strip, to Timoshenko's curvature") {
  // Of two equal layers: curvature 3 strain/(2 thickness), here of strips that widen freely.
  constexpr double length = 2, thickness = 0.1, strain = 1e-3;
  std::vector<double> error;
  for (const int fine : {1, 2}) {
    World world = test::make_world(test::static_options());
    Mesh strip =
        test::block({0, 0, 0}, {length, thickness, thickness}, {10 * fine, fine, 2 * fine}, CellType::tet10);
    // Regions by height: divided() goes by x.
    const auto turned = [](const Vec3& p) { return Vec3{p.z, p.y, p.x}; };
    strip = test::mapped(test::divided(test::mapped(strip, turned), thickness / 2), turned);
    const BodyId body =
        test::add_body(world, strip, Element::tet10, value(isochoric_neo_hookean(constants(0.3))));
    DirichletDef foot;
    foot.where.body = body;
    foot.where.surfaces = {"x0"};
    foot.directions = {{1, 0, 0}};
    value(world.add(dirichlet(foot)));
    DirichletDef pin;
    pin.name = "pin";
    pin.where.body = body;
    pin.where.nearest = {{0, thickness / 2, thickness / 2}};
    value(world.add(dirichlet(pin)));
    DirichletDef turn;
    turn.name = "no turn";
    turn.where.body = body;
    turn.where.nearest = {{0, thickness / 2, 0}};
    turn.directions = {{0, 1, 0}};
    value(world.add(dirichlet(turn)));
    GrowthDef def;
    def.regions = {"low"};
    def.along = strain;
    add_growth(world, body, def);
    test::must_advance(world);
    const double tip = test::displacement_at(world, body, {length, thickness / 2, thickness / 2}).z;
    const double curvature = 2 * tip / (length * length), timoshenko = 1.5 * strain / thickness;
    error.push_back(std::abs(curvature / timoshenko - 1));
    INFO("curvature " << curvature << ", Timoshenko " << timoshenko);
    CHECK(error.back() < 0.03);
  }
  INFO(error[0] << ", " << error[1]);
  CHECK(error[1] < 0.01);
}

TEST_CASE("cells that grow apart keep to what one region of each would do") {
  // A field by factors, by strains and by a field of the mesh against two growths of two regions.
  std::vector<std::vector<Vec3>> found;
  for (int way = 0; way < 4; ++way) {
    World world = test::make_world(test::static_options());
    Mesh mesh = test::divided(test::uneven_cube(), 0.5);
    GrowthDef def;
    def.linear = 0.2;
    MeshField field;
    field.name = "swelling";
    std::vector<double> factor;
    for (const Index r : mesh.cell_region) factor.push_back(r == 0 ? 1 : -0.5);
    field.components = way == 3 ? 6 : 1;
    for (const double f : factor) {
      if (way == 3)
        field.values.insert(field.values.end(), {0.2 * f, 0.2 * f, 0.2 * f, 0, 0, 0});
      else
        field.values.push_back(f);
    }
    mesh.cell_fields.push_back(field);
    const std::string low = mesh.regions[0], high = mesh.regions[1];
    const BodyId body = test::add_body(world, mesh, Element::tet4_edge_smoothed, test::neo_hookean(1e5, 0.5));
    test::add_volume(world, body);
    test::slide_on_axes(world, body);
    if (way == 0) {
      def.regions = {low};
      add_growth(world, body, def);
      def.name = "other";
      def.regions = {high};
      def.linear = -0.1;
    } else if (way == 1) {
      def.factors = factor;
    } else {
      def.field = "swelling";
      if (way == 3) def.linear = 0;
    }
    add_growth(world, body, def);
    test::must_advance(world);
    found.emplace_back(world.positions(body).begin(), world.positions(body).end());
    for (std::size_t i = 0; i < found.front().size(); ++i)
      CHECK(norm(found.back()[i] - found.front()[i]) < 1e-9);
  }
}

TEST_CASE("amounts of growth are set, saved and cloned like others") {
  GrowthDef def;
  def.linear = 1;
  WorldOptions options = test::static_options();
  Cube cube(Element::tet4_edge_smoothed, test::neo_hookean(1e5, 0.5), def, true, Curve::constant(0), options);
  test::must_advance(cube.world);
  value(cube.world.set_amount(cube.grown, 0.2));
  test::must_advance(cube.world);
  CHECK(cube.world.measures(cube.body).volume_change() == Approx(1.2 * 1.2 * 1.2 - 1).epsilon(1e-8));
  const auto saved = cube.world.save();
  World other = value(cube.world.clone(4));
  test::must_advance(cube.world);
  test::must_advance(other);
  CHECK(other.state_hash() == cube.world.state_hash());
  GrowthDef more = def;
  more.linear = 1.1;
  Cube different(Element::tet4_edge_smoothed, test::neo_hookean(1e5, 0.5), more, true, Curve::constant(0));
  const auto loaded = different.world.load(saved);
  REQUIRE_FALSE(loaded);
  CHECK(loaded.error().find("growth") != std::string::npos);
  // What turns inside out is refused and leaves the state.
  value(cube.world.set_amount(cube.grown, -1.5));
  const std::vector<Vec3> before(cube.world.positions(cube.body).begin(),
                                 cube.world.positions(cube.body).end());
  const StepReport report = cube.world.step(1);
  CHECK(report.status != StepStatus::converged);
  CHECK_FALSE(report.reason.empty());
  for (std::size_t i = 0; i < before.size(); ++i) CHECK(cube.world.positions(cube.body)[i] == before[i]);
  value(cube.world.set_amount(cube.grown, 0.2));
  test::must_advance(cube.world);
  CHECK(cube.world.measures(cube.body).volume_change() == Approx(1.2 * 1.2 * 1.2 - 1).epsilon(1e-8));
}

TEST_CASE("gradients follow the amount of a growth, derivatives refuse it by name") {
  for (const Element element : {Element::tet4, Element::tet4_edge_smoothed, Element::hex8}) {
    const auto run = [&](double amount, double young) {
      World world = test::make_world(test::static_options());
      const BodyId body = test::add_body(world, test::uneven_cube(cells_of(element)), element,
                                         test::neo_hookean(young, 0.45));
      test::add_volume(world, body);
      test::hold(world, body, {"x0"});
      GrowthDef def;
      def.strain = {0.3, 0.1, -0.2, 0.1, 0, 0.05};
      const EffectId id = add_growth(world, body, def, Curve::constant(amount));
      TractionDef pull;
      pull.body = body;
      pull.surface = "x1";
      pull.traction = {0, 2000, 0};
      value(world.add(traction(pull)));
      test::must_advance(world);
      return std::tuple{std::move(world), body, id};
    };
    auto [world, body, id] = run(0.7, 1e5);
    const Index tip = test::nearest_node(world.rest_positions(body), {1, 1, 1});
    GradientQuery query;
    query.outputs = {Output::node(body, tip, {0.3, 1, -0.2})};
    query.parameters = {Parameter::amount_of(id), Parameter::stiffness(body)};
    const Gradients got = value(world.gradients(query));
    const auto output = [&](double amount, double young) {
      auto [w, b, unused] = run(amount, young);
      return dot(w.positions(b)[static_cast<std::size_t>(tip)], Vec3{0.3, 1, -0.2});
    };
    constexpr double h = 1e-4;
    INFO(test::name_of(element));
    CHECK(got.of(0, 0) == Approx((output(0.7 + h, 1e5) - output(0.7 - h, 1e5)) / (2 * h)).epsilon(1e-6));
    CHECK(got.of(0, 1) ==
          Approx((output(0.7, 1e5 * (1 + h)) - output(0.7, 1e5 * (1 - h))) / (2 * h)).epsilon(1e-6));
    ResponseInput input;
    input.effect = id;
    const auto refused = world.derivatives(std::span(&input, 1));
    REQUIRE_FALSE(refused);
    CHECK(refused.error().find("\"growth\"") != std::string::npos);
    CHECK(refused.error().find("gradients()") != std::string::npos);
  }
}

TEST_CASE("growth refuses what it cannot mean, by name") {
  const MaterialPtr plain = test::neo_hookean(1e5, 0.4);
  const auto says = [&](const GrowthDef& def, const std::string& what) {
    const std::string text = refusal(def, plain);
    INFO(text);
    CHECK(text.find("growth \"growth\": ") != std::string::npos);
    CHECK(text.find(what) != std::string::npos);
  };
  GrowthDef def;
  says(def, "it has no strain");
  def.linear = 0.1;
  def.volume = 0.2;
  says(def, "several of linear, volume");
  def.volume = 0;
  def.linear = -1.2;
  says(def, "at amount 1 cell 0 would shrink to nothing");
  def.linear = std::nan("");
  says(def, "linear = nan");
  def.linear = 0.1;
  def.factors = {1, 2};
  says(def, "factors has 2 entries, the mesh of the body");
  def.factors.clear();
  def.field = "nothing";
  says(def, "field \"nothing\" is none of the cells");
  def.field.clear();
  def.along = 0.1;
  def.linear = 0;
  def.direction = {0, 0, 0};
  says(def, "direction has no length");
  def = {};
  def.linear = 0.1;
  def.amount = Curve{{{0, 0}, {1, std::numeric_limits<double>::infinity()}}};
  says(def, "no finite number");
  def.amount = Curve::ramp(1);
  const MaterialPtr remembers =
      value(with_prony_series(value(isochoric_neo_hookean(constants(0.4))), {{0.3, 1}}));
  CHECK(refusal(def, remembers).find("has a memory, which does not follow growth") != std::string::npos);

  World world = test::make_world(test::static_options());
  const BodyId body = test::add_body(world, test::uneven_cube(), Element::tet4, plain);
  test::slide_on_axes(world, body);
  add_growth(world, body, def);
  def.name = "second";
  add_growth(world, body, def);
  const auto twice = world.compile();
  REQUIRE_FALSE(twice);
  CHECK(twice.error().find("has a growth already") != std::string::npos);
}
