// Mullins softening: bars against the closed form, what a cycle dissipates, memory as part of the state,
// refusals.
#include "isochor/mullins.h"

#include <cmath>
#include <numbers>

#include "isochor/gradients.h"
#include "isochor/viscoelastic.h"
#include "support/worlds.h"

using namespace isochor;
using test::value;

namespace {

constexpr double kMu = 1e5;
constexpr MullinsSoftening kSoft{1.7, 2e4, 0.1};

ElasticConstants constants() {
  ElasticConstants c;
  c.mu = kMu;
  c.bulk = std::numeric_limits<double>::infinity();
  return c;
}

MaterialPtr softening() {
  return value(with_mullins_softening(value(isochoric_neo_hookean(constants())), kSoft));
}

// Of an incompressible bar at the stretch s.
double density(double s) {
  return kMu / 2 * (s * s + 2 / s - 3);
}
double virgin(double s) {
  return kMu * (s - 1 / (s * s));
}
double left_of(double s, double most) {
  return most > density(s) ? 1 - std::erf((most - density(s)) / (kSoft.m + kSoft.beta * most)) / kSoft.r : 1;
}
double dissipated(double most) {
  const double c = kSoft.m + kSoft.beta * most, u = most / c;
  return (most * std::erf(u) + c / std::sqrt(std::numbers::pi) * (std::exp(-u * u) - 1)) / kSoft.r;
}

// A bar of unit sides that is pulled along x: its length at times 0, 1, 2, ...
struct Bar {
  World world;
  BodyId body{};
  EffectId end{};

  Bar(const WorldOptions& options, const std::vector<double>& stretch, const MaterialPtr& material,
      Element element = Element::tet4, double density = 1e-3)
      : world(test::make_world(options)) {
    const CellType type = element == Element::hex8 ? CellType::hex8 : CellType::tet4;
    body =
        test::add_body(world, test::block({0, 0, 0}, {1, 1, 1}, {2, 2, 2}, type), element, material, density);
    test::add_volume(world, body);
    test::hold(world, body, {"x0"}, {{1, 0, 0}});
    test::hold(world, body, {"y0"}, {{0, 1, 0}});
    test::hold(world, body, {"z0"}, {{0, 0, 1}});
    Curve way;
    for (std::size_t k = 0; k < stretch.size(); ++k)
      way.points.push_back({static_cast<double>(k), stretch[k] - 1});
    end = test::hold(world, body, {"x1"}, {{1, 0, 0}}, {1, 0, 0}, way);
  }
  double force() const { return -world.reaction(end)[0].x; }
};

const std::vector<double> kWay = {1, 1.6, 2.2, 1.9, 1.3, 1, 1.3, 1.9, 2.2, 2.6, 2.2, 1, 0.7, 1};

}  // namespace

TEST_CASE("a bar is softer on its way back, and as ever beyond what it has had") {
  for (const Element element : {Element::tet4, Element::tet4_edge_smoothed, Element::tet10, Element::hex8}) {
    INFO("element " << static_cast<int>(element));
    Bar bar(test::static_options(), kWay, softening(), element);
    double most = 0;
    for (std::size_t k = 1; k < kWay.size(); ++k) {
      INFO("step " << k << ", stretch " << kWay[k]);
      test::must_advance(bar.world, 1);
      const double exact = left_of(kWay[k], most) * virgin(kWay[k]);
      CHECK(std::abs(bar.force()) == Approx(std::abs(exact)).epsilon(1e-8).margin(1e-6 * kMu));
      most = std::max(most, density(kWay[k]));
      // Stresses of cells are those that the supports feel.
      for (const double s : bar.world.fields(bar.body).cell_von_mises)
        REQUIRE(s == Approx(std::abs(exact) * kWay[k]).epsilon(1e-6).margin(1e-6 * kMu));
    }
  }
}

TEST_CASE("what a cycle takes is what the law says, and nothing of it comes back") {
  constexpr int steps = 400;
  constexpr double largest = 2.3;
  std::vector<double> way;
  for (int k = 0; k <= 2 * steps; ++k)
    way.push_back(1 + (largest - 1) * (1 - std::abs(1 - k / double(steps))));
  Bar bar(test::static_options(), way, softening());
  double work = 0, before = 0;
  for (std::size_t k = 1; k < way.size(); ++k) {
    test::must_advance(bar.world, 1);
    const double force = left_of(way[k], k <= steps ? 0 : density(largest)) * virgin(way[k]);
    REQUIRE(std::abs(bar.force()) == Approx(force).epsilon(1e-7).margin(1e-6 * kMu));
    work += 0.5 * (force + before) * (way[k] - way[k - 1]);
    before = force;
  }
  CHECK(work == Approx(dissipated(density(largest))).epsilon(1e-4));
  CHECK(std::abs(bar.world.energies().elastic) < 1e-9 * kMu);
}

