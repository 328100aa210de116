// The contract of every stencil pool, in the scenes of the registry.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

#include "catch.h"
#include "contract/scene_probe.h"
#include "support/allocations.h"
#include "support/meshes.h"

using namespace isochor;
using test::PoolProbe;
using test::SceneProbe;

namespace {

// Calls `check(probe, case)` for every stencil pool of every scene.
template <class Check>
void for_every_pool(const Check& check) {
  for (const test::SceneCase& c : test::scene_cases()) {
    const SceneProbe scene(c);
    for (const auto& pool : scene.system().parts().stencil_pools) {
      INFO(c.name << ", pool " << pool->name());
      check(PoolProbe(*pool, scene), c);
    }
  }
}

// Largest |difference - exact| over stencils, relative to the largest number met, for the best step of a
// decade sweep. `f` fills a vector at x + h d; `exact` is its derivative along d.
template <class F>
double best_difference_error(const SceneProbe& scene, std::span<const Vec3> d,
                             const std::vector<double>& exact, const F& f) {
  double best = 1;
  double size = 1e-300;
  for (const double e : exact) size = std::max(size, std::abs(e));
  for (double h = 1e-3; h > 1e-9; h /= 10) {
    const auto plus = f(scene.moved(d, h)), minus = f(scene.moved(d, -h));
    double error = 0;
    for (std::size_t i = 0; i < exact.size(); ++i) {
      error = std::max(error, std::abs((plus[i] - minus[i]) / (2 * h) - exact[i]));
    }
    best = std::min(best, error / size);
  }
  return best;
}

std::vector<double> flat(std::span<const Vec3> v) {
  std::vector<double> out;
  for (const Vec3& a : v) out.insert(out.end(), {a.x, a.y, a.z});
  return out;
}

}  // namespace

TEST_CASE("gradients and Jacobians of pools are the slopes of their values") {
  for_every_pool([](const PoolProbe& probe, const test::SceneCase&) {
    const auto d = probe.scene().direction(3);
    const test::Slots at_x = probe.evaluate(Want::gradient, probe.scene().x());
    std::vector<double> slope(at(probe.pool().stencils()), 0), rates(at_x.value.size(), 0);
    const std::size_t K = static_cast<std::size_t>(probe.pool().functions());
    for (Index s = 0; s < probe.pool().stencils(); ++s) {
      const auto nodes = probe.pool().nodes()[s];
      const auto first = at(probe.pool().nodes().offset[at(s)]);
      for (std::size_t a = 0; a < nodes.size(); ++a) {
        slope[at(s)] += dot(at_x.gradient[first + a], d[at(nodes[a])]);
        for (std::size_t k = 0; k < K; ++k) {
          rates[at(s) * K + k] += dot(at_x.jacobian[first * K + k * nodes.size() + a], d[at(nodes[a])]);
        }
      }
    }
    const auto potential = [&](const std::vector<Vec3>& x) {
      const test::Slots slots = probe.evaluate(Want::value, x);
      std::vector<double> p(slots.energy);
      for (std::size_t i = 0; i < slots.value.size(); ++i) p[i / K] += probe.multiplier()[i] * slots.value[i];
      return p;
    };
    CHECK(best_difference_error(probe.scene(), d, slope, potential) < 2e-8);
    if (K == 0) return;
    const auto values = [&](const std::vector<Vec3>& x) { return probe.evaluate(Want::value, x).value; };
    CHECK(best_difference_error(probe.scene(), d, rates, values) < 2e-8);
  });
}

TEST_CASE("Hessians of pools are the slopes of their gradients") {
  for_every_pool([](const PoolProbe& probe, const test::SceneCase&) {
    for (const unsigned seed : {5u, 6u}) {
      const auto d = probe.scene().direction(seed);
      const test::Slots at_x = probe.evaluate(Want::hessian, probe.scene().x());
      std::vector<Vec3> product(at_x.gradient.size());
      for (Index s = 0; s < probe.pool().stencils(); ++s) {
        const auto nodes = probe.pool().nodes()[s];
        const auto first = at(probe.pool().nodes().offset[at(s)]);
        auto block = static_cast<std::size_t>(probe.pool().hessian_offset()[at(s)]);
        for (std::size_t a = 0; a < nodes.size(); ++a) {
          for (std::size_t b = 0; b <= a; ++b, ++block) {
            product[first + a] += at_x.hessian[block] * d[at(nodes[b])];
            if (a != b) product[first + b] += transposed_times(at_x.hessian[block], d[at(nodes[a])]);
          }
        }
      }
      const auto gradient = [&](const std::vector<Vec3>& x) {
        return flat(probe.evaluate(Want::gradient, x).gradient);
      };
      const double error = best_difference_error(probe.scene(), d, flat(product), gradient);
      // A pool without curvature has nothing to compare with.
      const auto& h = at_x.hessian;
      const bool flat_pool = std::all_of(h.begin(), h.end(), [](const Mat3& m) { return m.m == Mat3{}.m; });
      if (!flat_pool) CHECK(error < 2e-8);
    }
  });
}

