// Damping: derivatives within an increment, no price for rigid motions, and closed forms of creep and fall.
#include <random>

#include "engine/system/assembly.h"
#include "numbers/cube.h"
#include "support/compiled.h"

using namespace isochor;
using namespace test;

namespace {

// A cube with damping alone in the increment: energies with minus energies without.
struct Damped {
  Compiled compiled;
  TbbParallel parallel{1};
  std::unique_ptr<Assembly> assembly;
  std::vector<Vec3> rest;

  Damped() {
    BodyDef body;
    body.mesh = uneven_cube();
    body.element = Element::tet4_edge_smoothed;
    body.materials = {{"", test::neo_hookean(3, 0.3), 1000}};
    DampingDef def;
    def.viscosity = 0.7;
    def.mass_rate = 0.002;
    compiled = test::compile({body}, {damping(def)});
    REQUIRE(compiled.error.empty());
    assembly = std::make_unique<Assembly>(compiled.system, parallel);
    rest = compiled.system->parts().rest;
  }
  void evaluate(Want want, Definiteness policy, const std::vector<Vec3>& x, const std::vector<Vec3>& before,
                double h) {
    assembly->set_increment({h, before});
    assembly->evaluate(want, policy, x, {}, {});
  }
  double energy(const std::vector<Vec3>& x, const std::vector<Vec3>& before, double h) {
    evaluate(Want::value, Definiteness::exact, x, before, h);
    return assembly->energy();
  }
  std::vector<Vec3> force(const std::vector<Vec3>& x, const std::vector<Vec3>& before, double h) {
    evaluate(Want::gradient, Definiteness::exact, x, before, h);
    std::vector<Vec3> r(x.size());
    assembly->residual(r);
    return r;
  }
  double bend(Definiteness policy, const std::vector<Vec3>& x, const std::vector<Vec3>& before, double h,
              const std::vector<Vec3>& d) {
    evaluate(Want::hessian, policy, x, before, h);
    std::vector<Vec3> y(x.size());
    assembly->hessian_times(d, y);
    double sum = 0;
    for (std::size_t i = 0; i < d.size(); ++i) sum += dot(d[i], y[i]);
    return sum;
  }
};

std::vector<Vec3> noise(const std::vector<Vec3>& x, double size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-size, size);
  auto out = x;
  for (Vec3& p : out) p += Vec3{unit(random), unit(random), unit(random)};
  return out;
}

std::vector<Vec3> moved(const std::vector<Vec3>& x, const std::vector<Vec3>& d, double h) {
  auto out = x;
  for (std::size_t i = 0; i < x.size(); ++i) out[i] += h * d[i];
  return out;
}

}  // namespace

TEST_CASE("damping forces and Hessians are the slopes of its increment") {
  Damped c;
  const auto before = noise(c.rest, 0.05, 1), x = noise(c.rest, 0.05, 2);
  const auto d = noise(std::vector<Vec3>(x.size()), 1, 3);
  const double h = 0.02, e = 1e-5;
  const auto f = c.force(x, before, h), plus = c.force(moved(x, d, e), before, h),
             minus = c.force(moved(x, d, -e), before, h);
  double slope = 0, bend = 0;
  for (std::size_t i = 0; i < d.size(); ++i) {
    slope += dot(f[i], d[i]);
    bend += dot(plus[i] - minus[i], d[i]) / (2 * e);
  }
  const double up = c.energy(moved(x, d, e), before, h), down = c.energy(moved(x, d, -e), before, h);
  CHECK((up - down) / (2 * e) == Approx(slope).epsilon(1e-7));
  CHECK(c.bend(Definiteness::exact, x, before, h, d) == Approx(bend).epsilon(1e-7));
  // Large: the damping of this increment outweighs the elastic forces.
  CHECK(c.energy(x, before, h) > 3 * c.energy(x, before, 0));
}

