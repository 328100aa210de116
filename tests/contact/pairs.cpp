// Pairs of soft bodies whose answer is known by symmetry, over pressures and contrasts of stiffness.
#include <cmath>

#include "constraints/contact/contact_rows.h"
#include "isochor/contact.h"
#include "support/worlds.h"

namespace {

using namespace isochor;

struct Pressed {
  double force = 0;  // on the top [N]
  std::vector<Vec3> moved;
};

// A block of unit area and half a unit high, its sides held or only its top, pressed by `shortening` against
// its mirror image, or against the plane of symmetry.
Pressed pressed(Element element, double poisson, bool confined, double shortening, int other) {
  World world = test::make_world(test::static_options());
  const CellType type = test::cells_for(element);
  const auto material = test::neo_hookean(2 * (1 + poisson), poisson);  // mu = 1 Pa
  const auto add = [&](double low, double high, int cells, const char* name) {
    const BodyId body = test::add_body(world, test::block({0, 0, low}, {1, 1, high}, {cells, cells, 2}, type),
                                       element, material, 1, name);
    if (poisson > 0.4) test::add_volume(world, body, VolumeSpace::element);
    if (confined) {
      test::hold(world, body, {"x0", "x1"}, {{1, 0, 0}});
      test::hold(world, body, {"y0", "y1"}, {{0, 1, 0}});
    }
    return body;
  };
  const BodyId upper = add(0, 0.5, 4, "upper");
  const std::vector<Vec3> along = confined ? std::vector<Vec3>{{0, 0, 1}} : std::vector<Vec3>{};
  const EffectId top = test::hold(world, upper, {"z1"}, along, {0, 0, -shortening});
  if (other > 0) {
    const BodyId lower = add(-0.5, 0, other, "lower");
    test::hold(world, lower, {"z0"}, along);
    SurfaceContactDef def;
    def.body = upper;
    def.surfaces = {"z0"};
    def.against = lower;
    def.against_surfaces = {"z1"};
    test::value(world.add(surface_contact(def)));
  } else {
    test::hold(world, upper, {"z0"}, {{0, 0, 1}}, {0, 0, -0.5 * shortening});
  }
  for (int k = 0; k < 5; ++k) test::must_advance(world, 0.2);
  Pressed out;
  out.force = -world.reaction(top)[0].z;
  const auto x = world.positions(upper), rest = world.rest_positions(upper);
  for (std::size_t i = 0; i < x.size(); ++i) out.moved.push_back(x[i] - rest[i]);
  return out;
}

double field_error(const Pressed& a, const Pressed& exact) {
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < a.moved.size(); ++i) {
    const Vec3 d = a.moved[i] - exact.moved[i];
    difference += dot(d, d);
    size += dot(exact.moved[i], exact.moved[i]);
  }
  return std::sqrt(difference / size);
}

}  // namespace

TEST_CASE("two equal bodies meet where half of them meets its plane of symmetry, at every pressure") {
  // Confined, pressures of 0.01 to 100 shear moduli.
  for (const double shortening : {0.001, 0.01, 0.1, 0.5}) {
    for (const double poisson : {0.3, 0.45, 0.49}) {
      const Pressed half = pressed(Element::hex8, poisson, true, shortening, 0);
      for (const int other : {4, 5}) {
        const Pressed pair = pressed(Element::hex8, poisson, true, shortening, other);
        INFO("poisson " << poisson << ", pressure " << half.force << " shear moduli, " << other
                        << " cells: force " << pair.force);
        CHECK(field_error(pair, half) < 0.01);
        CHECK(pair.force == Approx(half.force).epsilon(0.02));
      }
    }
  }
  // Free to widen.
  for (const double shortening : {0.02, 0.2}) {
    for (const Element element : {Element::hex8, Element::tet4}) {
      const Pressed half = pressed(element, 0.3, false, shortening, 0);
      const Pressed pair = pressed(element, 0.3, false, shortening, 4);
      INFO(test::name_of(element) << ", shortened by " << shortening << ": " << pair.force << ", "
                                  << half.force);
      // The tets of the other half are no mirror image.
      CHECK(field_error(pair, half) < (element == Element::tet4 ? 0.03 : 0.01));
      CHECK(pair.force == Approx(half.force).epsilon(0.02));
    }
  }
}

