// The contract of every law: its strain is the slope of its potential, its tangent that of its strain,
// positive semidefinite; and it allocates nothing.
#include <Eigen/Core>
#include <cmath>
#include <limits>

#include "catch.h"
#include "contract/scene_probe.h"
#include "support/allocations.h"
#include "support/dense.h"

using namespace isochor;

namespace {

struct LawProbe {
  const RowPool& pool;
  const LawRows& law;
  const RememberingRows* remembering;
  std::vector<double> memory, lambda;

  explicit LawProbe(const RowPool& rows)
      : pool(rows), law(*rows.facets().law), remembering(rows.facets().remembering) {
    if (remembering) {
      memory.resize(static_cast<std::size_t>(remembering->memory()));
      remembering->start(memory);
    }
    for (Index r = 0; r < pool.rows(); ++r) lambda.push_back(2e4 * std::sin(1.0 + 2.7 * r));
    // Take it away from its start.
    std::vector<double> before = memory;
    if (remembering) remembering->accept({0, 0.3, before}, lambda, memory);
    for (double& l : lambda) l = -0.7 * l + 3e3;
  }
  double at_multipliers(std::span<const double> l, std::vector<double>& strain,
                        std::span<double> tangent = {}) const {
    strain.assign(l.size(), std::nan(""));
    return law.evaluate_law({0.3, 0.5, memory}, l, strain, tangent);
  }
};

template <class Check>
void for_every_law(const Check& check) {
  int found = 0;
  for (const test::SceneCase& c : test::scene_cases()) {
    const test::SceneProbe scene(c);
    for (const auto& pool : scene.system().parts().row_pools) {
      if (!pool->facets().law) continue;
      INFO(c.name << ", rows " << pool->name());
      check(LawProbe(*pool));
      ++found;
    }
  }
  CHECK(found > 0);
}

}  // namespace

TEST_CASE("a law's strain is the slope of its potential, its tangent the slope of its strain") {
  for_every_law([](const LawProbe& probe) {
    std::vector<double> strain, up, down, tangent(probe.pool.compliance.size(), std::nan(""));
    probe.at_multipliers(probe.lambda, strain, tangent);
    for (std::size_t i = 0; i < probe.lambda.size(); ++i) {
      auto plus = probe.lambda, minus = probe.lambda;
      // Beside multipliers of 1e4. A sum over many rows leaves fewer digits to the slope of its potential.
      const double h = 0.3, near = 5e-4;
      plus[i] += h;
      minus[i] -= h;
      const double above = probe.at_multipliers(plus, up), below = probe.at_multipliers(minus, down);
      const double rounding = 8 * std::numeric_limits<double>::epsilon() * std::abs(above) / (2 * h);
      CHECK((above - below) / (2 * h) == Approx(strain[i]).epsilon(1e-5).margin(rounding));
      plus[i] = probe.lambda[i] + near;
      minus[i] = probe.lambda[i] - near;
      probe.at_multipliers(plus, up);
      probe.at_multipliers(minus, down);
      for (std::size_t e = 0; e < tangent.size(); ++e) {
        const ComplianceEntry& place = probe.pool.compliance[e];
        if (at(place.col) != i && at(place.row) != i) continue;
        const std::size_t other = at(place.col) == i ? at(place.row) : at(place.col);
        CHECK((up[other] - down[other]) / (2 * near) == Approx(tangent[e]).epsilon(2e-6).margin(1e-12));
      }
    }
  });
}

TEST_CASE("a law's tangent is positive semidefinite, also far from equilibrium") {
  for_every_law([](const LawProbe& probe) {
    for (const double factor : {0.0, 1.0, 4.0, -6.0, 20.0}) {
      auto lambda = probe.lambda;
      for (double& l : lambda) l *= factor;
      std::vector<double> strain, tangent(probe.pool.compliance.size());
      CHECK(std::isfinite(probe.at_multipliers(lambda, strain, tangent)));
      Eigen::MatrixXd C = Eigen::MatrixXd::Zero(probe.pool.rows(), probe.pool.rows());
      for (std::size_t e = 0; e < tangent.size(); ++e) {
        const ComplianceEntry& place = probe.pool.compliance[e];
        C(place.row, place.col) = C(place.col, place.row) = tangent[e];
        CHECK(std::isfinite(tangent[e]));
      }
      const Eigen::VectorXd eigenvalues = test::eigenvalues(C);
      CHECK(eigenvalues.minCoeff() >= -1e-13 * eigenvalues.cwiseAbs().maxCoeff());
    }
  });
}

TEST_CASE("evaluating a law allocates nothing") {
  if (!test::allocations_are_counted()) return;
  for_every_law([](const LawProbe& probe) {
    std::vector<double> strain(probe.lambda.size()), tangent(probe.pool.compliance.size());
    const RowIncrement increment{0.3, 0.5, probe.memory};
    auto memory = probe.memory;
    const test::AllocationCount allocations;
    const double potential = probe.law.evaluate_law(increment, probe.lambda, strain, tangent);
    if (probe.remembering) probe.remembering->accept(increment, probe.lambda, memory);
    const long count = allocations.count();
    CHECK(std::isfinite(potential));
    CHECK(count == 0);
  });
}