TEST_CASE("stored energy falls by what an increment takes, and schemes of dynamics see the same solid") {
  for (const SchemePtr& scheme : {implicit_euler(), bdf2(), generalized_alpha(0.5), newmark()}) {
    WorldOptions options = test::dynamic_options();
    options.scheme = scheme;
    Bar bar(options, {1, 1.8, 1.2}, softening(), Element::tet4, 1e-9);
    for (int k = 0; k < 20; ++k) test::must_advance(bar.world, 0.1);
    CHECK(std::abs(bar.force()) == Approx(left_of(1.2, density(1.8)) * virgin(1.2)).epsilon(1e-4));
  }
  Bar bar(test::static_options(), {1, 2}, softening());
  test::must_advance(bar.world, 1);
  CHECK(bar.world.energies().elastic == Approx(density(2) - dissipated(density(2))).epsilon(1e-7));
}

TEST_CASE("softening is part of the state") {
  const auto begin = [](int threads) {
    WorldOptions options = test::static_options();
    options.threads = threads;
    return Bar(options, kWay, softening(), Element::tet4_edge_smoothed);
  };
  Bar bar = begin(1), two = begin(2);
  for (int k = 0; k < 3; ++k) {
    test::must_advance(bar.world, 1);
    test::must_advance(two.world, 1);
  }
  CHECK(bar.world.state_hash() == two.world.state_hash());
  const auto saved = bar.world.save();
  World clone = value(bar.world.clone());
  test::must_advance(bar.world, 1);
  const auto hash = bar.world.state_hash();
  test::must_advance(clone, 1);
  CHECK(clone.state_hash() == hash);
  value(bar.world.load(saved));
  test::must_advance(bar.world, 1);
  CHECK(bar.world.state_hash() == hash);
  SECTION("it stays where the scene changes") {
    ElasticConstants c;
    c.mu = kMu;
    c.bulk = 5 * kMu;
    test::add_body(two.world, test::block({5, 0, 0}, {6, 1, 1}, {1, 1, 1}), Element::tet4,
                   value(with_mullins_softening(value(isochoric_neo_hookean(c)), kSoft)), 1000, "other");
    test::hold(two.world, two.world.bodies().back(), {"x0", "x1", "y0"});
    test::must_advance(two.world, 1);
    CHECK(std::abs(two.force()) == Approx(std::abs(bar.force())).epsilon(1e-8));
  }
  SECTION("reset forgets") {
    value(bar.world.reset());
    Bar fresh = begin(1);
    test::must_advance(bar.world, 1);
    test::must_advance(fresh.world, 1);
    CHECK(bar.world.state_hash() == fresh.world.state_hash());
  }
}

TEST_CASE("a step that is refused has not softened anything") {
  WorldOptions options = test::static_options();
  options.smallest_fraction = 1;
  Bar bar(options, {1, 1.5, -1}, softening());
  test::must_advance(bar.world, 1);
  const auto before = bar.world.state_hash();
  REQUIRE(bar.world.step(1).status == StepStatus::rejected);
  CHECK(bar.world.state_hash() == before);
}

TEST_CASE("fields of stiffness, fibers and penalties go around softening") {
  const std::vector<double> way = {1, 1.9, 1.3};
  const auto cells = test::block({0, 0, 0}, {1, 1, 1}, {2, 2, 2}).cells.size() / 4;
  FiberFamily fibers;
  fibers.direction = {1, 0, 0};
  fibers.k1 = kMu;
  Bar bare(test::static_options(), way, softening());
  Bar stiffer(test::static_options(), way,
              value(with_stiffness_field(softening(), std::vector<double>(cells, 3))),
              Element::tet4_edge_smoothed);
  Bar reinforced(test::static_options(), way, value(with_fibers(softening(), {fibers})));
  Bar penalized(test::static_options(), way, value(with_compression_penalty(softening(), {25 * kMu, 9})));
  for (int k = 1; k <= 2; ++k) {
    for (Bar* bar : {&bare, &stiffer, &reinforced, &penalized}) test::must_advance(bar->world, 1);
    const double s = way[static_cast<std::size_t>(k)], pull = 2 * kMu * (s * s - 1) * s;
    CHECK(std::abs(stiffer.force()) == Approx(3 * std::abs(bare.force())).epsilon(1e-7));
    CHECK(std::abs(reinforced.force()) - std::abs(bare.force()) == Approx(pull).epsilon(1e-7));
    CHECK(std::abs(penalized.force()) == Approx(std::abs(bare.force())).epsilon(1e-7));
  }
}