// A stiff block with sharp rims that is pressed into a soft slab and shoved: points of the slab lie beside
// the rim and exactly level with its corners.
TEST_CASE("contrasts of stiffness from one to a million take about the same work") {
  for (const double contrast : {1.0, 1e3, 1e6}) {
    World world = test::make_world(test::static_options());
    const BodyId slab =
        test::add_body(world, test::block({-0.5, -0.5, 0}, {0.5, 0.5, 0.5}, {10, 10, 3}, CellType::hex8),
                       Element::hex8, test::neo_hookean(4, 0.3), 1, "slab");
    const BodyId block =
        test::add_body(world, test::block({-0.15, -0.15, 0.5}, {0.15, 0.15, 0.8}, {5, 5, 3}, CellType::hex8),
                       Element::hex8, test::neo_hookean(4 * contrast, 0.3), 1, "block");
    test::hold(world, slab, {"z0"});
    test::hold(world, block, {"z1"}, {}, {0.1, 0, -0.1});
    SurfaceContactDef def;
    def.body = block;
    def.against = slab;
    def.against_surfaces = {"z1"};
    test::value(world.add(surface_contact(def)));
    INFO("contrast " << contrast);
    int iterations = 0, rejected = 0;
    for (int k = 0; k < 10; ++k) {
      const StepReport report = test::must_advance(world, 0.1);
      iterations += report.iterations;
      rejected += report.rejected_substeps;
    }
    CAPTURE(iterations, rejected);
    CHECK(iterations < 200);
    CHECK(rejected <= 2);
    CHECK(test::gauge(world, "normal_force") > 0.01);
  }
}

// Uneven faces pressed together hard and sheared, with the layer that is the default. Of faces this coarse
// some have no equilibrium that the solver finds; a soft layer helps few of them.
TEST_CASE("uneven faces that are pressed together mostly find an equilibrium") {
  int found = 0;
  constexpr std::uint32_t first = 300, count = 12;
  for (std::uint32_t seed = first; seed < first + count; ++seed) {
    std::uint32_t state = seed * 7919u + 1;
    const auto random = [&] {
      state = state * 1664525u + 1013904223u;
      return static_cast<double>(state >> 8) / double{1 << 24} - 0.5;
    };
    Mesh low = test::block({0, 0, 0}, {1, 1, 0.5}, {3, 3, 2}),
         high = test::block({0.2, 0.2, 0.5}, {0.8, 0.8, 1}, {3, 3, 2});
    for (Vec3& x : low.nodes) {
      if (x.z > 0.49) x.z += 0.2 * (random() - 0.5);
    }
    for (Vec3& x : high.nodes) {
      if (x.z < 0.51) x.z += 0.2 * (random() + 0.5);
    }
    World world = test::make_world(test::static_options());
    const auto material = test::neo_hookean(1e5, 0.3);
    const BodyId lower = test::add_body(world, std::move(low), Element::tet4, material, 1000, "lower"),
                 upper = test::add_body(world, std::move(high), Element::tet4, material, 1000, "upper");
    test::hold(world, lower, {"z0"});
    const double x = 0.3 * random(), y = 0.3 * random();
    test::hold(world, upper, {"z1"}, {}, {x, y, -0.3});
    SurfaceContactDef touch;
    touch.body = lower;
    touch.against = upper;
    test::value(world.add(surface_contact(touch)));
    bool converged = true;
    for (int k = 0; k < 4 && converged; ++k) converged = world.advance(0.25).status == StepStatus::converged;
    found += converged ? 1 : 0;
  }
  CHECK(3 * found >= 2 * static_cast<int>(count));
}

TEST_CASE("a layer that stiffens has a potential, and goes on from its linear part") {
  ContactRows rows("rows", 1);
  constexpr double soft = 2e-3, knee = 5;
  std::vector<double> lambda;
  for (const double f : {-3.0, 0.0, 0.4, 0.999, 1.001, 1.5, 4.0, 30.0, 1000.0, 1e5}) {
    rows.add(1, 1, 1, soft);
    rows.knee.push_back(knee);
    lambda.push_back(-f * knee);
  }
  const std::size_t n = lambda.size();
  std::vector<double> strain(n), up(n), down(n), tangent(n);
  const auto at_multipliers = [&](const std::vector<double>& l, std::vector<double>& c,
                                  std::span<double> slope) { return rows.evaluate_law({}, l, c, slope); };
  at_multipliers(lambda, strain, tangent);
  for (std::size_t i = 0; i < n; ++i) {
    INFO("force over that at the knee " << -lambda[i] / knee);
    auto plus = lambda, minus = lambda;
    const double h = 1e-4 * (1 + std::abs(lambda[i]));
    plus[i] += h;
    minus[i] -= h;
    // Alone, as the potentials of the others would drown it.
    ContactRows one("one", 1);
    one.add(1, 1, 1, soft);
    one.knee = {knee};
    double c = 0;
    const double slope = (one.evaluate_law({}, {&plus[i], 1}, {&c, 1}, {}) -
                          one.evaluate_law({}, {&minus[i], 1}, {&c, 1}, {})) /
                         (2 * h);
    CHECK(slope == Approx(strain[i]).epsilon(1e-4).margin(1e-12));
    at_multipliers(plus, up, {});
    at_multipliers(minus, down, {});
    CHECK((up[i] - down[i]) / (2 * h) == Approx(tangent[i]).epsilon(1e-3));
    CHECK(tangent[i] > 0);
    CHECK(rows.depth(static_cast<Index>(i), lambda[i]) == Approx(std::max(0.0, -strain[i])));
    if (-lambda[i] <= knee) CHECK(strain[i] == soft * lambda[i]);
    if (-lambda[i] < 100 * knee) CHECK(-strain[i] < 2.2 * soft * knee);
  }
}