TEST_CASE("diagonal blocks of stencil Hessians are symmetric") {
  for_every_pool([](const PoolProbe& probe, const test::SceneCase&) {
    const test::Slots at_x = probe.evaluate(Want::hessian, probe.scene().x());
    double worst = 0, size = 0;
    for (const Mat3& h : at_x.hessian) {
      for (const double v : h.m) size = std::max(size, std::abs(v));
    }
    for (Index s = 0; s < probe.pool().stencils(); ++s) {
      const std::size_t n = probe.pool().nodes()[s].size();
      const auto first = static_cast<std::size_t>(probe.pool().hessian_offset()[at(s)]);
      for (std::size_t a = 0; a < n; ++a) {
        const Mat3& h = at_x.hessian[first + a * (a + 1) / 2 + a];
        for (int i = 0; i < 3; ++i) {
          for (int j = 0; j < 3; ++j) {
            worst = std::max(worst, std::abs(h(i, j) - h(j, i)));
          }
        }
      }
    }
    CHECK(worst <= 1e-13 * size);
  });
}

TEST_CASE("pools answer the same bits whatever is asked and however it is split") {
  for_every_pool([](const PoolProbe& probe, const test::SceneCase&) {
    const auto x = probe.scene().x();
    const test::Slots value = probe.evaluate(Want::value, x), gradient = probe.evaluate(Want::gradient, x),
                      hessian = probe.evaluate(Want::hessian, x), split = probe.evaluate_split(x, 3);
    CHECK(test::same_bits(value.energy, hessian.energy));
    CHECK(test::same_bits(value.value, hessian.value));
    CHECK(test::same_bits(gradient.energy, hessian.energy));
    CHECK(test::same_bits(gradient.value, hessian.value));
    CHECK(test::same_bits(gradient.gradient, hessian.gradient));
    CHECK(test::same_bits(gradient.jacobian, hessian.jacobian));
    CHECK(test::same_bits(split.gradient, hessian.gradient));
    CHECK(test::same_bits(split.hessian, hessian.hessian));
  });
}

TEST_CASE("pools write every slot of theirs and no other") {
  for_every_pool([](const PoolProbe& probe, const test::SceneCase&) {
    // Slots start out as NaN: whatever is not written stays so.
    const test::Slots s = probe.evaluate(Want::hessian, probe.scene().x());
    CHECK(test::all_finite(s));
    const Index half = probe.pool().stencils() / 2;
    const test::Slots part = probe.evaluate_range(probe.scene().x(), 0, half);
    for (Index i = 0; i < probe.pool().stencils(); ++i) CHECK(std::isnan(part.energy[at(i)]) == (i >= half));
  });
}

TEST_CASE("solids do not see translations, to the last bit") {
  for (test::SceneCase c : test::scene_cases()) {
    // Positions on a dyadic grid: adding a power of two is exact.
    const auto dyadic = [](const Vec3& p) {
      const auto snap = [](double v) { return std::round(v * 1048576) / 1048576; };
      return Vec3{snap(p.x), snap(p.y), snap(p.z)};
    };
    c.mesh = test::mapped(c.mesh, dyadic);
    for (Mesh& mesh : c.more_bodies) mesh = test::mapped(mesh, dyadic);
    const SceneProbe scene(c);
    auto x = scene.x();
    for (Vec3& p : x) p = dyadic(p);
    auto away = x;
    for (Vec3& p : away) p += Vec3{8, -4, 16};
    for (const auto& pool : scene.system().parts().stencil_pools) {
      if (!dynamic_cast<const SolidPool*>(pool.get())) continue;
      INFO(c.name << ", pool " << pool->name());
      const PoolProbe probe(*pool, scene);
      const test::Slots here = probe.evaluate(Want::hessian, x), there = probe.evaluate(Want::hessian, away);
      CHECK(test::same_bits(here.energy, there.energy));
      CHECK(test::same_bits(here.gradient, there.gradient));
      CHECK(test::same_bits(here.hessian, there.hessian));
      CHECK(test::same_bits(here.value, there.value));
    }
  }
}

TEST_CASE("undeformed pools pull nowhere and their rows are zero") {
  for_every_pool([](const PoolProbe& probe, const test::SceneCase& c) {
    if (!c.stress_free) return;
    const std::vector<double> none(probe.multiplier().size(), 0.0);
    const test::Slots s = probe.evaluate(Want::gradient, probe.scene().rest(), none);
    for (const double e : s.energy) CHECK(e == 0);
    for (const double v : s.value) CHECK(v == 0);
    for (const Vec3& g : s.gradient) CHECK(dot(g, g) == 0);
  });
}

TEST_CASE("evaluating a pool allocates nothing") {
  if (!test::allocations_are_counted()) return;
  for_every_pool([](const PoolProbe& probe, const test::SceneCase&) {
    test::Slots slots(probe.pool());
    const auto x = probe.scene().x();
    const test::AllocationCount allocations;
    for (const Want want : {Want::value, Want::gradient, Want::hessian}) {
      for (const auto definiteness : {Definiteness::exact, Definiteness::projected}) {
        probe.evaluate_into(slots, want, definiteness, x);
      }
    }
    const long count = allocations.count();
    CHECK(count == 0);
  });
}
