#include "engine/solvers/iterative/iterative_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <utility>

#include "engine/solvers/gmres_rounds.h"
#include "engine/solvers/pattern_check.h"

namespace isochor {
namespace {

// Relative residual that still makes a step: rounding may keep the last digits of an ill-conditioned system
// out of reach.
constexpr double kGoodEnough = 1e-6;
// Directions of the minimal residuals on the triangle before they begin anew, and how often they may.
constexpr int most_directions = 30, most_beginnings = 3;
constexpr Index wide_row_nodes = 400;       // a row over more is measured
constexpr std::size_t most_wide_rows = 64;  // more of them are left at 1 + C

double max_norm(std::span<const double> v) {
  double largest = 0, poison = 0;
  for (const double x : v) {
    largest = std::max(largest, std::abs(x));
    poison += x * 0.0;
  }
  return largest + poison;
}

}  // namespace

IterativeSolver::IterativeSolver(const IterativeOptions& options)
    : options_(options), multigrid_(options.multigrid) {}

FactorReport IterativeSolver::analyze(const SymmetricPattern& pattern) {
  FactorReport report;
  factored_ = false;
  pattern_ = nullptr;
  try {
    report.message = check(pattern);
    if (!report.message.empty()) {
      report.status = FactorStatus::failed;
      return report;
    }
    matrix_.analyze(pattern, geometry_);
    multigrid_.analyze(matrix_.take_stiffness_pattern());
    const std::size_t n = matrix_.size(), rows = at(matrix_.rows());
    for (auto* v : {&b_, &x_, &residual_, &lanczos_.v0, &lanczos_.v1, &lanczos_.v2, &lanczos_.z1,
                    &lanczos_.z2, &lanczos_.w0, &lanczos_.w1, &lanczos_.w2})
      v->assign(n, 0);
    dot_.allocate(n);
    gmres_.emplace(n, most_directions, Gmres::Directions::made_again);
    gmres_->set_loop(loop_);
    modes_.assign(3 * at(matrix_.nodes()) * 6, 0);
    row_inverse_.assign(rows, 1);
    row_sum_.assign(at(pattern.size), 0);
    wide_rows_.clear();
    for (Index r = 0; r < matrix_.rows() && wide_rows_.size() < most_wide_rows; ++r) {
      if (matrix_.row_nodes(r) > wide_row_nodes) wide_rows_.push_back(r);
    }
    pattern_ = &pattern;
  } catch (const std::bad_alloc&) {
    report.status = FactorStatus::out_of_memory;
  } catch (...) {
    report.status = FactorStatus::failed;
  }
  return report;
}

// Rigid motions of the nodes in scaled unknowns; without geometry, translations along the unknowns.
void IterativeSolver::fill_modes() {
  std::fill(modes_.begin(), modes_.end(), 0.0);
  const auto place = matrix_.place();
  const Index displacements = 3 * matrix_.nodes();
  if (geometry_.empty()) {
    for (const Index p : place) {
      if (p < displacements) modes_[6 * at(p) + at(p % 3)] = 1;
    }
    return;
  }
  Vec3 center{}, low = geometry_.front().position, high = low;
  for (const UnknownGeometry& g : geometry_) {
    center += g.position;
    for (int i = 0; i < 3; ++i) {
      low[i] = std::min(low[i], g.position[i]);
      high[i] = std::max(high[i], g.position[i]);
    }
  }
  center = (1.0 / static_cast<double>(geometry_.size())) * center;
  const Vec3 extent = high - low;
  const double length = std::max(std::sqrt(isochor::dot(extent, extent)), 1e-300);
  for (std::size_t u = 0; u < geometry_.size(); ++u) {
    const Vec3& d = geometry_[u].direction;
    const Vec3 p = (1 / length) * (geometry_[u].position - center);
    const double weight = scale_.empty() ? 1 : 1 / scale_[u];
    double* const row = modes_.data() + 6 * at(place[u]);
    const Vec3 turn{p.y * d.z - p.z * d.y, p.z * d.x - p.x * d.z, p.x * d.y - p.y * d.x};
    for (int i = 0; i < 3; ++i) {
      row[i] = weight * d[i];
      row[3 + i] = weight * turn[i];
    }
  }
}

FactorReport IterativeSolver::factor(std::span<const double> values) {
  FactorReport report;
  factored_ = false;
  try {
    if (pattern_ == nullptr || values.size() != static_cast<std::size_t>(pattern_->nonzeros())) {
      report.status = FactorStatus::failed;
      report.message = pattern_ == nullptr ? "factor was called without a successful analyze"
                                           : "the number of values is not that of the analyzed pattern";
      return report;
    }
    norm_ = matrix_norm(*pattern_, values, row_sum_);
    if (!std::isfinite(norm_)) {
      report.status = FactorStatus::not_finite;
      report.message = "the matrix has a value that is not finite, or too large to sum";
      return report;
    }
    if (norm_ == 0 && pattern_->size > 0) {
      report.status = FactorStatus::singular;
      report.message = "the matrix is zero";
      return report;
    }
    matrix_.set_values(values, multigrid_.matrix());
    fill_modes();
    caution_ = 1;
    if (!build()) {
      report.status = FactorStatus::failed;
      report.message = "no definite preconditioner was found for the stiffness";
      return report;
    }
  } catch (const std::bad_alloc&) {
    report.status = FactorStatus::out_of_memory;
    return report;
  }
  report.factor_nonzeros = multigrid_.nonzeros();
  factored_ = true;
  return report;
}

bool IterativeSolver::build() {
  if (matrix_.nodes() > 0) multigrid_.factor(loop_, modes_, caution_);
  for (Index r = 0; r < matrix_.rows(); ++r) {
    row_inverse_[at(r)] = 1 / (1 + std::abs(matrix_.compliance_diagonal(r)));
  }
  measure_wide_rows();
  return std::all_of(row_inverse_.begin(), row_inverse_.end(),
                     [](double v) { return std::isfinite(v) && v > 0; });
}

// Row entries of the Schur complement where they may be anything: g^T B g with the multigrid cycle B.
void IterativeSolver::measure_wide_rows() {
  const std::size_t n = 3 * at(matrix_.nodes());
  for (const Index r : wide_rows_) {
    const auto g = std::span(lanczos_.v0).first(n), z = std::span(lanczos_.v1).first(n);
    matrix_.row_gradient(r, g);
    multigrid_.apply(loop_, g, z);
    const double schur = dot(g, z) + std::abs(matrix_.compliance_diagonal(r));
    if (schur > 0 && std::isfinite(schur)) row_inverse_[at(r)] = 1 / schur;
  }
}

void IterativeSolver::apply(std::span<const double> b, std::span<double> x) {
  const std::size_t n = 3 * at(matrix_.nodes());
  if (n > 0) multigrid_.apply(loop_, b.first(n), x.first(n));
  for (std::size_t r = 0; r < row_inverse_.size(); ++r) x[n + r] = row_inverse_[r] * b[n + r];
}

void IterativeSolver::apply_preconditioner(std::span<const double> x, std::span<double> y) {
  const auto place = matrix_.place();
  std::fill(b_.begin(), b_.end(), 0.0);
  for (std::size_t u = 0; u < place.size(); ++u) b_[at(place[u])] = x[u];
  apply(b_, x_);
  for (std::size_t u = 0; u < place.size(); ++u) y[u] = x_[at(place[u])];
}

// residual_ = b - A x; its norm in the preconditioner.
double IterativeSolver::norm_of_residual(std::span<const double> b, std::span<const double> x) {
  matrix_.multiply(loop_, multigrid_.matrix(), x, residual_);
  for (std::size_t i = 0; i < b.size(); ++i) residual_[i] = b[i] - residual_[i];
  apply(residual_, lanczos_.z1);
  const double square = dot(residual_, lanczos_.z1);
  return square >= 0 ? std::sqrt(square) : -1;
}

// v := [B G^T; 0 -S]^-1 v in place, S the diagonal of the rows.
bool IterativeSolver::solve_triangular(std::span<double> v) {
  if (interrupted()) return false;
  const std::size_t n = 3 * at(matrix_.nodes());
  for (std::size_t r = 0; r < row_inverse_.size(); ++r) v[n + r] *= -row_inverse_[r];
  if (n == 0) return true;
  const auto forces = std::span(lanczos_.v0).first(n);
  std::copy_n(v.begin(), n, forces.begin());
  matrix_.add_row_forces(loop_, -1, v.subspan(n), forces);
  multigrid_.apply(loop_, forces, v.first(n));
  return true;
}

// From x = 0, with the upper triangle of blocks for a preconditioner (Murphy, Golub & Wathen 2000), which
// takes a fraction of the iterations of the diagonal ones but has no short recurrence.
bool IterativeSolver::iterate_on_triangle(double wanted, std::span<double> x, int& iterations) {
  const GmresRounds rounds{
      .wanted = wanted, .most = most_beginnings, .most_directions = options_.max_iterations};
  return solve_in_rounds(
      *gmres_, rounds, {b_, x, residual_, lanczos_.w0},
      [&](std::span<const double> v, std::span<double> w) {
        matrix_.multiply(loop_, multigrid_.matrix(), v, w);
      },
      [&](std::span<double> v) { return solve_triangular(v); }, iterations);
}

// Paige & Saunders 1975 with a preconditioner, from residual_ and lanczos_.z1 = B residual_. False when the
// preconditioner turns out not to be definite.
bool IterativeSolver::minimize(double wanted, double first, std::span<double> x, int& iterations) {
  const double target = 0.9 * wanted * first;
  const std::size_t n = x.size();
  const auto size = static_cast<Index>(n);
  constexpr Index grain = 8192;
  for (auto* v : {&lanczos_.v0, &lanczos_.w0, &lanczos_.w1}) std::fill(v->begin(), v->end(), 0.0);
  std::copy(residual_.begin(), residual_.end(), lanczos_.v1.begin());
  const double square = dot(lanczos_.v1, lanczos_.z1);
  if (!(square >= 0)) return false;
  double gamma0 = 1, gamma1 = std::sqrt(square), eta = gamma1;
  double s0 = 0, s1 = 0, c0 = 1, c1 = 1;
  // Looked at every so often: what has nearly stopped, good enough as a direction, or what could not get that
  // far at many times its pace, ends early.
  constexpr int window = 100, first_look = 200;
  constexpr double pace = 4;
  const double good_enough = std::max(target, 0.9 * kGoodEnough * first);
  double before = eta;
  const int start = iterations;
  for (; iterations < options_.max_iterations && gamma1 > 0 && std::abs(eta) > target; ++iterations) {
    const int done = iterations - start;
    if (done > 0 && done % window == 0) {
      const double now = std::abs(eta), gain = std::log(before / now);
      const double left = std::log(now / good_enough);
      const double chances = pace * (options_.max_iterations - iterations) / window;
      if (done >= first_look && (left <= 0 ? gain < std::log(2.0) : left > gain * chances)) break;
      before = now;
    }
    loop_(size, grain, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) lanczos_.z1[at(i)] /= gamma1;
    });
    if (interrupted()) return true;
    matrix_.multiply(loop_, multigrid_.matrix(), lanczos_.z1, lanczos_.v2);
    const double delta = dot(lanczos_.v2, lanczos_.z1);
    loop_(size, grain, [&](Index begin, Index end) {
      for (Index k = begin; k < end; ++k) {
        const std::size_t i = at(k);
        lanczos_.v2[i] -= delta / gamma1 * lanczos_.v1[i] + gamma1 / gamma0 * lanczos_.v0[i];
      }
    });
    apply(lanczos_.v2, lanczos_.z2);
    const double next = dot(lanczos_.v2, lanczos_.z2);
    if (!std::isfinite(next) || next < -1e-12 * norm_) return false;
    const double gamma2 = std::sqrt(std::max(next, 0.0));
    const double a0 = c1 * delta - c0 * s1 * gamma1, a1 = std::sqrt(a0 * a0 + gamma2 * gamma2);
    const double a2 = s1 * delta + c0 * c1 * gamma1, a3 = s0 * gamma1;
    if (!(a1 > 0)) break;  // the right-hand side has a part that the matrix does not reach
    const double c2 = a0 / a1, s2 = gamma2 / a1, step = c2 * eta;
    loop_(size, grain, [&](Index begin, Index end) {
      for (Index k = begin; k < end; ++k) {
        const std::size_t i = at(k);
        lanczos_.w2[i] = (lanczos_.z1[i] - a3 * lanczos_.w0[i] - a2 * lanczos_.w1[i]) / a1;
        x[i] += step * lanczos_.w2[i];
      }
    });
    eta *= -s2;
    std::swap(lanczos_.v0, lanczos_.v1);
    std::swap(lanczos_.v1, lanczos_.v2);
    std::swap(lanczos_.w0, lanczos_.w1);
    std::swap(lanczos_.w1, lanczos_.w2);
    std::swap(lanczos_.z1, lanczos_.z2);
    gamma0 = gamma1;
    gamma1 = gamma2;
    s0 = s1;
    s1 = s2;
    c0 = c1;
    c1 = c2;
  }
  return true;
}