TEST_CASE("what has swollen freely has borne nothing") {
  World world = test::make_world(test::static_options());
  const BodyId body =
      test::add_body(world, test::block({0, 0, 0}, {1, 1, 1}, {2, 2, 2}), Element::tet4, softening());
  test::add_volume(world, body);
  test::hold(world, body, {"x0"}, {{1, 0, 0}});
  test::hold(world, body, {"y0"}, {{0, 1, 0}});
  test::hold(world, body, {"z0"}, {{0, 0, 1}});
  GrowthDef swelling;
  swelling.linear = 1;
  swelling.amount.points = {{0, 0}, {1, 0.8}, {2, 0.1}};
  value(world.add(growth(swelling)));
  const double most = density(1.5);
  TractionDef pull;
  pull.surface = "x1";
  // Per area at rest: (1 + amount)^2 of what the grown bar bears.
  pull.total_force = {virgin(1.5), 0, 0};
  pull.amount.points = {{0, 0}, {2, 0}, {3, 1.21}};
  value(world.add(traction(pull)));
  for (int k = 0; k < 12; ++k) test::must_advance(world, 0.25);
  CHECK(world.positions(body).back().x == Approx(1.1 * 1.5).epsilon(1e-6));
  CHECK(world.energies().elastic == Approx(1.331 * (most - dissipated(most))).epsilon(1e-3));
}

TEST_CASE("softening that means nothing is refused") {
  const auto refused = [](const MaterialPtr& base, const MullinsSoftening& constants) {
    const auto made = with_mullins_softening(base, constants);
    REQUIRE_FALSE(made);
    return made.error();
  };
  const auto has = [](const std::string& text, const char* part) {
    INFO(text);
    CHECK(text.find(part) != std::string::npos);
  };
  ElasticConstants c;
  c.young = 1e5;
  c.poisson = 0.4;
  const double nan = std::nan("");
  const MaterialPtr base = value(isochoric_neo_hookean(c));
  has(refused(nullptr, kSoft), "empty");
  has(refused(base, {1, 1, 0}), "r = 1;");
  has(refused(base, {nan, 1, 0}), "r = ");
  has(refused(base, {2, -1, 0}), "m = -1 Pa");
  has(refused(base, {2, nan, 0}), "m = ");
  has(refused(base, {2, 1, -0.5}), "beta = -0.5");
  has(refused(base, {2, 0, 0}), "both 0");
  has(refused(value(neo_hookean(c)), kSoft), "isochoric_neo_hookean");
  has(refused(softening(), kSoft), "already");
  const MaterialPtr relaxing = value(with_prony_series(base, {{0.1, 1}}));
  has(refused(relaxing, kSoft), "already");
  has(refused(value(with_stiffness_field(base, {1, 2})), kSoft), "field");
  const auto series = with_prony_series(softening(), {{0.1, 1}});
  REQUIRE_FALSE(series);
  has(series.error(), "memory");
  const auto field = with_poisson_field(
      [&](double nu) -> Result<MaterialPtr> {
        c.poisson = nu;
        return with_mullins_softening(value(isochoric_neo_hookean(c)), kSoft);
      },
      {0.3, 0.4});
  REQUIRE_FALSE(field);
  has(field.error(), "memory");

  const auto compiled_with = [&](const SchemePtr& scheme) {
    WorldOptions options = test::dynamic_options();
    options.scheme = scheme;
    World world = test::make_world(options);
    const BodyId body =
        test::add_body(world, test::block({0, 0, 0}, {1, 1, 1}, {1, 1, 1}), Element::tet4, softening());
    test::add_volume(world, body);
    test::hold(world, body, {"x0"});
    return world.compile();
  };
  has(compiled_with(implicit_midpoint()).error(), "implicit_midpoint");
  CHECK(compiled_with(continuation()).ok());
  Bar bar(test::static_options(), {1, 1.1}, softening());
  test::must_advance(bar.world, 1);
  GradientQuery query;
  query.outputs = {Output::elastic_energy()};
  query.parameters = {Parameter::gravity({0, 0, 1})};
  has(bar.world.gradients(query).error(), "remembers");
}
