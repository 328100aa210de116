#include "engine/solve/kkt/dual_rows.h"

#include <algorithm>
#include <cmath>

namespace isochor {

namespace {

// 1 / (W D) of augmented rows without compliance: smaller takes fewer iterations and costs digits of A.
constexpr double softness = 1e-2;
// Relative residual at which the iterations end, in the norm of the preconditioner, and how many there may
// be.
constexpr double tolerance = 1e-8;
constexpr int most_iterations = 500;
// Of an iterative linear solver in all of them together.
constexpr std::int64_t most_linear_iterations = 10000;
// What is left then counts as an inexact step as long as most of it is gone.
constexpr double inexact = 0.01;
// Curvature along a direction, in units of the preconditioner, that rounding alone may leave.
constexpr double no_curvature = 1e-13;

}  // namespace

DualRows::DualRows(const System& system, FactoredMatrix& matrix, BorderedRows& border,
                   const RowJacobian& jacobian)
    : system_(system), matrix_(matrix), border_(border), jacobian_(jacobian) {
  if (system.treated().dual.empty()) return;
  for (auto* v : {&weight_, &preconditioner_, &active_, &x_, &r_, &z_, &p_, &q_, &work_})
    v->assign(at(system.rows()), 0);
  compliance_.resize(system.treated().dual_compliance.size());
  rhs_.resize(at(system.kkt().size));
}

std::span<const double> DualRows::weights(const MatrixValues& values) {
  const TreatedRows& rows = system_.treated();
  const auto metric = system_.row_metric();
  auto &own = z_, &sum = work_;  // of C: the diagonal, and magnitudes by rows
  for (const Index r : rows.dual) {
    active_[at(r)] = values.held(r) ? 0 : 1;
    sum[at(r)] = own[at(r)] = 0;
  }
  for (std::size_t k = 0; k < compliance_.size(); ++k) {
    const ComplianceEntry& e = system_.compliance()[rows.dual_compliance[k]];
    const double c =
        values.compliance(system_, rows.dual_compliance[k]) * active_[at(e.row)] * active_[at(e.col)];
    compliance_[k] = c;
    sum[at(e.row)] += std::abs(c);
    if (e.row == e.col)
      own[at(e.row)] += c;
    else
      sum[at(e.col)] += std::abs(c);
  }
  for (const Index row : rows.augmented.row) {
    const std::size_t r = at(row);
    // W C <= 1 by rows. A row that is held keeps its places in the matrix, with zeros.
    weight_[r] = active_[r] > 0 ? 1 / (sum[r] + softness * metric[r]) : 0;
  }
  for (const Index row : rows.dual) {
    const std::size_t r = at(row);
    const double t = 1 - weight_[r] * own[r];
    preconditioner_[r] = t * own[r] + t * t / (1 / metric[r] + weight_[r]);
  }
  return weight_;
}

void DualRows::assemble(const MatrixValues& values, std::span<double> matrix) {
  if (system_.treated().dual.empty()) return;
  weights(values);
  const FilledRows& rows = system_.treated().augmented;
  std::size_t place = 0;
  for (const Index row : rows.row)
    place = jacobian_.add_square(row, weight_[at(row)], rows.place, place, matrix);
}

void DualRows::reduce(std::span<const double> row_rhs, std::span<double> rhs) const {
  for (const Index r : system_.treated().dual) {
    if (active_[at(r)] > 0 && weight_[at(r)] > 0)
      jacobian_.add_force(r, weight_[at(r)] * row_rhs[at(r)], rhs);
  }
}

void DualRows::recover(std::span<const double> row_rhs, std::span<double> dlambda) const {
  // Of a row held at a bound -D dl = g is left, D its metric, as of a kept one.
  for (const Index r : system_.treated().dual)
    dlambda[at(r)] = active_[at(r)] == 0 ? -row_rhs[at(r)] / system_.row_metric()[at(r)] : x_[at(r)];
}

// y += alpha C v.
void DualRows::add_compliance(double alpha, std::span<const double> v, std::span<double> y) const {
  for (std::size_t k = 0; k < compliance_.size(); ++k) {
    const ComplianceEntry& e = system_.compliance()[system_.treated().dual_compliance[k]];
    const double c = alpha * compliance_[k];
    y[at(e.row)] += c * v[at(e.col)];
    if (e.row != e.col) y[at(e.col)] += c * v[at(e.row)];
  }
}

// out = T v.
void DualRows::weigh(std::span<const double> v, std::span<double> out) const {
  const auto& rows = system_.treated().dual;
  for (const Index r : rows) out[at(r)] = 0;
  add_compliance(-1, v, out);
  for (const Index r : rows) out[at(r)] = active_[at(r)] * (v[at(r)] + weight_[at(r)] * out[at(r)]);
}

void DualRows::weigh_transposed(std::span<double> v) {
  for (const Index r : system_.treated().dual) work_[at(r)] = weight_[at(r)] * v[at(r)];
  add_compliance(-1, work_, v);
}

bool DualRows::apply(std::span<const double> p, std::span<double> q, StageSeconds& seconds) {
  const auto& rows = system_.treated().dual;
  const auto rhs = matrix_.rhs();
  weigh(p, work_);
  std::fill(rhs.begin(), rhs.end(), 0.0);
  border_.reduce({});
  for (const Index r : rows) jacobian_.add_force(r, work_[at(r)], rhs);
  if (!border_.solve(seconds)) return false;
  for (const Index r : rows) q[at(r)] = active_[at(r)] * jacobian_.dot(r, matrix_.solution());
  add_compliance(1, p, q);
  weigh_transposed(q);
  return true;
}

double DualRows::dot(std::span<const double> a, std::span<const double> b) const {
  double sum = 0;
  for (const Index r : system_.treated().dual) sum += a[at(r)] * b[at(r)];
  return sum;
}

void DualRows::precondition() {
  for (const Index r : system_.treated().dual)
    z_[at(r)] = active_[at(r)] * r_[at(r)] / preconditioner_[at(r)];
}

// The residual without multipliers.
bool DualRows::start(std::span<const double> row_rhs, StageSeconds& seconds) {
  const auto rhs = matrix_.rhs();
  std::copy(rhs.begin(), rhs.end(), rhs_.begin());
  if (!border_.solve(seconds)) return false;
  for (const Index r : system_.treated().dual) {
    r_[at(r)] = active_[at(r)] * (jacobian_.dot(r, matrix_.solution()) - row_rhs[at(r)]);
    x_[at(r)] = 0;
  }
  weigh_transposed(r_);
  return true;
}

bool DualRows::solve(std::span<const double> row_rhs, StageSeconds& seconds) {
  const auto& rows = system_.treated().dual;
  if (!start(row_rhs, seconds)) return false;
  precondition();
  p_ = z_;
  double rho = dot(r_, z_);
  const double first = rho;
  bool ok = std::isfinite(rho);
  int iteration = 0;
  const std::int64_t most_linear = matrix_.counts().iterations + most_linear_iterations;
  for (; ok && rho > tolerance * tolerance * first && iteration < most_iterations &&
         matrix_.counts().iterations < most_linear;
       ++iteration) {
    ok = !matrix_.interrupted() && apply(p_, q_, seconds);
    const double curvature = dot(p_, q_);
    double size = 0;
    for (const Index r : rows) size += p_[at(r)] * preconditioner_[at(r)] * p_[at(r)];
    // Negative: A is not positive definite, and its factors could not tell. None: multipliers of rows that
    // depend on each other, which do nothing, and would go anywhere.
    if (!ok || !(curvature > no_curvature * size)) break;
    const double alpha = rho / curvature;
    for (const Index r : rows) {
      x_[at(r)] += alpha * p_[at(r)];
      r_[at(r)] -= alpha * q_[at(r)];
    }
    precondition();
    const double next = dot(r_, z_);
    for (const Index r : rows) p_[at(r)] = z_[at(r)] + next / rho * p_[at(r)];
    rho = next;
  }
  iterations_ += iteration;
  ok = ok && rho <= inexact * first;
  // The steps of the nodes, with the multipliers found.
  weigh(x_, work_);
  std::copy(rhs_.begin(), rhs_.end(), matrix_.rhs().begin());
  border_.reduce(row_rhs);
  for (const Index r : rows) jacobian_.add_force(r, -work_[at(r)], matrix_.rhs());
  return border_.solve(seconds) && ok;
}

}  // namespace isochor
