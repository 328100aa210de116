// What docs/adding-a-constraint.md states of pools, rows and gauges beside their derivatives: nothing is
// computed that was not asked, definite Hessians are definite, outside of the domain the energy is infinite,
// and targets, compliances, metrics and gauges have the units and signs that they are said to have.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "catch.h"
#include "contract/scene_probe.h"
#include "engine/elements/solid_pool.h"
#include "support/dense.h"
#include "support/meshes.h"

using namespace isochor;
using test::PoolProbe;
using test::SceneProbe;

namespace {

template <class Check>
void for_every_pool(const Check& check) {
  for (const test::SceneCase& c : test::scene_cases()) {
    const SceneProbe scene(c);
    for (const auto& pool : scene.system().parts().stencil_pools) {
      INFO(c.name << ", pool " << pool->name());
      check(PoolProbe(*pool, scene));
    }
  }
}

// Grows with time; a balance of energy is taken under one growth.
bool grows(const StencilPool& pool) {
  const auto* solid = dynamic_cast<const SolidPool*>(&pool);
  return solid && solid->growth();
}

bool untouched(std::span<const Vec3> slots) {
  return std::all_of(slots.begin(), slots.end(),
                     [](const Vec3& v) { return std::isnan(v.x) && std::isnan(v.y) && std::isnan(v.z); });
}

bool untouched(std::span<const Mat3> slots) {
  return std::all_of(slots.begin(), slots.end(), [](const Mat3& m) {
    return std::all_of(m.m.begin(), m.m.end(), [](double v) { return std::isnan(v); });
  });
}

MaterialPtr material(double young) {
  ElasticConstants c;
  c.young = young;
  c.poisson = 0.3;
  return std::move(neo_hookean(c)).value();
}

// The scene with bodies of one material, of this modulus.
test::SceneCase of_modulus(test::SceneCase c, double young) {
  for (RegionMaterial& region : c.materials) region.material = material(young);
  return c;
}

double entry_sum(const RowPool& rows) {
  double sum = 0;
  for (const ComplianceEntry& e : rows.compliance) sum += std::abs(e.value);
  return sum;
}

// A scene at its sample state with multipliers inside their bounds, and what its gauges say there.
struct GaugeProbe {
  const SceneProbe& scene;
  const System& system;
  State state;
  std::vector<double> prescribed;

  explicit GaugeProbe(const SceneProbe& probe) : scene(probe), system(probe.system()) {
    state.x = probe.x();
    state.v.assign(state.x.size(), Vec3{});
    state.lambda = probe.multipliers(at(system.rows()));
    for (std::size_t r = 0; system.has_bounds() && r < state.lambda.size(); ++r) {
      if (system.row_lower()[r] == 0) state.lambda[r] = std::abs(state.lambda[r]);
      if (system.row_upper()[r] == 0) state.lambda[r] = -std::abs(state.lambda[r]);
    }
    state.extra.resize(at(system.memory()));
    system.start_memory(state.extra);
    prescribed.resize(at(system.prescribed_rows()));
    for (Index p = 0; p < static_cast<Index>(system.parts().row_pools.size()); ++p) {
      const RowPool& rows = *system.parts().row_pools[at(p)];
      if (rows.law == RowLaw::prescribed)
        rows.update(0, std::span(prescribed).subspan(at(system.first_row(p)), at(rows.rows())));
    }
  }

  std::map<std::string, Gauge> of(const EffectInstance& effect, std::span<const Vec3> x) const {
    State there = state;
    there.x.assign(x.begin(), x.end());
    std::vector<Gauge> list;
    effect.gauges({system, there}, list);
    std::map<std::string, Gauge> out;
    for (const Gauge& g : list) out[g.quantity] = g;
    return out;
  }
  std::map<std::string, Gauge> of(const EffectInstance& effect) const { return of(effect, state.x); }

