// Prony series: relaxation and creep in closed form, dissipation, memory as part of the state, refusals.
#include "isochor/viscoelastic.h"

#include <Eigen/Core>
#include <cmath>
#include <random>

#include "engine/base/parallel.h"
#include "engine/elements/relaxation_pool.h"
#include "engine/system/assembly.h"
#include "isochor/gradients.h"
#include "support/compiled.h"
#include "support/dense.h"
#include "support/worlds.h"

using namespace isochor;
using test::value;

namespace {

constexpr double kMu = 1e5;
const std::vector<PronyTerm> kTerms = {{0.3, 0.5}, {0.2, 20}};

MaterialPtr relaxing(StaticTime time = StaticTime::seconds, double poisson = 0.5) {
  ElasticConstants c;
  c.mu = kMu;
  if (poisson == 0.5)
    c.bulk = std::numeric_limits<double>::infinity();
  else
    c.bulk = 2 * kMu * (1 + poisson) / (3 * (1 - 2 * poisson));
  return value(with_prony_series(value(isochoric_neo_hookean(c)), kTerms, time));
}

// A bar of unit sides that is pulled along x to logarithmic strains at given times.
struct Bar {
  World world;
  BodyId body{};
  EffectId end{};

  Bar(const WorldOptions& options, const std::vector<std::pair<double, double>>& strain,
      const MaterialPtr& material, Element element = Element::tet4, VolumeSpace space = VolumeSpace::node,
      double density = 1e-3)
      : world(test::make_world(options)) {
    const CellType type = element == Element::hex8 ? CellType::hex8 : CellType::tet4;
    body =
        test::add_body(world, test::block({0, 0, 0}, {1, 1, 1}, {2, 2, 2}, type), element, material, density);
    test::add_volume(world, body, space);
    test::hold(world, body, {"x0"}, {{1, 0, 0}});
    test::hold(world, body, {"y0"}, {{0, 1, 0}});
    test::hold(world, body, {"z0"}, {{0, 0, 1}});
    Curve way;
    for (const auto& [t, e] : strain) way.points.push_back({t, std::expm1(e)});
    end = test::hold(world, body, {"x1"}, {{1, 0, 0}}, {1, 0, 0}, way);
  }
  double force() const { return std::abs(world.reaction(end)[0].x); }
};

// Nominal stress of an incompressible bar at the logarithmic strain e, of which `elastic` is in the springs.
double nominal(double e, const std::vector<double>& elastic) {
  const double stretch = std::exp(e);
  double sum = 0, stress = 0;
  for (std::size_t i = 0; i < kTerms.size(); ++i) {
    sum += kTerms[i].ratio;
    stress += 3 * kTerms[i].ratio * kMu * elastic[i] / stretch;
  }
  return stress + (1 - sum) * kMu * (stretch - 1 / (stretch * stretch));
}

std::vector<double> of_terms(const std::function<double(double)>& f) {
  std::vector<double> out;
  for (const PronyTerm& t : kTerms) out.push_back(f(t.time));
  return out;
}

double all_ratios() {
  double sum = 0;
  for (const PronyTerm& t : kTerms) sum += t.ratio;
  return sum;
}

}  // namespace

TEST_CASE("a strain that is held relaxes as the series says, at any step") {
  constexpr double e = 0.4, jump = 1e-9;
  for (const Element element : {Element::tet4, Element::tet4_edge_smoothed, Element::tet10, Element::hex8}) {
    Bar bar(test::static_options(), {{0, 0}, {jump, e}, {1e9, e}}, relaxing(), element);
    test::must_advance(bar.world, jump);
    INFO("element " << static_cast<int>(element));
    CHECK(bar.force() == Approx(nominal(e, of_terms([&](double) { return e; }))).epsilon(1e-7));
    double t = 0;
    for (const double h : {0.01, 0.2, 3.0, 50.0, 1e5}) {
      test::must_advance(bar.world, h);
      t += h;
      INFO("t = " << t);
      CHECK(bar.force() ==
            Approx(nominal(e, of_terms([&](double time) { return e * std::exp(-t / time); }))).epsilon(1e-7));
    }
  }
}

