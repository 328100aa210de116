// The contract of pools that couple: what they say of the derivatives of their forces in what they hold on to
// is how these change when it is renewed, and the linear system has it where it belongs.
#include <cmath>
#include <random>

#include "catch.h"
#include "contract/scene_probe.h"
#include "engine/solve/kkt/kkt.h"
#include "support/allocations.h"
#include "support/meshes.h"

using namespace isochor;
using test::SceneProbe;

namespace {

double length(const Vec3& v) {
  return std::sqrt(dot(v, v));
}

// Forces of a scene in the middle of an increment, with something kept from the one before.
struct Coupled {
  const SceneProbe& scene;
  const System& system;
  TbbParallel parallel{1};
  Assembly assembly;
  UnsymmetricPart part;
  std::vector<Vec3> before;
  std::vector<double> lambda, prescribed, memory;

  explicit Coupled(const SceneProbe& probe)
      : scene(probe),
        system(probe.system()),
        assembly(probe.shared_system(), parallel),
        part(probe.shared_system(), parallel),
        before(probe.moved(probe.direction(11), 0.02)),
        lambda(probe.multipliers(at(system.rows()))),
        prescribed(probe.multipliers(at(system.prescribed_rows()))),
        memory(at(system.memory())) {
    // Pressing, so that there is friction.
    for (double& l : lambda) l = -0.05 - std::abs(l);
    for (std::size_t i = 0; i < memory.size(); ++i) memory[i] = 0.02 * std::sin(1.0 + 2.3 * double(i));
    assembly.set_increment({0.1, before, 0.2, 0.3}, memory);
  }
  void evaluate(Want want, const std::vector<Vec3>& x, const std::vector<double>& multiplier) {
    assembly.renew_lag(x, multiplier, prescribed);
    assembly.evaluate(want, Definiteness::exact, x, multiplier, prescribed);
  }
  std::vector<Vec3> residual(const std::vector<Vec3>& x, const std::vector<double>& multiplier) {
    evaluate(Want::gradient, x, multiplier);
    std::vector<Vec3> r(x.size());
    assembly.residual(r);
    return r;
  }
};

template <class Check>
void for_every_coupling(const Check& check) {
  int seen = 0;
  for (const test::SceneCase& c : test::scene_cases()) {
    const SceneProbe scene(c);
    if (!scene.system().couples()) continue;
    INFO(c.name);
    ++seen;
    Coupled coupled(scene);
    check(coupled);
  }
  CHECK(seen > 15);
}

std::vector<double> random_numbers(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<double> v(count);
  for (double& e : v) e = unit(random);
  return v;
}

}  // namespace

TEST_CASE("forces of pools that couple change with what they hold on to as these say") {
  int turning = 0;  // scenes in which positions matter, and not multipliers alone
  for_every_coupling([&](Coupled& c) {
    const auto d = c.scene.direction(7);
    const std::vector<double> dl = random_numbers(c.lambda.size(), 3), none(c.lambda.size(), 0);
    c.evaluate(Want::hessian, c.scene.x(), c.lambda);
    c.part.evaluate(c.assembly, c.scene.x());
    std::vector<Vec3> rate(d.size()), by_rows(d.size()), lag(d.size()), row_lag(d.size());
    c.assembly.hessian_times(d, rate);
    c.assembly.constraint_force(dl, by_rows);
    c.part.add_times(d, none, lag);
    c.part.add_times(std::vector<Vec3>(d.size()), dl, row_lag);
    double size = 0, row_size = 0, lag_size = 0, row_lag_size = 0;
    for (std::size_t i = 0; i < d.size(); ++i) {
      rate[i] += lag[i];
      by_rows[i] += row_lag[i];
      size = std::max(size, length(rate[i]));
      row_size = std::max(row_size, length(by_rows[i]));
      lag_size = std::max(lag_size, length(lag[i]));
      row_lag_size = std::max(row_lag_size, length(row_lag[i]));
    }
    // There is something to check; corners on a plane at rest have no frame that turns.
    const bool turns = lag_size > 1e-12 * size;
    turning += turns;
    if (turns)
      CHECK(lag_size > 1e-5 * size);
    else
      lag_size = 1e-2 * size;
    // A load that is given couples positions alone.
    const bool has_rows = !c.lambda.empty();
    if (has_rows) CHECK(row_lag_size > 1e-3 * row_size);
    double best = 1, best_row = 1;
    for (double h = 1e-4; h > 1e-9; h /= 10) {
      auto up = c.lambda, down = c.lambda;
      for (std::size_t r = 0; r < dl.size(); ++r) {
        up[r] += h * dl[r];
        down[r] -= h * dl[r];
      }
      const auto plus = c.residual(c.scene.moved(d, h), c.lambda),
                 minus = c.residual(c.scene.moved(d, -h), c.lambda), plus_row = c.residual(c.scene.x(), up),
                 minus_row = c.residual(c.scene.x(), down);
      double error = 0, row_error = 0;
      for (std::size_t i = 0; i < d.size(); ++i) {
        error = std::max(error, length((1 / (2 * h)) * (plus[i] - minus[i]) - rate[i]));
        row_error = std::max(row_error, length((1 / (2 * h)) * (plus_row[i] - minus_row[i]) - by_rows[i]));
      }
      best = std::min(best, error / lag_size);
      best_row = std::min(best_row, row_error / row_lag_size);
    }
    CHECK(best < 1e-5);
    if (has_rows) CHECK(best_row < 1e-7);
  });
  CHECK(turning > 12);
}