  // The rows of one pool and their multipliers; the forces on the nodes are minus the slopes of their sum.
  double row_work(Index pool, std::span<const Vec3> d) const {
    const RowPool& rows = *system.parts().row_pools[at(pool)];
    const PoolProbe stencils(*system.parts().stencil_pools[at(rows.stencil_pool)], scene);
    const test::Slots slots = stencils.evaluate(Want::gradient, state.x);
    const auto K = static_cast<std::size_t>(stencils.pool().functions());
    const auto& all = rows.law == RowLaw::compliant ? state.lambda : prescribed;
    double work = 0;
    for (Index r = 0; r < rows.rows(); ++r) {
      double rate = 0;
      for (Index k = rows.map.offset[at(r)]; k < rows.map.offset[at(r) + 1]; ++k) {
        const auto function = at(rows.map.item[at(k)]);
        const Index s = static_cast<Index>(function / K);
        const auto nodes = stencils.pool().nodes()[s];
        const std::size_t first =
            at(stencils.pool().nodes().offset[at(s)]) * K + (function % K) * nodes.size();
        for (std::size_t a = 0; a < nodes.size(); ++a)
          rate += rows.weight[at(k)] * dot(slots.jacobian[first + a], d[at(nodes[a])]);
      }
      work -= all[at(system.first_row(pool) + r)] * rate;
    }
    return work;
  }
  // Value, and target at time 1, of the only row of a pool.
  double row_value(Index pool) const {
    const RowPool& rows = *system.parts().row_pools[at(pool)];
    const PoolProbe stencils(*system.parts().stencil_pools[at(rows.stencil_pool)], scene);
    const test::Slots slots = stencils.evaluate(Want::value, state.x);
    double sum = 0;
    for (std::size_t k = 0; k < rows.map.item.size(); ++k)
      sum += rows.weight[k] * slots.value[at(rows.map.item[k])];
    return sum;
  }
  double row_target(Index pool) const {
    std::vector<double> target(1);
    system.parts().row_pools[at(pool)]->update(1, target);
    return target[0];
  }
  // Row pools whose name is the effect's, or begins with it.
  std::vector<Index> pools_of(const std::string& effect) const {
    std::vector<Index> out;
    for (Index p = 0; p < static_cast<Index>(system.parts().row_pools.size()); ++p) {
      if (system.parts().row_pools[at(p)]->name().starts_with(effect)) out.push_back(p);
    }
    return out;
  }
};

// Calls check(gauges, effect, quantities, case) for every effect with gauges.
template <class Check>
void for_every_gauged(const Check& check) {
  for (const test::SceneCase& c : test::scene_cases()) {
    const SceneProbe scene(c);
    const GaugeProbe gauges(scene);
    for (const auto& effect : scene.instances()) {
      const auto quantities = gauges.of(*effect);
      if (quantities.empty()) continue;
      INFO(c.name << ", effect " << quantities.begin()->second.effect);
      check(gauges, *effect, quantities, c);
    }
  }
}

// The slope of a gauge along d.
double slope(const GaugeProbe& probe, const EffectInstance& effect, const std::string& quantity,
             std::span<const Vec3> d) {
  constexpr double h = 1e-5;
  return (probe.of(effect, probe.scene.moved(d, h)).at(quantity).value -
          probe.of(effect, probe.scene.moved(d, -h)).at(quantity).value) /
         (2 * h);
}

}  // namespace

TEST_CASE("pools leave alone what was not asked") {
  for_every_pool([](const PoolProbe& probe) {
    const test::Slots value = probe.evaluate(Want::value, probe.scene().x()),
                      gradient = probe.evaluate(Want::gradient, probe.scene().x());
    CHECK(untouched(value.gradient));
    CHECK(untouched(value.jacobian));
    CHECK(untouched(value.hessian));
    CHECK(untouched(gradient.hessian));
  });
}