TEST_CASE("a constant rate of strain is exact, others to the second order") {
  SECTION("constant rate") {
    constexpr double rate = 0.1;
    std::vector<std::pair<double, double>> way;
    for (int k = 0; k <= 6; ++k) way.push_back({k, rate * k});
    Bar bar(test::static_options(), way, relaxing());
    for (int k = 1; k <= 6; ++k) {
      test::must_advance(bar.world, 1);
      const auto elastic = of_terms([&](double time) { return rate * time * -std::expm1(-k / time); });
      CHECK(bar.force() == Approx(nominal(rate * k, elastic)).epsilon(1e-8));
    }
  }
  SECTION("a cycle") {
    constexpr double w = 2, size = 0.3, end = 3;
    const auto exact = [&](double time) {
      const double a = w * time;
      return size * a / (1 + a * a) * (std::cos(w * end) + a * std::sin(w * end) - std::exp(-end / time));
    };
    std::vector<double> error;
    for (const int steps : {8, 16, 32, 64}) {
      std::vector<std::pair<double, double>> way;
      for (int k = 0; k <= steps; ++k) way.push_back({end * k / steps, size * std::sin(w * end * k / steps)});
      Bar bar(test::static_options(), way, relaxing());
      for (int k = 0; k < steps; ++k) test::must_advance(bar.world, end / steps);
      error.push_back(std::abs(std::abs(nominal(size * std::sin(w * end), of_terms(exact))) - bar.force()));
    }
    for (std::size_t k = 1; k < error.size(); ++k) {
      INFO(error[k - 1] << " then " << error[k]);
      CHECK(error[k - 1] / error[k] > 3.5);
      CHECK(error[k - 1] / error[k] < 4.6);
    }
  }
}

TEST_CASE("creep under a load that stays: a standard linear solid at small strain") {
  // J(t) of G(t) = G0 (1 - g + g exp(-t/tau)): (1 - g exp(-t (1 - g)/tau)) / (G0 (1 - g)).
  constexpr double g = 0.4, tau = 2, end = 3, stress = 3 * kMu * 1e-8;
  ElasticConstants c;
  c.mu = kMu;
  c.bulk = std::numeric_limits<double>::infinity();
  const MaterialPtr solid =
      value(with_prony_series(value(isochoric_neo_hookean(c)), {{g, tau}}, StaticTime::seconds));
  const double exact = stress / (3 * kMu) * (1 - g * std::exp(-end * (1 - g) / tau)) / (1 - g);
  std::vector<double> error;
  for (const int steps : {4, 8, 16}) {
    World world = test::make_world(test::static_options());
    const BodyId body =
        test::add_body(world, test::block({0, 0, 0}, {1, 1, 1}, {1, 1, 1}), Element::tet4, solid);
    test::add_volume(world, body);
    test::hold(world, body, {"x0"}, {{1, 0, 0}});
    test::hold(world, body, {"y0"}, {{0, 1, 0}});
    test::hold(world, body, {"z0"}, {{0, 0, 1}});
    TractionDef pull;
    pull.surface = "x1";
    pull.traction = {stress, 0, 0};
    pull.amount.points = {{0, 0}, {1e-9, 1}, {100, 1}};
    value(world.add(traction(pull)));
    test::must_advance(world, 1e-9);
    CHECK(world.positions(body).back().x - 1 == Approx(stress / (3 * kMu)).epsilon(1e-4));
    for (int k = 0; k < steps; ++k) test::must_advance(world, end / steps);
    error.push_back(std::abs(world.positions(body).back().x - 1 - exact) / exact);
  }
  INFO(error[0] << ", " << error[1] << ", " << error[2]);
  CHECK(error[2] < 1e-3);
  CHECK(error[0] / error[1] > 3.7);
  CHECK(error[1] / error[2] > 3.7);
}