TEST_CASE("the solution of an unsymmetric system solves it") {
  int solved = 0;
  for_every_coupling([&](Coupled& c) {
    const System& s = c.system;
    for (const auto kind : {Solver::automatic, Solver::eigen}) {
      c.evaluate(Want::hessian, c.scene.x(), c.lambda);
      c.part.evaluate(c.assembly, c.scene.x());
      Kkt kkt(c.scene.shared_system(), c.parallel, make_linear_solver(kind));
      kkt.take_unsymmetric(make_unsymmetric_solver(kind));
      // Far from any singular matrix, but not so far that friction would not show.
      const double mass_scale = 10;
      const std::vector<double> stiffness(at(s.nodes()), 1.0), tangent(s.compliance().size(), 0.0);
      std::vector<std::uint8_t> held(at(s.rows()), 0);
      for (std::size_t r = 0; r < held.size(); r += 5) held[r] = s.row_unknown()[r] >= 0;
      Kkt::Values values;
      values.mass_scale = mass_scale;
      values.stiffness = stiffness;
      values.tangent = tangent;
      values.clamped = held;
      values.unsymmetric = &c.part;
      StageSeconds seconds;
      const Kkt::Outcome f = kkt.factor(c.assembly, values, seconds);
      INFO(f.message);
      // More points touch than a rigid body has freedoms.
      if (f.status == FactorStatus::singular) continue;
      REQUIRE(f.status == FactorStatus::ok);
      ++solved;
      CHECK(f.negative == -1);
      std::vector<Vec3> b(at(s.nodes())), u(b.size()), left(b.size()), by_rows(b.size());
      const auto random = random_numbers(3 * b.size(), 5);
      for (std::size_t i = 0; i < b.size(); ++i) b[i] = {random[3 * i], random[3 * i + 1], random[3 * i + 2]};
      std::vector<double> g = random_numbers(at(s.rows()), 6), l(g.size()), Gu(g.size());
      for (std::size_t r = 0; r < g.size(); ++r) g[r] *= held[r] ? 0 : s.row_measure()[r];
      REQUIRE(kkt.solve(b, g, u, l, seconds));
      c.assembly.hessian_times(u, left);
      c.assembly.constraint_force(l, by_rows);
      c.part.add_times(u, l, left);
      c.assembly.jacobian_times(u, Gu);
      for (const ComplianceEntry& e : s.compliance()) {
        Gu[at(e.row)] -= e.value * l[at(e.col)];
        if (e.row != e.col) Gu[at(e.col)] -= e.value * l[at(e.row)];
      }
      double worst = 0, worst_row = 0, largest = 0;
      for (Index i = 0; i < s.nodes(); ++i) {
        const Vec3 f_left = left[at(i)] + by_rows[at(i)] + mass_scale * s.parts().mass[at(i)] * u[at(i)];
        largest = std::max(largest, length(f_left));
        const Index k = s.basis_of()[at(i)];
        Vec3 q = f_left - b[at(i)];
        if (k >= 0) q = transposed_times(s.free_bases()[at(k)].directions, q);
        for (Index e = s.first_unknown()[at(i) + 1] - s.first_unknown()[at(i)]; e < 3; ++e) q[e] = 0;
        worst = std::max(worst, length(q));
      }
      for (std::size_t r = 0; r < l.size(); ++r) {
        if (held[r])
          CHECK(l[r] == 0);
        else
          worst_row = std::max(worst_row, std::abs(Gu[r] - g[r]) / s.row_measure()[r]);
      }
      CHECK(worst < 1e-8 * std::max(1.0, largest));
      CHECK(worst_row < 1e-8);
    }
  });
  CHECK(solved > 25);
}

TEST_CASE("pools that couple answer without allocating, and to the same bits") {
  for_every_coupling([](Coupled& c) {
    const auto d = c.scene.direction(7);
    const std::vector<double> dl = random_numbers(c.lambda.size(), 3);
    std::vector<Vec3> first(d.size()), second(d.size());
    c.evaluate(Want::hessian, c.scene.x(), c.lambda);
    c.part.evaluate(c.assembly, c.scene.x());
    CHECK_FALSE(c.part.vanishes());
    c.part.add_times(d, dl, first);
    const test::AllocationCount allocations;
    c.part.evaluate(c.assembly, c.scene.x());
    c.part.add_times(d, dl, second);
    const long count = allocations.count();
    CHECK(count == 0);
    CHECK(first == second);
    // Where nothing presses there is nothing to couple.
    std::fill(c.prescribed.begin(), c.prescribed.end(), 0.0);
    c.evaluate(Want::gradient, c.scene.x(), std::vector<double>(c.lambda.size(), 0));
    c.part.evaluate(c.assembly, c.scene.x());
    CHECK(c.part.vanishes());
  });
}
