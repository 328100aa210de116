#include "rules/instruments.h"

#include <cmath>

#include "support/worlds.h"

namespace test {

using namespace isochor;

FactorReport DenseSolver::analyze(const SymmetricPattern& pattern) {
  ++calls_->analyze;
  pattern_ = &pattern;
  n_ = pattern.size;
  L_.assign(at(n_) * at(n_), 0.0);
  d_.assign(at(n_), 0.0);
  return {};
}

FactorReport DenseSolver::factor(std::span<const double> values) {
  ++calls_->factor;
  std::fill(L_.begin(), L_.end(), 0.0);
  for (Index c = 0; c < n_; ++c) {
    for (auto k = pattern_->column_start[at(c)]; k < pattern_->column_start[at(c) + 1]; ++k) {
      entry(pattern_->row[static_cast<std::size_t>(k)], c) = values[static_cast<std::size_t>(k)];
    }
  }
  FactorReport report;
  report.negative_pivots = 0;
  for (Index j = 0; j < n_; ++j) {
    double* row_j = &entry(j, 0);
    double pivot = row_j[j];
    for (Index k = 0; k < j; ++k) pivot -= row_j[k] * row_j[k] * d_[at(k)];
    if (!(std::abs(pivot) > 0) || !std::isfinite(pivot)) {
      report.status = FactorStatus::singular;
      return report;
    }
    d_[at(j)] = pivot;
    if (pivot < 0) ++report.negative_pivots;
    for (Index i = j + 1; i < n_; ++i) {
      double* row_i = &entry(i, 0);
      double sum = row_i[j];
      for (Index k = 0; k < j; ++k) sum -= row_i[k] * row_j[k] * d_[at(k)];
      row_i[j] = sum / pivot;
    }
  }
  return report;
}

SolveReport DenseSolver::solve(std::span<const double> right_hand_side, std::span<double> y) {
  ++calls_->solve;
  std::copy(right_hand_side.begin(), right_hand_side.end(), y.begin());
  substitute(y);
  SolveReport report;
  report.ok = true;
  return report;
}

void DenseSolver::substitute(std::span<double> y) {
  for (Index i = 0; i < n_; ++i) {
    for (Index k = 0; k < i; ++k) y[at(i)] -= entry(i, k) * y[at(k)];
  }
  for (Index i = 0; i < n_; ++i) y[at(i)] /= d_[at(i)];
  for (Index i = n_ - 1; i >= 0; --i) {
    for (Index k = i + 1; k < n_; ++k) y[at(i)] -= entry(k, i) * y[at(k)];
  }
}

void CountingPool::evaluate(const StencilRequest& request, const StencilSlots& slots) const {
  if (request.begin == 0) {
    if (request.want == Want::value) ++counts_->value;
    if (request.want == Want::gradient) ++counts_->gradient;
    if (request.want == Want::hessian) ++counts_->hessian;
  }
  pool_->evaluate(request, slots);
}

namespace {

class EmptyPool final : public StencilPool {
 public:
  EmptyPool() { finish_topology(); }
  std::string_view name() const override { return "empty"; }
  StencilShape shape() const override { return {.energy = true, .functions = 1}; }
  void evaluate(const StencilRequest&, const StencilSlots&) const override { FAIL("nothing to evaluate"); }
};

class EmptyRows final : public RowPool {
 public:
  std::string_view name() const override { return "empty"; }
};

class EmptyEffect final : public EffectSource {
 public:
  const std::string& name() const override { return name_; }
  void describe(Fingerprint& f) const override { f.add(name_); }
  Result<std::unique_ptr<EffectInstance>> build(Builder& builder) const override {
    auto rows = std::make_shared<EmptyRows>();
    rows->stencil_pool = builder.add_stencils(std::make_shared<EmptyPool>());
    builder.add_rows(rows);
    return std::unique_ptr<EffectInstance>(std::make_unique<EffectInstance>());
  }

 private:
  std::string name_ = "empty";
};

}  // namespace

EffectPtr empty_effect() {
  return std::make_shared<EmptyEffect>();
}

SmallProblem::SmallProblem(Element element, double traction, std::unique_ptr<LinearSolver> solver,
                           std::shared_ptr<Evaluations> counts, bool with_empty_effect) {
  BodyDef body;
  body.mesh = box({3, 1, 1}, {3, 1, 1});
  body.element = element;
  body.materials = {{"", neo_hookean(1e5, 0.4999), 1000}};
  DirichletDef clamp;
  clamp.where.surfaces = {"x0"};
  TractionDef pull;
  pull.surface = "x1";
  pull.traction = {0, traction, 0};
  pull.amount = Curve::ramp(1);
  std::vector<EffectPtr> effects = {isochor::volume({}), dirichlet(clamp), isochor::traction(pull)};
  if (with_empty_effect) effects.insert(effects.begin(), empty_effect());
  scene = compile({body}, effects, true);
  if (!scene.system) FAIL(scene.error);
  if (counts) {
    SystemParts parts = scene.system->parts();
    for (auto& pool : parts.stencil_pools) pool = std::make_shared<CountingPool>(pool, counts);
    scene.system = value(System::compile(std::move(parts)));
  }
  parallel = std::make_unique<TbbParallel>(1);
  if (!solver) solver = make_linear_solver(Solver::automatic);
  newton = std::make_unique<Newton>(scene.system, *parallel, std::move(solver));
  data = std::make_unique<ProblemData>(*scene.system);
  x = scene.system->parts().rest;
  lambda.assign(at(scene.system->rows()), 0.0);
}

SaddleReport SmallProblem::solve(double t) {
  data->at_time(*scene.system, t);
  return newton->solve(data->problem(), {}, x, lambda);
}

}  // namespace test