TEST_CASE("every scheme of dynamics sees the same solid where nothing has mass to speak of") {
  constexpr double rate = 0.2;
  std::vector<std::pair<double, double>> way;
  for (int k = 0; k <= 40; ++k) way.push_back({0.05 * k, rate * 0.05 * k});
  for (const SchemePtr& scheme : {implicit_euler(), bdf2(), generalized_alpha(0.5), newmark()}) {
    WorldOptions options = test::dynamic_options();
    options.scheme = scheme;
    Bar bar(options, way, relaxing());
    for (int k = 0; k < 40; ++k) test::must_advance(bar.world, 0.05);
    const auto elastic = of_terms([&](double time) { return rate * time * -std::expm1(-2 / time); });
    CHECK(bar.force() == Approx(nominal(rate * 2, elastic)).epsilon(1e-5));
  }
}

TEST_CASE("relaxation times next to nothing and next to forever") {
  constexpr double e = 0.2, share = 0.3;
  ElasticConstants c;
  c.mu = kMu;
  c.bulk = std::numeric_limits<double>::infinity();
  for (const double time : {5e-324, 1e-310, 1e-300, 1e-12, 1e12, 1e300, 1.7e308}) {
    const MaterialPtr solid =
        value(with_prony_series(value(isochoric_neo_hookean(c)), {{share, time}}, StaticTime::seconds));
    for (const double end : {1e-20, 1.0, 1e9}) {
      Bar bar(test::static_options(), {{0, 0}, {end, e}, {2 * end, e}}, solid);
      INFO("time " << time << ", end " << end);
      test::must_advance(bar.world, end);
      test::must_advance(bar.world, end);
      const double x = end / time, stretch = std::exp(e);
      const double left = x > 1e3 ? 0 : (x < 1e-9 ? 1 : -std::expm1(-x) / x * std::exp(-x));
      const double exact =
          (1 - share) * kMu * (stretch - 1 / (stretch * stretch)) + 3 * share * kMu * left * e / stretch;
      CHECK(bar.force() == Approx(exact).epsilon(1e-6));
    }
  }
}

TEST_CASE("statics are long-term unless they are in seconds") {
  constexpr double e = 0.2;
  Bar bar(test::static_options(), {{0, 0}, {1, e}}, relaxing(StaticTime::long_term));
  test::must_advance(bar.world);
  CHECK(bar.force() == Approx(nominal(e, {0, 0})).epsilon(1e-9));
}

TEST_CASE("stresses of cells are those that the supports feel") {
  constexpr double e = 0.3;
  for (const Element element : {Element::tet4, Element::tet4_edge_smoothed, Element::tet10, Element::hex8}) {
    Bar bar(test::static_options(), {{0, 0}, {0.4, e}, {100, e}}, relaxing(), element);
    for (int k = 0; k < 3; ++k) {
      test::must_advance(bar.world, 0.4);
      const double tension = bar.force() * std::exp(e);
      for (const double s : bar.world.fields(bar.body).cell_von_mises)
        REQUIRE(s == Approx(tension).epsilon(1e-6));
    }
  }
}

TEST_CASE("stored energy falls where a strain is held, to that of what stays") {
  constexpr double e = 0.3;
  Bar bar(test::static_options(), {{0, 0}, {1e-9, e}, {1e9, e}}, relaxing());
  test::must_advance(bar.world, 1e-9);
  const auto stored = [&] { return bar.world.energies().elastic; };
  const double stays = (1 - all_ratios()) * kMu / 2 * (std::exp(2 * e) + 2 * std::exp(-e) - 3);
  CHECK(stored() == Approx(stays + 1.5 * all_ratios() * kMu * e * e).epsilon(1e-6));
  double before = stored();
  for (const double h : {0.1, 1.0, 10.0, 1e4}) {
    test::must_advance(bar.world, h);
    CHECK(stored() < before);
    before = stored();
  }
  CHECK(before == Approx(stays).epsilon(1e-9));
}

