#include "engine/solvers/two_level/two_level_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

#include "engine/solvers/gmres_rounds.h"
#include "engine/solvers/pattern_check.h"

namespace isochor {
namespace {

constexpr int most_directions = 30, most_rounds = 3;
constexpr int most_wrong = 12;  // inertias in one saddle point
// A multiplication of a direction waits for memory as long as so many of a factorization take; and directions
// that a factorization is worth, corrections included.
constexpr double direction_cost = 8, directions = 25;
// Of the look at the inertia.
constexpr double look_tolerance = 1e-3;

double max_norm(std::span<const double> v) {
  double largest = 0, poison = 0;
  for (const double x : v) {
    largest = std::max(largest, std::abs(x));
    poison += x * 0.0;
  }
  return largest + poison;
}

}  // namespace

TwoLevelSolver::TwoLevelSolver(std::unique_ptr<LinearSolver> direct, const TwoLevelChoice& choice)
    : direct_(std::move(direct)), choice_(choice) {}

std::string TwoLevelSolver::reason() const {
  if (!two_levels_) return direct_->reason();
  std::string text = "factors would take several times the work; " + std::to_string(factored_[0]) +
                     " matrices by two levels, " + std::to_string(factored_[1]) + " by factors";
  if (factored_[1] > 0) text += " (" + std::string(direct_->name()) + "; " + why_ + ")";
  return text;
}

void TwoLevelSolver::set_parallel(const Parallel& parallel) {
  parallel_ = &parallel;
  direct_->set_parallel(parallel);
  if (levels_) levels_->set_parallel(parallel);
}

void TwoLevelSolver::set_geometry(std::vector<UnknownGeometry> geometry) {
  geometry_ = std::move(geometry);
  if (direct_->wants_geometry()) direct_->set_geometry(geometry_);
}

void TwoLevelSolver::set_interrupt(std::function<bool()> asked) {
  direct_->set_interrupt(asked);
  if (levels_) levels_->set_interrupt(asked);
  LinearSolver::set_interrupt(std::move(asked));
}

void TwoLevelSolver::set_scale(std::span<const double> scale) {
  scale_ = scale;
  direct_->set_scale(scale);
}

void TwoLevelSolver::begin_solve() {
  direct_->begin_solve();
  if (levels_) levels_->begin_solve();
  by_factors_ = !two_levels_;
  wrong_ = 0;
}

bool TwoLevelSolver::pays(const SymmetricPattern& pattern) {
  // Cheaper to say than to count.
  constexpr Index smallest = 20000;
  if (pattern.size < smallest && choice_.from > 0) return false;
  const double direct = shared_front_tree(pattern, OrderingMethod::best)->operations;
  if (direct < choice_.from) return false;
  levels_ = std::make_unique<TwoLevel>(nullptr);
  if (parallel_) levels_->set_parallel(*parallel_);
  levels_->set_interrupt(interrupt());
  if (!levels_->analyze(pattern, geometry_)) return false;
  return direct >=
         choice_.pays * (levels_->factor_work() + direction_cost * directions * levels_->direction_work());
}

FactorReport TwoLevelSolver::analyze(const SymmetricPattern& pattern) {
  pattern_ = nullptr;
  two_levels_ = analyzed_ = false;
  by_factors_ = true;
  FactorReport report;
  report.message = check(pattern);
  if (!report.message.empty()) {
    report.status = FactorStatus::failed;
    return report;
  }
  pattern_ = &pattern;
  try {
    two_levels_ = pays(pattern);
    if (two_levels_) {
      gmres_.emplace(levels_->size(), most_directions);
      if (parallel_) gmres_->set_loop(RowLoop(parallel_));
      for (auto* v : {&vectors_.b, &vectors_.x, &vectors_.residual, &vectors_.work})
        v->assign(levels_->size(), 0);
      begin_solve();
      return report;
    }
  } catch (const std::bad_alloc&) {
    two_levels_ = false;
  }
  levels_.reset();
  analyzed_ = true;
  return direct_->analyze(pattern);
}

FactorReport TwoLevelSolver::factor_directly(std::string why) {
  if (!by_factors_) why_ = std::move(why);
  by_factors_ = true;
  if (!analyzed_) {
    FactorReport report = direct_->analyze(*pattern_);
    if (report.status != FactorStatus::ok) return report;
    analyzed_ = true;
  }
  if (two_levels_) ++factored_[1];
  return direct_->factor(values_);
}

FactorReport TwoLevelSolver::factor(std::span<const double> values) {
  values_ = values;
  solutions_ = 0;
  if (pattern_ == nullptr || by_factors_)
    return pattern_ == nullptr ? direct_->factor(values) : factor_directly({});
  FactorReport report;
  vectors_.work.resize(std::max(levels_->size(), at(pattern_->size)));
  norm_ = matrix_norm(*pattern_, values, std::span(vectors_.work).first(at(pattern_->size)));
  vectors_.work.resize(levels_->size());
  if (!std::isfinite(norm_)) {
    report.status = FactorStatus::not_finite;
    report.message = "the matrix has a value that is not finite, or too large to sum";
    return report;
  }
  try {
    report = levels_->factor(values, scale_);
  } catch (const std::bad_alloc&) {
    report.status = FactorStatus::out_of_memory;
    return report;
  }
  if (report.status == FactorStatus::interrupted) return report;
  const bool right = report.negative_pivots == levels_->rows();
  if (report.status != FactorStatus::ok) return factor_directly("the coarse matrix is singular");
  if (!right && ++wrong_ > most_wrong) return factor_directly("the matrix seems to have a wrong inertia");
  ++factored_[0];
  if (right) report.negative_pivots = -1;
  reported_ = report.negative_pivots;
  return report;
}

bool TwoLevelSolver::iterate(double wanted, std::span<const double> b, std::span<double> x, int& iterations) {
  GmresRounds rounds;
  rounds.wanted = wanted;
  rounds.most = most_rounds;
  std::fill(x.begin(), x.end(), 0.0);
  return solve_in_rounds(
      *gmres_, rounds, {b, x, vectors_.residual, vectors_.work},
      [&](std::span<const double> v, std::span<double> w) { levels_->multiply(v, w); },
      [&](std::span<double> v) { return !interrupted() && levels_->precondition(v); }, iterations);
}

// With a right-hand side that has parts along all directions.
bool TwoLevelSolver::same_inertia(int& iterations) {
  std::uint32_t state = 12345;
  std::fill(vectors_.b.begin(), vectors_.b.end(), 0.0);
  for (const Index place : levels_->place()) {
    state = state * 1664525u + 1013904223u;
    vectors_.b[at(place)] =
        0.5 + static_cast<double>(state >> 8) / double{1 << 24} * ((state >> 31) != 0u ? 1 : -1);
  }
  return iterate(look_tolerance, vectors_.b, vectors_.x, iterations) && !gmres_->odd();
}

SolveReport TwoLevelSolver::solve_directly(std::string why, double tolerance, std::span<const double> b,
                                           std::span<double> x, int iterations) {
  SolveReport report;
  report.residual = std::numeric_limits<double>::infinity();
  std::fill(x.begin(), x.end(), 0.0);
  if (interrupted()) return report;
  const FactorReport factored = factor_directly(std::move(why));
  if (factored.status == FactorStatus::ok) {
    report = direct_->solve_to(tolerance, b, x);
    const Index believed = reported_ >= 0 ? reported_ : levels_->rows();
    if (factored.negative_pivots >= 0 && factored.negative_pivots != believed) {
      report.inertia_changed = true;
      report.ok = false;
    }
  }
  report.iterations += iterations;
  return report;
}

SolveReport TwoLevelSolver::solve_to(double tolerance, std::span<const double> right_hand_side,
                                     std::span<double> solution) {
  if (pattern_ == nullptr || by_factors_) return direct_->solve_to(tolerance, right_hand_side, solution);
  SolveReport report;
  report.residual = std::numeric_limits<double>::infinity();
  std::fill(solution.begin(), solution.end(), 0.0);
  const double b_norm = max_norm(right_hand_side);
  if (!std::isfinite(b_norm)) return report;
  if (b_norm == 0) return {true, 0, 0, 0};
  const double wanted = std::max(tolerance, choice_.tolerance);
  int iterations = 0;
  if (choice_.confirm && solutions_++ == 1 && !same_inertia(iterations))
    return solve_directly("the matrix may have another inertia", tolerance, right_hand_side, solution,
                          iterations);
  const auto place = levels_->place();
  std::fill(vectors_.b.begin(), vectors_.b.end(), 0.0);
  for (std::size_t u = 0; u < place.size(); ++u) vectors_.b[at(place[u])] = right_hand_side[u];
  const bool arrived = iterate(wanted, vectors_.b, vectors_.x, iterations);
  if (!arrived)
    return solve_directly("iterations did not arrive", tolerance, right_hand_side, solution, iterations);
  report.iterations = iterations;
  // As where a direction does not descend: whoever asks mends the matrix.
  if (gmres_->odd() && ++wrong_ <= most_wrong) return report;
  if (gmres_->odd())
    return solve_directly("the matrix seems to have a wrong inertia", tolerance, right_hand_side, solution,
                          iterations);
  report.residual = max_norm(vectors_.residual) / (norm_ * max_norm(vectors_.x) + b_norm);
  for (std::size_t u = 0; u < place.size(); ++u) solution[u] = vectors_.x[at(place[u])];
  report.ok = std::isfinite(report.residual);
  return report;
}

bool TwoLevelSolver::precondition(std::span<double> x) {
  if (pattern_ == nullptr || by_factors_) return direct_->precondition(x);
  const auto place = levels_->place();
  std::fill(vectors_.work.begin(), vectors_.work.end(), 0.0);
  for (std::size_t u = 0; u < place.size(); ++u) vectors_.work[at(place[u])] = x[u];
  if (!levels_->precondition(vectors_.work)) return false;
  for (std::size_t u = 0; u < place.size(); ++u) x[u] = vectors_.work[at(place[u])];
  return true;
}

std::unique_ptr<LinearSolver> make_two_level_solver(std::unique_ptr<LinearSolver> direct,
                                                    const TwoLevelChoice& choice) {
  return std::make_unique<TwoLevelSolver>(std::move(direct), choice);
}

}  // namespace isochor
