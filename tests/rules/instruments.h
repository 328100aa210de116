// Instruments that stand in for parts of the engine and count what it does.
#pragma once

#include <atomic>
#include <memory>
#include <vector>

#include "engine/solvers/linear_solver.h"
#include "engine/system/pool.h"
#include "support/compiled.h"

namespace test {

// Dense LDL^T for small systems, without pivoting and without a single allocation after analyze(). It counts
// its calls.
class DenseSolver final : public isochor::LinearSolver {
 public:
  struct Calls {
    int analyze = 0, factor = 0, solve = 0;
  };
  explicit DenseSolver(std::shared_ptr<Calls> calls = std::make_shared<Calls>()) : calls_(std::move(calls)) {}
  std::string_view name() const override { return "dense"; }
  isochor::FactorReport analyze(const isochor::SymmetricPattern& pattern) override;
  isochor::FactorReport factor(std::span<const double> values) override;
  isochor::SolveReport solve(std::span<const double> right_hand_side, std::span<double> solution) override;
  bool precondition(std::span<double> x) override {
    substitute(x);
    return true;
  }

 private:
  void substitute(std::span<double> y);
  double& entry(isochor::Index row, isochor::Index col) {
    return L_[isochor::at(row) * isochor::at(n_) + isochor::at(col)];
  }
  std::shared_ptr<Calls> calls_;
  const isochor::SymmetricPattern* pattern_ = nullptr;
  isochor::Index n_ = 0;
  std::vector<double> L_, d_;
};

// How often a pool was evaluated from its first stencil on, by what was asked.
struct Evaluations {
  std::atomic<int> value{0}, gradient{0}, hessian{0};
};

// Forwards to another pool and counts.
class CountingPool final : public isochor::StencilPool {
 public:
  CountingPool(std::shared_ptr<const isochor::StencilPool> pool, std::shared_ptr<Evaluations> counts)
      : pool_(std::move(pool)), counts_(std::move(counts)) {
    nodes_ = pool_->nodes();
    finish_topology();
  }
  std::string_view name() const override { return pool_->name(); }
  isochor::StencilShape shape() const override { return pool_->shape(); }
  void evaluate(const isochor::StencilRequest& request, const isochor::StencilSlots& slots) const override;

 private:
  std::shared_ptr<const isochor::StencilPool> pool_;
  std::shared_ptr<Evaluations> counts_;
};

// A pool and a row pool without a single stencil or row, as an effect.
isochor::EffectPtr empty_effect();

// A clamped beam of two cells' width with a load, ready for Newton; `pools` may be replaced before compiling.
struct SmallProblem {
  Compiled scene;
  std::unique_ptr<isochor::TbbParallel> parallel;
  std::unique_ptr<isochor::Newton> newton;
  std::unique_ptr<ProblemData> data;
  std::vector<isochor::Vec3> x;
  std::vector<double> lambda;

  // `traction` is the end load [Pa] at t = 1.
  SmallProblem(isochor::Element element, double traction, std::unique_ptr<isochor::LinearSolver> solver,
               std::shared_ptr<Evaluations> counts = nullptr, bool with_empty_effect = false);
  isochor::SaddleReport solve(double t);
};

}  // namespace test