TEST_CASE("projected and absolute Hessians have no negative eigenvalue, energies and functions alike") {
  int indefinite = 0;
  for_every_pool([&](const PoolProbe& probe) {
    auto crushed = probe.scene().x();
    for (Vec3& p : crushed) p = Vec3{0.9 * p.x, 1.3 * p.y, 0.8 * p.z};
    for (const double sign : {1.0, -1.0}) {
      std::vector<double> multiplier = probe.multiplier();
      for (double& m : multiplier) m *= sign;
      for (const auto definiteness : {Definiteness::exact, Definiteness::projected, Definiteness::absolute}) {
        const test::Slots s = probe.evaluate(Want::hessian, crushed, multiplier, definiteness);
        double lowest = 0, highest = 0;
        for (Index i = 0; i < probe.pool().stencils(); ++i) {
          if (probe.pool().nodes()[i].empty()) continue;
          const Eigen::VectorXd values = test::eigenvalues(probe.dense_hessian(s, i));
          lowest = std::min(lowest, values.minCoeff());
          highest = std::max(highest, values.maxCoeff());
        }
        if (definiteness == Definiteness::exact)
          indefinite += lowest < -1e-6 * highest;
        else
          CHECK(lowest >= -1e-11 * highest);
      }
    }
  });
  CHECK(indefinite > 100);
}

TEST_CASE("where a pool has no value its energy is infinite, and never NaN") {
  int outside = 0, inside = 0;
  for_every_pool([&](const PoolProbe& probe) {
    const auto& x = probe.scene().x();
    std::vector<std::vector<Vec3>> states(3, x);
    for (Vec3& p : states[0]) p = x[0];           // all in one place
    for (Vec3& p : states[1]) p.x = -p.x;         // inside out
    for (Vec3& p : states[2]) p = {p.x, p.y, 0};  // flat
    for (const auto& there : states) {
      const test::Slots s = probe.evaluate(Want::gradient, there);
      const auto K = static_cast<std::size_t>(probe.pool().functions());
      for (Index i = 0; i < probe.pool().stencils(); ++i) {
        const double energy = s.energy[at(i)];
        REQUIRE_FALSE(std::isnan(energy));
        if (!std::isfinite(energy)) {
          REQUIRE(energy == std::numeric_limits<double>::infinity());
          ++outside;
          continue;
        }
        ++inside;
        for (std::size_t k = 0; k < K; ++k) REQUIRE(std::isfinite(s.value[at(i) * K + k]));
        const std::size_t n = probe.pool().nodes()[i].size(), first = at(probe.pool().nodes().offset[at(i)]);
        for (std::size_t a = 0; a < n; ++a)
          REQUIRE(std::isfinite(dot(s.gradient[first + a], s.gradient[first + a])));
      }
    }
  });
  CHECK(outside > 1000);
  CHECK(inside > 1000);
}

TEST_CASE("metrics and compliances are in the unit of the row squared per joule") {
  // Bodies a thousand times as stiff: what is made of their modulus is a thousand times smaller, what the
  // author gave stays, and what is in the unit of the row does not change.
  int given = 0, made = 0;
  for (const test::SceneCase& c : test::scene_cases()) {
    const SceneProbe soft(of_modulus(c, 2.6)), stiff(of_modulus(c, 2600));
    const auto& rows = soft.system().parts().row_pools;
    REQUIRE(stiff.system().parts().row_pools.size() == rows.size());
    for (std::size_t p = 0; p < rows.size(); ++p) {
      const RowPool &a = *rows[p], &b = *stiff.system().parts().row_pools[p];
      INFO(c.name << ", rows " << a.name());
      REQUIRE(a.rows() == b.rows());
      if (a.law == RowLaw::prescribed) continue;
      REQUIRE(a.metric.size() == at(a.rows()));
      REQUIRE(a.measure.size() == at(a.rows()));
      std::vector<double> target_a(at(a.rows())), target_b = target_a;
      a.update(0.7, target_a);
      b.update(0.7, target_b);
      for (std::size_t r = 0; r < at(a.rows()); ++r) {
        CHECK(a.metric[r] > 0);
        CHECK(a.measure[r] > 0);
        CHECK(b.metric[r] == Approx((c.own_scale ? 1 : 1e-3) * a.metric[r]));
        CHECK(b.measure[r] == Approx(a.measure[r]));
        CHECK(target_b[r] == Approx(target_a[r]));
      }
      REQUIRE(a.compliance.size() == b.compliance.size());
      if (entry_sum(a) == 0) continue;
      const double ratio = entry_sum(b) / entry_sum(a);
      const bool from_author = std::abs(ratio - 1) < 1e-9;
      ++(from_author ? given : made);
      if (!from_author) CHECK(ratio == Approx(1e-3));
    }
  }
  CHECK(given > 10);
  CHECK(made > 10);
}

