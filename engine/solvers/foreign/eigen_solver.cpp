#include "engine/solvers/foreign/eigen_solver.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include "engine/base/base.h"
#include "engine/solvers/front/ldlt_solver.h"

namespace isochor {
namespace {

using Matrix = Eigen::SparseMatrix<double, Eigen::ColMajor, Index>;

class EigenSolver final : public LdltSolver {
 public:
  using LdltSolver::LdltSolver;
  std::string_view name() const override { return "eigen"; }

 protected:
  FactorReport analyze_upper() override {
    const auto n = static_cast<Eigen::Index>(matrix().start.size()) - 1;
    copy_.resize(n, n);
    copy_.resizeNonZeros(static_cast<Eigen::Index>(matrix().row.size()));
    std::copy(matrix().start.begin(), matrix().start.end(), copy_.outerIndexPtr());
    std::copy(matrix().row.begin(), matrix().row.end(), copy_.innerIndexPtr());
    std::fill_n(copy_.valuePtr(), copy_.nonZeros(), 1.0);
    solver_.analyzePattern(copy_);
    factor_nonzeros = solver_.lower_nonzeros() + n;
    return {};
  }

  bool factor_upper() override {
    std::copy(matrix().value.begin(), matrix().value.end(), copy_.valuePtr());
    solver_.factorize(copy_);
    return solver_.info() == Eigen::Success;
  }

  double pivot(Index k) const override { return solver_.pivots()[k]; }

  bool solve_permuted(std::span<double> x) override {
    solver_.solve_in_place(Eigen::Map<Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size())));
    return true;
  }

 private:
  // The matrix comes in the pivot sequence already, so the factor is used as it stands, without copies.
  struct Factor : Eigen::SimplicialLDLT<Matrix, Eigen::Upper, Eigen::NaturalOrdering<Index>> {
    Eigen::Index lower_nonzeros() const { return m_matrix.nonZeros(); }
    const VectorType& pivots() const { return m_diag; }
    void solve_in_place(Eigen::Map<Eigen::VectorXd> x) const {
      m_matrix.triangularView<Eigen::UnitLower>().solveInPlace(x);
      x = x.cwiseQuotient(m_diag);
      m_matrix.adjoint().triangularView<Eigen::UnitUpper>().solveInPlace(x);
    }
  };

  Matrix copy_;
  Factor solver_;
};

}  // namespace

std::unique_ptr<LinearSolver> make_eigen_solver(OrderingMethod method) {
  return std::make_unique<EigenSolver>(method);
}

std::string eigen_version() {
  return std::to_string(EIGEN_WORLD_VERSION) + "." + std::to_string(EIGEN_MAJOR_VERSION) + "." +
         std::to_string(EIGEN_MINOR_VERSION);
}

}  // namespace isochor
