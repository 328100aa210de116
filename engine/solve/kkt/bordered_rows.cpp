#include "engine/solve/kkt/bordered_rows.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "engine/system/row_treatment.h"

namespace isochor {

// Small enough to be held in place: a factorization allocates nothing.
using Dense = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, most_bordered_rows,
                            most_bordered_rows>;

// S in units of the row metric, its eigenvectors, and S^-1 in units of the rows.
struct BorderedRows::SchurComplement {
  explicit SchurComplement(Eigen::Index n)
      : matrix(n, n), symmetric(n, n), scaled(n, n), inverse(n, n), eigen(n) {}
  Dense matrix, symmetric, scaled, inverse;
  Eigen::SelfAdjointEigenSolver<Dense> eigen;
};

BorderedRows::BorderedRows(const System& system, FactoredMatrix& matrix, const RowJacobian& jacobian)
    : system_(system), matrix_(matrix), jacobian_(jacobian) {
  const std::size_t rows = system.treated().bordered.size();
  if (rows == 0) return;
  solution_.resize(at(system.kkt().size) * rows);
  for (auto* v : {&rhs_, &work_, &value_}) v->resize(rows);
  schur_ = std::make_unique<SchurComplement>(static_cast<Eigen::Index>(rows));
}

BorderedRows::~BorderedRows() = default;

void BorderedRows::assemble(const MatrixValues& values, FactorOutcome& outcome) {
  if (!schur_ || outcome.status != FactorStatus::ok) return;
  if (!solve_columns(outcome)) return;
  for (const auto& [entry, row, col] : system_.treated().border_compliance) {
    const double c = values.compliance(system_, entry);
    schur_->matrix(row, col) -= c;
    if (row != col) schur_->matrix(col, row) -= c;
  }
  invert(outcome);
}

// A^-1 B, and -B^T A^-1 B.
bool BorderedRows::solve_columns(FactorOutcome& outcome) {
  const auto& rows = system_.treated().bordered;
  const std::size_t size = at(system_.kkt().size);
  schur_->matrix.setZero();
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (matrix_.interrupted()) {
      outcome.status = FactorStatus::interrupted;
      return false;
    }
    const auto z = std::span(solution_).subspan(k * size, size);
    jacobian_.column(rows[k], matrix_.rhs());
    if (!matrix_.solve_beside(matrix_.rhs(), z)) {
      outcome.status = FactorStatus::singular;
      outcome.message = "the system without its bordered rows is singular";
      return false;
    }
    for (std::size_t j = 0; j < rows.size(); ++j)
      schur_->matrix(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(k)) -= jacobian_.dot(rows[j], z);
  }
  return true;
}

void BorderedRows::invert(FactorOutcome& outcome) {
  const auto& rows = system_.treated().bordered;
  auto& [schur, symmetric, scaled, inverse, eigen] = *schur_;
  // Rows in units of their metric, so that small eigenvalues mean dependence and not units.
  for (std::size_t j = 0; j < rows.size(); ++j) work_[j] = 1 / std::sqrt(system_.row_metric()[at(rows[j])]);
  const auto to_metric = [&](Dense& m) {
    for (Eigen::Index j = 0; j < m.rows(); ++j) {
      for (Eigen::Index k = 0; k < m.rows(); ++k)
        m(j, k) *= work_[static_cast<std::size_t>(j)] * work_[static_cast<std::size_t>(k)];
    }
  };
  to_metric(schur);
  symmetric = 0.5 * (schur + schur.transpose());
  eigen.compute(symmetric);
  const double largest = eigen.eigenvalues().cwiseAbs().maxCoeff();
  if (!std::isfinite(largest) || eigen.eigenvalues().cwiseAbs().minCoeff() <= 1e-14 * largest) {
    outcome.status = FactorStatus::singular;
    outcome.message = "the bordered rows depend on each other";
    return;
  }
  if (outcome.negative >= 0)
    outcome.negative += static_cast<Index>((eigen.eigenvalues().array() < 0).count());
  scaled.noalias() = eigen.eigenvectors() * eigen.eigenvalues().cwiseInverse().asDiagonal();
  inverse.noalias() = scaled * eigen.eigenvectors().transpose();
  to_metric(inverse);
}

void BorderedRows::reduce(std::span<const double> row_rhs) {
  const auto& rows = system_.treated().bordered;
  for (std::size_t j = 0; j < rows.size(); ++j) rhs_[j] = row_rhs.empty() ? 0 : row_rhs[at(rows[j])];
}

bool BorderedRows::solve(StageSeconds& seconds, double tolerance) {
  const bool ok = matrix_.solve(seconds, tolerance);
  if (!schur_) return ok;
  const Stopwatch watch(seconds.solve);
  const auto& rows = system_.treated().bordered;
  const auto u = matrix_.solution();
  const std::size_t n = rows.size(), size = u.size();
  for (std::size_t j = 0; j < n; ++j) work_[j] = rhs_[j] - jacobian_.dot(rows[j], u);
  const double* const inverse = schur_->inverse.data();
  for (std::size_t j = 0; j < n; ++j) {
    double sum = 0;
    for (std::size_t k = 0; k < n; ++k) sum += inverse[k * n + j] * work_[k];
    value_[j] = sum;
  }
  for (std::size_t j = 0; j < n; ++j) {
    const double* const z = solution_.data() + j * size;
    for (std::size_t i = 0; i < size; ++i) u[i] -= z[i] * value_[j];
  }
  return ok;
}

void BorderedRows::recover(std::span<double> dlambda) const {
  const auto& rows = system_.treated().bordered;
  for (std::size_t j = 0; j < rows.size(); ++j) dlambda[at(rows[j])] = value_[j];
}

}  // namespace isochor
