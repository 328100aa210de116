#include "engine/solvers/foreign/cholmod_solver.h"

#ifdef ISOCHOR_HAVE_CHOLMOD

#if __has_include(<suitesparse/cholmod.h>)
#include <suitesparse/cholmod.h>
#else
#include <cholmod.h>
#endif

#include <new>

#include "engine/base/base.h"
#include "engine/solvers/front/ldlt_solver.h"

namespace isochor {
namespace {

class CholmodSolver final : public LdltSolver {
 public:
  explicit CholmodSolver(OrderingMethod method) : LdltSolver(method) {
    cholmod_start(&common_);
    common_.print = 0;
    common_.error_handler = nullptr;
    common_.supernodal = CHOLMOD_SIMPLICIAL;
    common_.final_ll = 0;
    // Our matrix comes in the pivot sequence already.
    common_.nmethods = 1;
    common_.method[0].ordering = CHOLMOD_NATURAL;
    common_.postorder = 0;
  }
  ~CholmodSolver() override {
    release();
    cholmod_finish(&common_);
  }
  CholmodSolver(const CholmodSolver&) = delete;
  CholmodSolver& operator=(const CholmodSolver&) = delete;

  std::string_view name() const override { return "cholmod"; }

 protected:
  FactorReport analyze_upper() override {
    release();
    const auto n = matrix().start.size() - 1;
    view_ = {};
    view_.nrow = view_.ncol = n;
    view_.nzmax = matrix().row.size();
    view_.p = matrix().start.data();
    view_.i = matrix().row.data();
    view_.x = matrix().value.data();
    view_.stype = 1;
    view_.itype = CHOLMOD_INT;
    view_.xtype = CHOLMOD_REAL;
    view_.dtype = CHOLMOD_DOUBLE;
    view_.sorted = view_.packed = 1;
    factor_ = cholmod_analyze(&view_, &common_);
    FactorReport report;
    if (factor_ == nullptr || common_.status < CHOLMOD_OK) {
      report.status = common_.status == CHOLMOD_OUT_OF_MEMORY || common_.status == CHOLMOD_TOO_LARGE
                          ? FactorStatus::out_of_memory
                          : FactorStatus::failed;
      report.message = "CHOLMOD's analysis failed with status " + std::to_string(common_.status);
      return report;
    }
    factor_nonzeros = static_cast<std::int64_t>(common_.lnz);
    return report;
  }

  bool factor_upper() override {
    common_.status = CHOLMOD_OK;
    cholmod_factorize(&view_, factor_, &common_);
    if (common_.status == CHOLMOD_OUT_OF_MEMORY || common_.status == CHOLMOD_TOO_LARGE)
      throw std::bad_alloc();
    return common_.status >= CHOLMOD_OK && factor_->xtype == CHOLMOD_REAL && !factor_->is_super &&
           factor_->minor == factor_->n;
  }

  double pivot(Index k) const override {
    const auto* const start = static_cast<const int*>(factor_->p);
    return static_cast<const double*>(factor_->x)[start[k]];
  }

  bool solve_permuted(std::span<double> x) override {
    cholmod_dense right{};
    right.nrow = right.nzmax = right.d = x.size();
    right.ncol = 1;
    right.x = x.data();
    right.xtype = CHOLMOD_REAL;
    right.dtype = CHOLMOD_DOUBLE;
    // The results and workspaces are kept by us from one solve to the next.
    if (!cholmod_solve2(CHOLMOD_A, factor_, &right, nullptr, &solution_, nullptr, &work_, &work_set_,
                        &common_)) {
      return false;
    }
    const auto* const y = static_cast<const double*>(solution_->x);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = y[i];
    return true;
  }

 private:
  void release() {
    cholmod_free_factor(&factor_, &common_);
    cholmod_free_dense(&solution_, &common_);
    cholmod_free_dense(&work_, &common_);
    cholmod_free_dense(&work_set_, &common_);
  }

  cholmod_common common_{};
  cholmod_sparse view_{};
  cholmod_factor* factor_ = nullptr;
  cholmod_dense *solution_ = nullptr, *work_ = nullptr, *work_set_ = nullptr;
};

}  // namespace

std::unique_ptr<LinearSolver> make_cholmod_solver(OrderingMethod method) {
  return std::make_unique<CholmodSolver>(method);
}

std::string cholmod_version() {
  return std::to_string(CHOLMOD_MAIN_VERSION) + "." + std::to_string(CHOLMOD_SUB_VERSION) + "." +
         std::to_string(CHOLMOD_SUBSUB_VERSION);
}

}  // namespace isochor

#else

namespace isochor {

std::unique_ptr<LinearSolver> make_cholmod_solver(OrderingMethod) {
  return nullptr;
}
std::string cholmod_version() {
  return {};
}

}  // namespace isochor

#endif