// Of one point, driven by random gradients through random times: what it stores never exceeds what was put
// in.
TEST_CASE("dissipation is never negative, and a rotation of space changes nothing") {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1, 1), decades(-3, 3);
  BodyDef body;
  body.mesh = test::block({0, 0, 0}, {1, 1, 1}, {1, 1, 1});
  body.element = Element::tet4;
  body.materials = {{"", relaxing(StaticTime::seconds, 0.4), 1000}};
  const test::Compiled compiled = test::compile({body}, {});
  REQUIRE(compiled.error.empty());
  const auto& parts = compiled.system->parts();
  const auto& rest = parts.rest;
  for (const auto& remembering : compiled.system->facets().remembering) {
    const auto& pool =
        static_cast<const RelaxationPool&>(*parts.stencil_pools[static_cast<std::size_t>(remembering.pool)]);
    const auto n = static_cast<std::size_t>(pool.stencils());
    std::vector<double> memory(static_cast<std::size_t>(pool.memory()), 0), after = memory, turned = memory;
    std::vector<Vec3> before = rest;
    StencilRequest request;
    request.end = pool.stencils();
    request.rest = rest;
    std::vector<double> energy(n), value_of(1);
    std::vector<Vec3> gradient(pool.nodes().item.size()), jacobian(1);
    std::vector<Mat3> hessian(1);
    const auto stored = [&](std::span<const Vec3> x, std::span<const double> m, double h) {
      request.want = Want::value;
      request.x = x;
      request.memory = m;
      request.increment = {h, {}, 0, h};
      pool.evaluate(request, {energy, value_of, gradient, jacobian, hessian});
      double sum = 0;
      for (const double v : energy) sum += v;
      return sum;
    };
    for (int k = 0; k < 200; ++k) {
      std::vector<Vec3> x = rest;
      for (Vec3& p : x) p += 0.25 * Vec3{unit(random), unit(random), unit(random)};
      const double h = std::pow(10, decades(random));
      const double elastic = stored(x, memory, 0);  // had nothing flowed on the way
      const double potential = stored(x, memory, h);
      if (!std::isfinite(elastic)) continue;
      REQUIRE(std::isfinite(potential));
      std::copy(memory.begin(), memory.end(), after.begin());
      pool.accept(request, after);
      CHECK(stored(x, after, 0) <= potential * (1 + 1e-12));
      // The same motion, seen from elsewhere.
      const double a = unit(random) * 3;
      std::vector<Vec3> y = x;
      for (Vec3& p : y) {
        p = {std::cos(a) * p.x - std::sin(a) * p.y + 3, std::sin(a) * p.x + std::cos(a) * p.y, p.z};
      }
      CHECK(stored(y, memory, h) == Approx(potential).epsilon(1e-9).margin(1e-9));
      turned = memory;
      pool.accept(request, turned);
      for (std::size_t i = 0; i < turned.size(); ++i)
        REQUIRE(turned[i] == Approx(after[i]).epsilon(1e-8).margin(1e-8));
      memory = after;
      before = x;
    }
  }
}