TEST_CASE("definite damping Hessians add no negative curvature") {
  Damped c;
  const auto before = noise(c.rest, 0.1, 4), x = noise(c.rest, 0.1, 5);
  for (unsigned seed = 6; seed < 30; ++seed) {
    const auto d = noise(std::vector<Vec3>(x.size()), 1, seed);
    const double exact = c.bend(Definiteness::exact, x, before, 0.02, d);
    for (const auto policy : {Definiteness::projected, Definiteness::absolute}) {
      const double with = c.bend(policy, x, before, 0.02, d), without = c.bend(policy, x, before, 0, d);
      CHECK(with >= without);
      CHECK(with >= exact * (1 - 1e-12));
    }
  }
}

TEST_CASE("viscosity costs nothing in rigid motions, and nothing without an increment") {
  Damped c;
  const auto before = noise(c.rest, 0.05, 7);
  auto turned = before;
  const double s = std::sin(0.8), k = std::cos(0.8);
  for (Vec3& p : turned) p = Vec3{k * p.x - s * p.y, s * p.x + k * p.y, p.z};
  // The mass part sees the motion; take it off.
  double drag = 0;
  for (std::size_t i = 0; i < turned.size(); ++i) {
    const Vec3 d = turned[i] - before[i];
    drag += 0.5 * 0.002 / 0.02 * c.compiled.system->parts().mass[i] * dot(d, d);
  }
  const double elastic = c.energy(before, before, 0);
  CHECK(c.energy(turned, before, 0.02) == Approx(elastic + drag).epsilon(1e-12));
  CHECK(c.energy(before, before, 0.02) == elastic);
}

TEST_CASE("a loaded bar creeps as a Kelvin-Voigt solid") {
  constexpr double young = 1e5, pull = 10, tau = 0.05, h = 0.01;
  WorldOptions options = dynamic_options();
  World world = make_world(options);
  const BodyId body = add_body(world, box({1, 1, 1}), Element::tet4, test::neo_hookean(young, 0.5), 1e-6);
  add_volume(world, body);
  slide_on_axes(world, body);
  TractionDef load;
  load.body = body;
  load.surface = "x1";
  load.traction = {pull, 0, 0};
  value(world.add(traction(load)));
  DampingDef def;
  def.body = body;
  def.viscosity = young * tau / 3;
  value(world.add(damping(def)));
  if (auto r = world.compile(); !r) FAIL(r.error());
  // Implicit Euler of tau strain' + strain = pull / young, with the small mass left out.
  double strain = 0;
  for (int step = 0; step < 12; ++step) {
    REQUIRE(world.step(h).status == StepStatus::converged);
    strain = (strain + h / tau * pull / young) / (1 + h / tau);
    CHECK(displacement_at(world, body, {1, 1, 1}).x == Approx(strain).epsilon(1e-3));
  }
}

TEST_CASE("a falling body with drag in its mass reaches its terminal speed") {
  constexpr double rate = 4, g = 9.81, h = 0.02;
  WorldOptions options = dynamic_options();
  options.gravity = {0, 0, -g};
  World world = make_world(options);
  const BodyId body = add_body(world, uneven_cube(), Element::tet4, test::neo_hookean(1e5, 0.3));
  DampingDef def;
  def.body = body;
  def.mass_rate = rate;
  value(world.add(damping(def)));
  if (auto r = world.compile(); !r) FAIL(r.error());
  double speed = 0, fallen = 0;
  for (int step = 0; step < 60; ++step) {
    REQUIRE(world.step(h).status == StepStatus::converged);
    speed = (speed + h * g) / (1 + rate * h);
    fallen += h * speed;
    CHECK(displacement_at(world, body, {1, 1, 1}).z == Approx(-fallen).epsilon(1e-7));
  }
  CHECK(speed == Approx(g / rate).epsilon(0.02));
}

TEST_CASE("damping that feeds or does nothing is refused") {
  World world = make_world(dynamic_options());
  const BodyId body = add_body(world, box({1, 1, 1}), Element::tet4, test::neo_hookean(1e5, 0.3));
  DampingDef def;
  def.body = body;
  CHECK_THAT(world.add(damping(def)).error(), ContainsSubstring("both zero"));
  def.viscosity = -3;
  CHECK_THAT(world.add(damping(def)).error(), ContainsSubstring("viscosity = -3"));
}
