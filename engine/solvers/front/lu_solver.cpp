#include "engine/solvers/front/lu_solver.h"

#include <Eigen/SparseCore>
#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>

#include "engine/base/base.h"
#include "engine/solvers/direct_solver.h"

namespace isochor {
namespace {

using Matrix = Eigen::SparseMatrix<double, Eigen::ColMajor, Index>;

// A row is taken in place of the diagonal where that is smaller than this fraction of it.
constexpr double pivot_threshold = 0.01;
// A solution of a right-hand side of size 1 that grows beyond this over the norm: a singular matrix.
constexpr double singular_growth = 1e14;

// Both triangles in our own ordering of the symmetric pattern; Eigen permutes rows only, for its pivots.
class EigenLuSolver final : public DirectSolver {
 public:
  explicit EigenLuSolver(OrderingMethod method) : DirectSolver(true), method_(method) {}
  std::string_view name() const override { return "eigen_lu"; }

 protected:
  FactorReport analyze_pattern() override {
    const SymmetricPattern& p = pattern();
    ordering_ = order_unknowns(p, method_);
    struct Entry {
      Index column, row;
      std::size_t source;
    };
    std::vector<Entry> entries;
    const auto lower = static_cast<std::size_t>(p.nonzeros());
    entries.reserve(2 * lower);
    for (Index c = 0; c < p.size; ++c) {
      for (auto k = p.column_start[at(c)]; k < p.column_start[at(c) + 1]; ++k) {
        const auto place = static_cast<std::size_t>(k);
        const Index i = ordering_.position[at(p.row[place])], j = ordering_.position[at(c)];
        entries.push_back({j, i, place});
        if (i != j) entries.push_back({i, j, place + lower});
      }
    }
    std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
      return a.column != b.column ? a.column < b.column : a.row < b.row;
    });
    matrix_.resize(p.size, p.size);
    matrix_.resizeNonZeros(static_cast<Eigen::Index>(entries.size()));
    source_.clear();
    std::fill_n(matrix_.outerIndexPtr(), p.size + 1, 0);
    for (std::size_t k = 0; k < entries.size(); ++k) {
      source_.push_back(entries[k].source);
      matrix_.innerIndexPtr()[k] = entries[k].row;
      ++matrix_.outerIndexPtr()[entries[k].column + 1];
    }
    for (Index c = 0; c < p.size; ++c) matrix_.outerIndexPtr()[c + 1] += matrix_.outerIndexPtr()[c];
    std::fill_n(matrix_.valuePtr(), matrix_.nonZeros(), 1.0);
    solver_.isSymmetric(true);
    solver_.setPivotThreshold(pivot_threshold);
    solver_.analyzePattern(matrix_);
    work_.resize(p.size);
    probe_.assign(at(p.size), 0);
    test_right_.resize(at(p.size));
    for (std::size_t i = 0; i < test_right_.size(); ++i) test_right_[i] = i % 3 == 0 ? 1 : -0.5;
    return {};
  }

  FactorReport factor_values() override {
    const auto v = values();
    for (std::size_t k = 0; k < source_.size(); ++k) matrix_.valuePtr()[k] = v[source_[k]];
    FactorReport report;
    solver_.factorize(matrix_);
    bool good = solver_.info() == Eigen::Success;
    if (good) {
      const SolveReport probed = refine(test_right_, probe_);
      double largest = 0;
      for (const double x : probe_) largest = std::max(largest, std::abs(x));
      good = probed.ok && largest * norm() < singular_growth;
    }
    if (!good) {
      report.status = FactorStatus::singular;
      report.message = "the matrix is numerically singular";
      return report;
    }
    report.factor_nonzeros = solver_.nnzL() + solver_.nnzU();
    return report;
  }

  bool apply_inverse(std::span<double> x) override {
    for (std::size_t k = 0; k < x.size(); ++k)
      work_[static_cast<Eigen::Index>(k)] = x[at(ordering_.unknown[k])];
    const Eigen::VectorXd solved = solver_.solve(work_);
    for (std::size_t k = 0; k < x.size(); ++k)
      x[at(ordering_.unknown[k])] = solved[static_cast<Eigen::Index>(k)];
    return true;
  }

 private:
  OrderingMethod method_;
  Ordering ordering_;
  Matrix matrix_;
  std::vector<std::size_t> source_;  // of every entry, in the values
  Eigen::SparseLU<Matrix, Eigen::NaturalOrdering<Index>> solver_;
  Eigen::VectorXd work_;
  std::vector<double> probe_, test_right_;
};

}  // namespace

std::unique_ptr<LinearSolver> make_eigen_lu_solver(OrderingMethod method) {
  return std::make_unique<EigenLuSolver>(method);
}

}  // namespace isochor