TEST_CASE("forces and matrices are the slopes of an increment's potential, whatever has flowed") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (const Element element : {Element::tet4_edge_smoothed, Element::tet10}) {
    BodyDef body;
    body.mesh = test::block({0, 0, 0}, {1, 1, 1}, {1, 1, 1});
    body.element = element;
    body.materials = {{"", relaxing(StaticTime::seconds, 0.4), 1000}};
    const test::Compiled compiled = test::compile({body}, {});
    REQUIRE(compiled.error.empty());
    const auto& rest = compiled.system->parts().rest;
    const auto moved = [&](const std::vector<Vec3>& from, const std::vector<Vec3>& d, double h) {
      auto x = from;
      for (std::size_t i = 0; i < x.size(); ++i) x[i] += h * d[i];
      return x;
    };
    const auto noise = [&] {
      std::vector<Vec3> d(rest.size());
      for (Vec3& v : d) v = {unit(random), unit(random), unit(random)};
      return d;
    };
    std::vector<double> memory(static_cast<std::size_t>(compiled.system->memory()), 0);
    const auto before = moved(rest, noise(), 0.1);
    for (const auto& m : compiled.system->facets().remembering) {
      StencilRequest request;
      request.x = before;
      request.rest = rest;
      request.increment = {0.3, rest, 0, 0.3};
      const std::vector<double> none(memory.size(), 0);
      request.memory = m.in(std::span<const double>(none));
      m.facet->accept(request, m.in(std::span<double>(memory)));
    }
    TbbParallel parallel(1);
    Assembly assembly(compiled.system, parallel);
    assembly.set_increment({0.2, before, 0.3, 0.5}, memory);
    const auto evaluate = [&](Want want, Definiteness policy, const std::vector<Vec3>& x) {
      assembly.evaluate(want, policy, x, {}, {});
    };
    const auto force = [&](const std::vector<Vec3>& x) {
      evaluate(Want::gradient, Definiteness::exact, x);
      std::vector<Vec3> r(x.size());
      assembly.residual(r);
      return r;
    };
    const auto energy = [&](const std::vector<Vec3>& x) {
      evaluate(Want::value, Definiteness::exact, x);
      return assembly.energy();
    };
    const auto x = moved(before, noise(), 0.08), d = noise();
    constexpr double e = 1e-5;
    const auto f = force(x), plus = force(moved(x, d, e)), minus = force(moved(x, d, -e));
    double slope = 0, size = 0, bend_size = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      slope += dot(f[i], d[i]);
      size += norm(f[i]);
    }
    CHECK((energy(moved(x, d, e)) - energy(moved(x, d, -e))) / (2 * e) == Approx(slope).margin(1e-7 * size));
    evaluate(Want::hessian, Definiteness::exact, x);
    std::vector<Vec3> y(x.size());
    assembly.hessian_times(d, y);
    for (const Vec3& v : y) bend_size = std::max(bend_size, norm(v));
    for (std::size_t i = 0; i < x.size(); ++i)
      REQUIRE(norm((1 / (2 * e)) * (plus[i] - minus[i]) - y[i]) < 1e-6 * bend_size);
    // Crushed, where springs that are not made definite are not.
    const auto crushed = moved(
        rest,
        [&] {
          std::vector<Vec3> way(rest.size());
          for (std::size_t i = 0; i < way.size(); ++i) way[i] = {0, 0, -0.7 * rest[i].z};
          return way;
        }(),
        1);
    const auto lowest = [&](Definiteness policy) {
      evaluate(Want::hessian, policy, crushed);
      const auto n = static_cast<Eigen::Index>(3 * rest.size());
      Eigen::MatrixXd K(n, n);
      for (Eigen::Index c = 0; c < n; ++c) {
        std::vector<Vec3> unit_way(rest.size());
        unit_way[static_cast<std::size_t>(c / 3)][static_cast<int>(c % 3)] = 1;
        std::fill(y.begin(), y.end(), Vec3{});
        assembly.hessian_times(unit_way, y);
        for (Eigen::Index r = 0; r < n; ++r)
          K(r, c) = y[static_cast<std::size_t>(r / 3)][static_cast<int>(r % 3)];
      }
      const Eigen::VectorXd values = test::eigenvalues(K);
      return values[0] / values[n - 1];
    };
    CHECK(lowest(Definiteness::exact) < -1e-3);
    CHECK(lowest(Definiteness::projected) > -1e-9);
    CHECK(lowest(Definiteness::absolute) > -1e-9);
  }
}