TEST_CASE("compliances give way and never push: positive semidefinite, in the lower triangle") {
  for (const test::SceneCase& c : test::scene_cases()) {
    const SceneProbe scene(c);
    for (const auto& rows : scene.system().parts().row_pools) {
      INFO(c.name << ", rows " << rows->name());
      if (rows->compliance.empty() || rows->facets().law) continue;
      Eigen::MatrixXd C = Eigen::MatrixXd::Zero(rows->rows(), rows->rows());
      for (const ComplianceEntry& e : rows->compliance) {
        REQUIRE(e.row >= e.col);
        REQUIRE((e.col >= 0 && e.row < rows->rows()));
        C(e.row, e.col) += e.value;
        if (e.row != e.col) C(e.col, e.row) += e.value;
      }
      const Eigen::VectorXd values = test::eigenvalues(C);
      CHECK(values.minCoeff() >= -1e-12 * std::abs(values.maxCoeff()));
    }
  }
}

TEST_CASE("gauges of force and pressure do the work that their rows do") {
  int pressures = 0, tensions = 0, forces = 0;
  for_every_gauged([&](const GaugeProbe& probe, const EffectInstance& effect, const auto& quantities,
                       const test::SceneCase& c) {
    const auto& name = quantities.begin()->second.effect;
    std::vector<Index> pools = probe.pools_of(name);
    if (quantities.count("content")) pools.push_back(probe.pools_of("chambers").at(0));
    if (pools.empty()) return;
    const auto work = [&](std::span<const Vec3> d) {
      double sum = 0;
      for (const Index p : pools) sum += probe.row_work(p, d);
      return sum;
    };
    const auto d = probe.scene.direction(11);
    // The weight of a liquid is a row beside that of its pressure.
    if (quantities.count("volume") && pools.size() == 1) {
      const Gauge &pressure = quantities.at("pressure"), &volume = quantities.at("volume");
      CHECK(pressure.unit == "Pa");
      CHECK(volume.unit == "m^3");
      CHECK(work(d) == Approx(pressure.value * slope(probe, effect, "volume", d)).epsilon(1e-6));
      ++pressures;
    }
    if (quantities.count("tension") && quantities.count("length")) {
      CHECK(quantities.at("tension").unit == "N");
      CHECK(quantities.at("length").unit == "m");
      CHECK(work(d) ==
            Approx(-quantities.at("tension").value * slope(probe, effect, "length", d)).epsilon(1e-6));
      ++tensions;
    }
    if (quantities.count("force_x")) {
      // On the first body, or on a free one where the rows do not touch that.
      const auto count = c.mesh.nodes.size();
      std::vector<Vec3> all(probe.state.x.size(), Vec3{1, 1, 1}), body = all;
      std::fill(body.begin() + static_cast<std::ptrdiff_t>(count), body.end(), Vec3{});
      bool touches = false;
      for (const Index p : pools) {
        const Index stencils = probe.system.parts().row_pools[at(p)]->stencil_pool;
        for (const Index n : probe.system.parts().stencil_pools[at(stencils)]->nodes().item)
          touches = touches || at(n) < count;
      }
      for (int k = 0; k < 3; ++k) {
        const Gauge& force = quantities.at(std::string("force_") + "xyz"[k]);
        CHECK(force.unit == "N");
        std::vector<Vec3> along = touches ? body : all;
        for (Vec3& v : along) {
          const double step = v[k];
          v = Vec3{};
          v[k] = step;
        }
        CHECK(work(along) == Approx(force.value).epsilon(1e-9).margin(1e-9));
        forces += std::abs(force.value) > 1e-6;
      }
    }
  });
  CHECK(pressures >= 8);
  CHECK(tensions >= 8);
  CHECK(forces >= 20);
}

