#include "engine/solvers/foreign/gpl/cholmod_supernodal.h"

#if __has_include(<suitesparse/cholmod.h>)
#include <suitesparse/cholmod.h>
#else
#include <cholmod.h>
#endif

#include <algorithm>
#include <limits>
#include <new>

#include "engine/base/base.h"
#include "engine/solvers/direct_solver.h"
#include "engine/solvers/front/front_tree.h"

namespace isochor {
namespace {

class CholmodSupernodalSolver final : public DirectSolver {
 public:
  explicit CholmodSupernodalSolver(OrderingMethod method) : method_(method) {
    cholmod_start(&common_);
    common_.print = 0;
    common_.error_handler = nullptr;
    common_.supernodal = CHOLMOD_SUPERNODAL;
    common_.quick_return_if_not_posdef = 1;
    common_.nmethods = 1;
    common_.method[0].ordering = CHOLMOD_GIVEN;
  }
  ~CholmodSupernodalSolver() override {
    release();
    cholmod_finish(&common_);
  }
  CholmodSupernodalSolver(const CholmodSupernodalSolver&) = delete;
  CholmodSupernodalSolver& operator=(const CholmodSupernodalSolver&) = delete;

  std::string_view name() const override { return "cholmod_supernodal"; }

 protected:
  FactorReport analyze_pattern() override {
    release();
    const SymmetricPattern& p = pattern();
    FactorReport report;
    if (std::find(p.multiplier.begin(), p.multiplier.end(), std::uint8_t{1}) != p.multiplier.end()) {
      report.status = FactorStatus::failed;
      report.message =
          "cholmod_supernodal factors positive definite matrices, and this one has multiplier rows; condense "
          "them, take them out of the matrix (method dual_gradients) or use another solver";
      return report;
    }
    if (p.nonzeros() > std::numeric_limits<int>::max()) {
      report.status = FactorStatus::failed;
      report.message = "this backend holds fewer than 2^31 entries";
      return report;
    }
    start_.assign(p.column_start.begin(), p.column_start.end());
    values_.resize(p.row.size());
    view_ = {};
    view_.nrow = view_.ncol = at(p.size);
    view_.nzmax = p.row.size();
    view_.p = start_.data();
    view_.i = const_cast<Index*>(p.row.data());
    view_.x = values_.data();
    view_.stype = -1;
    view_.itype = CHOLMOD_INT;
    view_.xtype = CHOLMOD_REAL;
    view_.dtype = CHOLMOD_DOUBLE;
    view_.sorted = view_.packed = 1;
    Ordering ordering = best_ordering(p, method_);
    factor_ = cholmod_analyze_p(&view_, ordering.unknown.data(), nullptr, 0, &common_);
    if (factor_ == nullptr || common_.status < CHOLMOD_OK) {
      report.status = out_of_memory() ? FactorStatus::out_of_memory : FactorStatus::failed;
      report.message = "CHOLMOD's analysis failed with status " + std::to_string(common_.status);
      return report;
    }
    report.factor_nonzeros = static_cast<std::int64_t>(common_.lnz);
    report.memory = 8.0 * static_cast<double>(factor_->xsize);
    return report;
  }

  FactorReport factor_values() override {
    std::copy(values().begin(), values().end(), values_.begin());
    common_.status = CHOLMOD_OK;
    positive_ = false;
    cholmod_factorize(&view_, factor_, &common_);
    if (out_of_memory()) throw std::bad_alloc();
    FactorReport report;
    report.factor_nonzeros = static_cast<std::int64_t>(common_.lnz);
    if (common_.status < CHOLMOD_OK) {
      report.status = FactorStatus::failed;
      report.message = "CHOLMOD failed with status " + std::to_string(common_.status);
      return report;
    }
    positive_ = factor_->minor == factor_->n;
    report.negative_pivots = positive_ ? 0 : 1;
    if (!positive_) report.message = "the matrix is not positive definite";
    return report;
  }

  bool apply_inverse(std::span<double> x) override {
    if (!positive_) return false;
    cholmod_dense right{};
    right.nrow = right.nzmax = right.d = x.size();
    right.ncol = 1;
    right.x = x.data();
    right.xtype = CHOLMOD_REAL;
    right.dtype = CHOLMOD_DOUBLE;
    if (!cholmod_solve2(CHOLMOD_A, factor_, &right, nullptr, &solution_, nullptr, &work_, &work_set_,
                        &common_)) {
      return false;
    }
    std::copy_n(static_cast<const double*>(solution_->x), x.size(), x.begin());
    return true;
  }

 private:
  bool out_of_memory() const {
    return common_.status == CHOLMOD_OUT_OF_MEMORY || common_.status == CHOLMOD_TOO_LARGE;
  }
  void release() {
    cholmod_free_factor(&factor_, &common_);
    cholmod_free_dense(&solution_, &common_);
    cholmod_free_dense(&work_, &common_);
    cholmod_free_dense(&work_set_, &common_);
    positive_ = false;
  }

  OrderingMethod method_;
  cholmod_common common_{};
  cholmod_sparse view_{};
  cholmod_factor* factor_ = nullptr;
  cholmod_dense *solution_ = nullptr, *work_ = nullptr, *work_set_ = nullptr;
  std::vector<int> start_;
  std::vector<double> values_;
  bool positive_ = false;
};

}  // namespace

std::unique_ptr<LinearSolver> make_cholmod_supernodal_solver(OrderingMethod method) {
  return std::make_unique<CholmodSupernodalSolver>(method);
}

std::string cholmod_supernodal_version() {
  return std::to_string(CHOLMOD_MAIN_VERSION) + "." + std::to_string(CHOLMOD_SUB_VERSION) + "." +
         std::to_string(CHOLMOD_SUBSUB_VERSION);
}

}  // namespace isochor