TEST_CASE("memory is part of the state") {
  const std::vector<std::pair<double, double>> way = {{0, 0}, {0.3, 0.4}, {1, 0.1}, {2, 0.5}, {1e3, 0.5}};
  const auto begin = [&](int threads) {
    WorldOptions options = test::static_options();
    options.threads = threads;
    return Bar(options, way, relaxing(), Element::tet4_edge_smoothed);
  };
  Bar bar = begin(1), two = begin(2);
  for (int k = 0; k < 4; ++k) {
    test::must_advance(bar.world, 0.2);
    test::must_advance(two.world, 0.2);
  }
  CHECK(bar.world.state_hash() == two.world.state_hash());
  const auto saved = bar.world.save();
  World clone = value(bar.world.clone());
  test::must_advance(bar.world, 0.7);
  const auto hash = bar.world.state_hash();
  test::must_advance(clone, 0.7);
  CHECK(clone.state_hash() == hash);
  value(bar.world.load(saved));
  test::must_advance(bar.world, 0.7);
  CHECK(bar.world.state_hash() == hash);
  SECTION("it stays where the scene changes") {
    value(two.world.load(saved));
    test::add_body(two.world, test::block({5, 0, 0}, {6, 1, 1}, {1, 1, 1}), Element::tet4,
                   relaxing(StaticTime::seconds, 0.4), 1000, "other");
    test::hold(two.world, two.world.bodies().back(), {"x0", "x1", "y0"});
    test::must_advance(two.world, 0.7);
    const auto x = bar.world.positions(bar.body), y = two.world.positions(two.body);
    for (std::size_t i = 0; i < x.size(); ++i) REQUIRE(norm(x[i] - y[i]) < 1e-9);
    CHECK(two.force() == Approx(bar.force()).epsilon(1e-8));
  }
  SECTION("reset forgets") {
    value(bar.world.reset());
    Bar fresh = begin(1);
    test::must_advance(bar.world, 0.2);
    test::must_advance(fresh.world, 0.2);
    CHECK(bar.world.state_hash() == fresh.world.state_hash());
  }
}

TEST_CASE("fields of stiffness and fibers go around a series") {
  constexpr double e = 0.2, factor = 3;
  const auto cells = test::block({0, 0, 0}, {1, 1, 1}, {2, 2, 2}).cells.size() / 4;
  const MaterialPtr stiffer = value(with_stiffness_field(relaxing(), std::vector<double>(cells, factor)));
  Bar plain(test::static_options(), {{0, 0}, {0.4, e}, {100, e}}, relaxing());
  Bar bar(test::static_options(), {{0, 0}, {0.4, e}, {100, e}}, stiffer);
  for (int k = 0; k < 2; ++k) {
    test::must_advance(plain.world, 0.4);
    test::must_advance(bar.world, 0.4);
    CHECK(bar.force() == Approx(factor * plain.force()).epsilon(1e-8));
  }
  // Fibers along the bar add what they pull with, and a penalty on changes of volume adds nothing: at all
  // times.
  FiberFamily fibers;
  fibers.direction = {1, 0, 0};
  fibers.k1 = kMu;
  Bar reinforced(test::static_options(), {{0, 0}, {0.4, e}, {100, e}},
                 value(with_fibers(relaxing(), {fibers})));
  Bar penalized(test::static_options(), {{0, 0}, {0.4, e}, {100, e}},
                value(with_compression_penalty(relaxing(), {25 * kMu, 9})));
  Bar bare(test::static_options(), {{0, 0}, {0.4, e}, {100, e}}, relaxing());
  const double E = std::expm1(2 * e), pull = 2 * kMu * E * std::exp(e);
  for (int k = 0; k < 3; ++k) {
    for (World* world : {&reinforced.world, &penalized.world, &bare.world}) test::must_advance(*world, 0.4);
    CHECK(reinforced.force() - bare.force() == Approx(pull).epsilon(1e-7));
    CHECK(penalized.force() == Approx(bare.force()).epsilon(1e-7));
  }
}