SolveReport IterativeSolver::solve_to(double tolerance, std::span<const double> right_hand_side,
                                      std::span<double> solution) {
  const double wanted = std::max(tolerance, options_.tolerance);
  SolveReport report;
  report.residual = std::numeric_limits<double>::infinity();
  std::fill(solution.begin(), solution.end(), 0.0);
  const std::size_t n = pattern_ == nullptr ? 0 : at(pattern_->size);
  if (!factored_ || right_hand_side.size() != n || solution.size() != n) return report;
  const double b_norm = max_norm(right_hand_side);
  if (!std::isfinite(b_norm)) return report;
  if (b_norm == 0) return {true, 0, 0, 0};
  const auto place = matrix_.place();
  std::fill(b_.begin(), b_.end(), 0.0);
  for (std::size_t u = 0; u < n; ++u) b_[at(place[u])] = right_hand_side[u];
  std::fill(x_.begin(), x_.end(), 0.0);
  if (iterate_on_triangle(wanted, x_, report.iterations)) {
    report.ok = true;
    finish(b_norm, solution, report);
    return report;
  }
  std::fill(lanczos_.v0.begin(), lanczos_.v0.end(), 0.0);
  double first = norm_of_residual(b_, lanczos_.v0), now = norm_of_residual(b_, x_);
  // The recurrence of the residual drifts from the residual itself: a restart or two make up for that.
  constexpr int most_restarts = 4;
  for (int restart = 0; restart < most_restarts && !interrupted(); ++restart) {
    const double target = wanted * first;
    if (now >= 0 && minimize(wanted, first, x_, report.iterations)) {
      const double after = norm_of_residual(b_, x_);
      const bool stalled = !(after < 0.5 * now);
      now = after;
      if (now <= target || stalled || report.iterations >= options_.max_iterations) break;
      continue;
    }
    // An estimate of an eigenvalue was too small: again with more caution.
    caution_ *= 1.5;
    if (!build()) break;
    std::fill(x_.begin(), x_.end(), 0.0);
    first = now = norm_of_residual(b_, x_);
  }
  if (std::isfinite(max_norm(x_)) && now >= 0) {
    report.ok = now <= std::max(wanted, kGoodEnough) * first;
    finish(b_norm, solution, report);
  }
  return report;
}

// Hands x_ over, and says how good it is.
void IterativeSolver::finish(double b_norm, std::span<double> solution, SolveReport& report) {
  const auto place = matrix_.place();
  matrix_.multiply(loop_, multigrid_.matrix(), x_, residual_);
  for (std::size_t i = 0; i < b_.size(); ++i) residual_[i] = b_[i] - residual_[i];
  report.residual = max_norm(residual_) / (norm_ * max_norm(x_) + b_norm);
  for (std::size_t u = 0; u < solution.size(); ++u) solution[u] = x_[at(place[u])];
}

std::size_t IterativeSolver::bytes() const {
  return matrix_.bytes() + multigrid_.bytes() + (11 + most_directions + 2) * b_.size() * sizeof(double) +
         modes_.size() * sizeof(double);
}

std::unique_ptr<LinearSolver> make_iterative_solver(const IterativeOptions& options) {
  return std::make_unique<IterativeSolver>(options);
}

}  // namespace isochor