TEST_CASE("targets are what the author asked for, in the unit of the row") {
  int volumes = 0, lengths = 0;
  for_every_gauged([&](const GaugeProbe& probe, const EffectInstance& effect, const auto& quantities,
                       const test::SceneCase&) {
    const std::string size = quantities.count("volume")   ? "volume"
                             : quantities.count("length") ? "length"
                                                          : "";
    const auto pools = probe.pools_of(quantities.begin()->second.effect);
    Amount* amount = const_cast<EffectInstance&>(effect).amount();
    if (size.empty() || pools.size() != 1 || !amount) return;
    const RowPool& rows = *probe.system.parts().row_pools[at(pools[0])];
    if (rows.law != RowLaw::compliant || rows.rows() != 1 || rows.facets().law) return;
    // Where the row is zero with respect to its target, the gauge is the amount times what it is at rest.
    const double left = probe.row_target(pools[0]) - probe.row_value(pools[0]);
    const double there = quantities.at(size).value + left;
    const double rest = probe.of(effect, probe.scene.rest()).at(size).value;
    CHECK(there == Approx(amount->value(1) * rest).epsilon(1e-9));
    ++(size == "volume" ? volumes : lengths);
  });
  CHECK(volumes >= 4);
  CHECK(lengths >= 4);
}

TEST_CASE("forces, pressures and tensions of gauges go with the multipliers, sizes do not") {
  int linear = 0;
  for (const test::SceneCase& c : test::scene_cases()) {
    const SceneProbe scene(c);
    GaugeProbe once(scene), twice(scene);
    for (double& l : twice.state.lambda) l *= 2;
    for (const auto& effect : scene.instances()) {
      const auto one = once.of(*effect), two = twice.of(*effect);
      const auto has = [](const std::string& unit, const char* what) { return unit == what; };
      for (const auto& [quantity, gauge] : one) {
        INFO(c.name << ", " << gauge.effect << ", " << quantity << " [" << gauge.unit << "]");
        // The stress of a sheet is of its stretch and of its moments.
        if (gauge.quantity == "largest_stress") continue;
        const double other = two.at(quantity).value;
        if (has(gauge.unit, "N") || has(gauge.unit, "Pa") || has(gauge.unit, "N/m")) {
          // Or it is given.
          const bool same = other == gauge.value;
          if (!same) CHECK(other == Approx(2 * gauge.value));
          linear += !same;
        } else if (has(gauge.unit, "m") || has(gauge.unit, "m^3") || has(gauge.unit, "rad") ||
                   has(gauge.unit, "m^2")) {
          CHECK(other == gauge.value);
        }
      }
    }
  }
  CHECK(linear > 20);
}

TEST_CASE("pools that change with time by themselves say so, and the others do not change") {
  int moved = 0;
  for_every_pool([&](const PoolProbe& probe) {
    const MovingStencils* moving = probe.pool().facets().moving;
    const test::Slots first = probe.evaluate_at(0);
    for (const double t : {0.3, 1.0}) {
      const test::Slots now = probe.evaluate_at(t);
      const bool same =
          test::same_bits(first.energy, now.energy) && test::same_bits(first.value, now.value) &&
          test::same_bits(first.gradient, now.gradient) && test::same_bits(first.jacobian, now.jacobian);
      if (same || grows(probe.pool())) continue;
      REQUIRE(moving);
      CHECK(moving->moves(0, t));
      CHECK_FALSE(moving->moves(t, t));
      ++moved;
    }
  });
  CHECK(moved > 0);
}

TEST_CASE("potentials of both ends of an increment are the same when these change places") {
  int dissipative = 0;
  for_every_pool([&](const PoolProbe& probe) {
    const auto& x = probe.scene().x();
    const std::vector<Vec3> y = probe.scene().moved(probe.scene().direction(3), 0.02);
    const test::Slots there = probe.evaluate_between(x, y), back = probe.evaluate_between(y, x);
    double sum = 0;
    for (std::size_t s = 0; s < there.energy.size(); ++s) {
      if (probe.pool().facets().dissipative) CHECK(there.energy[s] == Approx(back.energy[s]).epsilon(1e-12));
      sum += there.energy[s];
    }
    if (!probe.pool().facets().dissipative) return;
    CHECK(sum > 0);
    // Nothing where nothing moves.
    const test::Slots still = probe.evaluate_between(x, x);
    for (const double e : still.energy) CHECK(e == 0);
    ++dissipative;
  });
  CHECK(dissipative > 1);
}