TEST_CASE("compressible bodies relax in shape alone: a bar that cannot get thinner") {
  constexpr double poisson = 0.4, e = 1e-5;
  const double bulk = 2 * kMu * (1 + poisson) / (3 * (1 - 2 * poisson));
  for (const bool rows : {false, true}) {
    World world = test::make_world(test::static_options());
    const BodyId body = test::add_body(world, test::block({0, 0, 0}, {1, 1, 1}, {1, 1, 1}), Element::tet4,
                                       relaxing(StaticTime::seconds, poisson));
    if (rows) test::add_volume(world, body);
    for (const char* side : {"y0", "y1"}) test::hold(world, body, {side}, {{0, 1, 0}});
    for (const char* side : {"z0", "z1"}) test::hold(world, body, {side}, {{0, 0, 1}});
    test::hold(world, body, {"x0"}, {{1, 0, 0}});
    Curve way;
    way.points = {{0, 0}, {1e-9, e}, {1e9, e}};
    const EffectId end = test::hold(world, body, {"x1"}, {{1, 0, 0}}, {1, 0, 0}, way);
    test::must_advance(world, 1e-9);
    CHECK(std::abs(world.reaction(end)[0].x) == Approx((bulk + 4 * kMu / 3) * e).epsilon(1e-4));
    test::must_advance(world, 1e6);
    CHECK(std::abs(world.reaction(end)[0].x) ==
          Approx((bulk + 4 * kMu * (1 - all_ratios()) / 3) * e).epsilon(1e-4));
  }
}

TEST_CASE("series that mean nothing are refused") {
  const auto refused = [](const MaterialPtr& base, const std::vector<PronyTerm>& terms) {
    const auto made = with_prony_series(base, terms);
    REQUIRE_FALSE(made);
    return made.error();
  };
  ElasticConstants c;
  c.young = 1e5;
  c.poisson = 0.4;
  const MaterialPtr base = value(isochoric_neo_hookean(c));
  CHECK(refused(nullptr, {{0.1, 1}}).find("empty") != std::string::npos);
  CHECK(refused(base, {}).find("no terms") != std::string::npos);
  CHECK(refused(base, {{0, 1}}).find("terms[0].ratio = 0;") != std::string::npos);
  CHECK(refused(base, {{0.1, 1}, {-0.2, 1}}).find("terms[1].ratio = -0.2;") != std::string::npos);
  CHECK(refused(base, {{0.1, 0}}).find("terms[0].time = 0 s") != std::string::npos);
  CHECK(refused(base, {{0.1, std::nan("")}}).find("time") != std::string::npos);
  CHECK(refused(base, {{0.6, 1}, {0.4, 2}}).find("sum to 1;") != std::string::npos);
  CHECK(refused(value(neo_hookean(c)), {{0.1, 1}}).find("isochoric_neo_hookean") != std::string::npos);
  CHECK(refused(value(with_prony_series(base, {{0.1, 1}})), {{0.1, 1}}).find("already") != std::string::npos);
  const auto field = with_poisson_field(
      [&](double nu) -> Result<MaterialPtr> { return relaxing(StaticTime::seconds, nu); }, {0.3, 0.4});
  REQUIRE_FALSE(field);
  CHECK(field.error().find("has a memory") != std::string::npos);
  CHECK(refused(value(with_stiffness_field(base, {1, 2})), {{0.1, 1}}).find("field") != std::string::npos);

  const auto compiled_with = [&](const SchemePtr& scheme) {
    WorldOptions options = test::dynamic_options();
    options.scheme = scheme;
    World world = test::make_world(options);
    const BodyId body =
        test::add_body(world, test::block({0, 0, 0}, {1, 1, 1}, {1, 1, 1}), Element::tet4, relaxing());
    test::add_volume(world, body);
    test::hold(world, body, {"x0"});
    return world.compile();
  };
  CHECK(compiled_with(implicit_midpoint()).error().find("implicit_midpoint") != std::string::npos);
  CHECK(compiled_with(continuation()).error().find("no time") != std::string::npos);
  CHECK(compiled_with(implicit_euler()).ok());
  Bar bar(test::static_options(), {{0, 0}, {1, 0.1}}, relaxing());
  test::must_advance(bar.world, 1);
  GradientQuery query;
  query.outputs = {Output::elastic_energy()};
  query.parameters = {Parameter::gravity({0, 0, 1})};
  CHECK(bar.world.gradients(query).error().find("remembers") != std::string::npos);
}
