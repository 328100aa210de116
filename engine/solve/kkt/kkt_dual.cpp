// Rows outside the matrix whose multipliers are found by preconditioned conjugate gradients on their Schur
// complement.
//
// With A = K + G^T W G, W >= 0 a diagonal, and T = 1 - W C, the system
//   K dx + G^T dl = f,  G dx - C dl = g   reads   A dx + G^T T dl = f + G^T W g,  G dx - C dl = g.
// Its second line times T^T, with dx from the first, is symmetric,
//   T^T (C + G A^-1 G^T T) dl = T^T (G A^-1 (f + G^T W g) - g),
// and positive definite as long as A is and W C <= 1. W = 0 is the plain dual system. The solution does not
// depend on W; a large one makes A an augmented Lagrangian's Hessian, positive definite where K is not, and
// the iteration short. The preconditioner is the row metric D, in which a volume row's Schur complement is of
// order 1 on any mesh (the diagonal of the pressure's mass matrix over mu; Benzi, Golub & Liesen
// 2005, 10.1.1).
#include <algorithm>
#include <cmath>

#include "engine/solve/kkt/kkt.h"

namespace isochor {

namespace {

// 1 / (W D) of augmented rows without compliance: smaller takes fewer iterations and costs digits of A.
constexpr double softness = 1e-2;
// Of an iterative linear solver in all iterations for one direction.
constexpr std::int64_t most_linear_iterations = 10000;
// Curvature along a direction, in units of the preconditioner, that rounding alone may leave.
constexpr double no_curvature = 1e-13;

}  // namespace

void Kkt::prepare_dual(const Values& values) {
  const System& s = *system_;
  const auto metric = s.row_metric();
  for (const Index r : s.dual_rows()) {
    active_[at(r)] = values.clamped.empty() || !values.clamped[at(r)] ? 1 : 0;
    cg_work_[at(r)] = cg_z_[at(r)] = 0;
  }
  for (std::size_t k = 0; k < dual_value_.size(); ++k) {
    const ComplianceEntry& e = s.compliance()[s.dual_compliance()[k]];
    const double c = compliance_of(values, s.dual_compliance()[k]) * active_[at(e.row)] * active_[at(e.col)];
    dual_value_[k] = c;
    cg_work_[at(e.row)] += std::abs(c);
    if (e.row == e.col)
      cg_z_[at(e.row)] += c;
    else
      cg_work_[at(e.col)] += std::abs(c);
  }
  for (std::size_t k = s.condensed_rows().size(); k < s.filled_rows().size(); ++k) {
    const std::size_t r = at(s.filled_rows()[k]);
    // W C <= 1 by rows. A row that is held keeps its places in the matrix, with zeros.
    weight_[r] = active_[r] > 0 ? 1 / (cg_work_[r] + softness * metric[r]) : 0;
  }
  for (const Index row : s.dual_rows()) {
    const std::size_t r = at(row);
    const double t = 1 - weight_[r] * cg_z_[r];
    preconditioner_[r] = t * cg_z_[r] + t * t / (1 / metric[r] + weight_[r]);
  }
}

// y += alpha C v over the dual rows.
void Kkt::add_dual_compliance(double alpha, std::span<const double> v, std::span<double> y) const {
  const System& s = *system_;
  for (std::size_t k = 0; k < dual_value_.size(); ++k) {
    const ComplianceEntry& e = s.compliance()[s.dual_compliance()[k]];
    const double c = alpha * dual_value_[k];
    y[at(e.row)] += c * v[at(e.col)];
    if (e.row != e.col) y[at(e.col)] += c * v[at(e.row)];
  }
}

// out = T v.
void Kkt::weigh(std::span<const double> v, std::span<double> out) const {
  for (const Index r : system_->dual_rows()) out[at(r)] = 0;
  add_dual_compliance(-1, v, out);
  for (const Index r : system_->dual_rows())
    out[at(r)] = active_[at(r)] * (v[at(r)] + weight_[at(r)] * out[at(r)]);
}

// q = T^T (C + G A^-1 G^T T) p.
bool Kkt::apply_dual(std::span<const double> p, std::span<double> q, StageSeconds& seconds) {
  const auto rows = system_->dual_rows();
  weigh(p, cg_work_);
  std::fill(rhs_.begin(), rhs_.end(), 0.0);
  std::fill(border_rhs_.begin(), border_rhs_.end(), 0.0);
  for (const Index r : rows) add_row_force(r, cg_work_[at(r)], rhs_);
  if (!solve_matrix(seconds)) return false;
  for (const Index r : rows) q[at(r)] = active_[at(r)] * row_dot(r, solution_);
  add_dual_compliance(1, p, q);
  weigh_transposed(q);
  return true;
}

void Kkt::weigh_transposed(std::span<double> v) {
  for (const Index r : system_->dual_rows()) cg_work_[at(r)] = weight_[at(r)] * v[at(r)];
  add_dual_compliance(-1, cg_work_, v);
}

bool Kkt::solve_stiffness(std::span<const Vec3> node_rhs, std::span<Vec3> dx, StageSeconds& seconds) {
  residual_ = 0;
  to_unknowns(node_rhs);
  const bool ok = solve_matrix(seconds);
  to_nodes(solution_, dx);
  return ok;
}

bool Kkt::solve_dual(std::span<const double> row_rhs, StageSeconds& seconds) {
  const auto rows = system_->dual_rows();
  const auto dot_rows = [&](const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0;
    for (const Index r : rows) sum += a[at(r)] * b[at(r)];
    return sum;
  };
  const auto precondition = [&] {
    for (const Index r : rows) cg_z_[at(r)] = active_[at(r)] * cg_r_[at(r)] / preconditioner_[at(r)];
  };
  for (const Index r : rows) {
    if (active_[at(r)] > 0 && weight_[at(r)] > 0) add_row_force(r, weight_[at(r)] * row_rhs[at(r)], rhs_);
  }
  std::copy(rhs_.begin(), rhs_.end(), matrix_rhs_.begin());
  std::copy(border_rhs_.begin(), border_rhs_.end(), border_kept_.begin());
  if (!solve_matrix(seconds)) return false;
  for (const Index r : rows) {
    cg_r_[at(r)] = active_[at(r)] * (row_dot(r, solution_) - row_rhs[at(r)]);
    cg_x_[at(r)] = 0;
  }
  weigh_transposed(cg_r_);
  precondition();
  cg_p_ = cg_z_;
  double rho = dot_rows(cg_r_, cg_z_);
  const double start = rho;
  bool ok = std::isfinite(rho);
  int iteration = 0;
  const std::int64_t most_linear = linear_iterations_ + most_linear_iterations;
  for (; ok && rho > dual_tolerance * dual_tolerance * start && iteration < dual_iteration_limit &&
         linear_iterations_ < most_linear;
       ++iteration) {
    ok = !interrupted() && apply_dual(cg_p_, cg_q_, seconds);
    const double curvature = dot_rows(cg_p_, cg_q_);
    double size = 0;
    for (const Index r : rows) size += cg_p_[at(r)] * preconditioner_[at(r)] * cg_p_[at(r)];
    // Negative: A is not positive definite, and its factors could not tell. None: multipliers of rows that
    // depend on each other, which do nothing, and would go anywhere.
    if (!ok || !(curvature > no_curvature * size)) break;
    const double alpha = rho / curvature;
    for (const Index r : rows) {
      cg_x_[at(r)] += alpha * cg_p_[at(r)];
      cg_r_[at(r)] -= alpha * cg_q_[at(r)];
    }
    precondition();
    const double next = dot_rows(cg_r_, cg_z_);
    for (const Index r : rows) cg_p_[at(r)] = cg_z_[at(r)] + next / rho * cg_p_[at(r)];
    rho = next;
  }
  dual_iterations_ += iteration;
  // What is left counts as an inexact step as long as most of it is gone.
  ok = ok && rho <= 0.01 * start;
  weigh(cg_x_, cg_work_);
  std::copy(matrix_rhs_.begin(), matrix_rhs_.end(), rhs_.begin());
  std::copy(border_kept_.begin(), border_kept_.end(), border_rhs_.begin());
  for (const Index r : rows) add_row_force(r, -cg_work_[at(r)], rhs_);
  ok = solve_matrix(seconds) && ok;
  const auto metric = system_->row_metric();
  for (const Index r : rows) {
    if (active_[at(r)] == 0) cg_x_[at(r)] = -row_rhs[at(r)] / metric[at(r)];
  }
  return ok;
}

}  // namespace isochor
