// Unknowns go to Ceres in pieces, so that the prior, which is diagonal, is a piece a row of blocks and not a
// matrix of all by all.
#include "studies/inverse/search.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "studies/ceres_words.h"

namespace isochor::inverse {

namespace {

constexpr Eigen::Index kPiece = 64;

struct Pieces {
  explicit Pieces(Eigen::Index n) {
    for (Eigen::Index first = 0; first < n; first += kPiece)
      at.push_back({first, std::min(kPiece, n - first)});
  }
  std::vector<std::pair<Eigen::Index, Eigen::Index>> at;  // first unknown, how many
};

class ErrorCost : public ceres::CostFunction {
 public:
  ErrorCost(const SearchProblem& problem, const Pieces& pieces) : problem_(problem), pieces_(pieces) {
    set_num_residuals(static_cast<int>(problem.errors));
    for (const auto& [first, size] : pieces.at)
      mutable_parameter_block_sizes()->push_back(static_cast<int>(size));
  }
  bool Evaluate(double const* const* x, double* residuals, double** jacobians) const override {
    Eigen::VectorXd all(problem_.start.size()), r;
    for (std::size_t k = 0; k < pieces_.at.size(); ++k) {
      const auto [first, size] = pieces_.at[k];
      all.segment(first, size) = Eigen::Map<const Eigen::VectorXd>(x[k], size);
    }
    Eigen::MatrixXd j;
    if (!problem_.evaluate(all, r, jacobians ? &j : nullptr) || !r.allFinite()) return false;
    Eigen::Map<Eigen::VectorXd>(residuals, r.size()) = r;
    if (!jacobians) return true;
    if (!j.allFinite()) return false;
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    for (std::size_t k = 0; k < pieces_.at.size(); ++k) {
      const auto [first, size] = pieces_.at[k];
      if (jacobians[k]) Eigen::Map<Rows>(jacobians[k], j.rows(), size) = j.middleCols(first, size);
    }
    return true;
  }

 private:
  const SearchProblem& problem_;
  const Pieces& pieces_;
};

class PriorCost : public ceres::CostFunction {
 public:
  PriorCost(Eigen::VectorXd weight, Eigen::VectorXd center)
      : weight_(std::move(weight)), center_(std::move(center)) {
    set_num_residuals(static_cast<int>(weight_.size()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(weight_.size()));
  }
  bool Evaluate(double const* const* x, double* residuals, double** jacobians) const override {
    const auto n = weight_.size();
    Eigen::Map<Eigen::VectorXd>(residuals, n) =
        weight_.cwiseProduct(Eigen::Map<const Eigen::VectorXd>(x[0], n) - center_);
    if (jacobians && jacobians[0]) Eigen::Map<Eigen::MatrixXd>(jacobians[0], n, n) = weight_.asDiagonal();
    return true;
  }

 private:
  Eigen::VectorXd weight_, center_;
};

// Steps that were taken, for who looks on.
struct Watch : ceres::IterationCallback {
  Watch(const SearchOptions& asked, const Eigen::VectorXd& where) : options(asked), x(where) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& s) override {
    if (!s.step_is_successful && s.iteration > 0) return ceres::SOLVER_CONTINUE;
    best = x;
    cost = s.cost;
    if (options.on_iteration) options.on_iteration(s.iteration, s.cost, x);
    return ceres::SOLVER_CONTINUE;
  }
  const SearchOptions& options;
  const Eigen::VectorXd& x;
  Eigen::VectorXd best;
  double cost = 0;
};

}  // namespace

Search search(const SearchProblem& problem, const SearchOptions& options) {
  studies::quiet_ceres();
  Search out;
  out.x = problem.start.cwiseMax(problem.least).cwiseMin(problem.most);
  const Pieces pieces(out.x.size());
  ceres::Problem least_squares;
  std::vector<double*> blocks;
  for (const auto& [first, size] : pieces.at) blocks.push_back(out.x.data() + first);
  least_squares.AddResidualBlock(new ErrorCost(problem, pieces), nullptr, blocks);
  for (std::size_t k = 0; k < pieces.at.size(); ++k) {
    const auto [first, size] = pieces.at[k];
    const Eigen::VectorXd weight = problem.prior.segment(first, size);
    if (weight.cwiseAbs().maxCoeff() > 0) {
      least_squares.AddResidualBlock(new PriorCost(weight, problem.start.segment(first, size)), nullptr,
                                     blocks[k]);
    }
    for (Eigen::Index i = 0; i < size; ++i) {
      const double least = problem.least[first + i], most = problem.most[first + i];
      if (std::isfinite(least)) least_squares.SetParameterLowerBound(blocks[k], static_cast<int>(i), least);
      if (std::isfinite(most)) least_squares.SetParameterUpperBound(blocks[k], static_cast<int>(i), most);
    }
  }
  studies::StopSearch stop(options.stop);
  Watch watch(options, out.x);
  ceres::Solver::Options how;
  how.linear_solver_type = options.many_unknowns ? ceres::CGNR : ceres::DENSE_QR;
  how.preconditioner_type = ceres::IDENTITY;
  how.jacobi_scaling = !options.many_unknowns;
  how.eta = 1e-4;
  how.max_num_iterations = options.max_iterations;
  how.function_tolerance = options.function_tolerance;
  how.gradient_tolerance = options.gradient_tolerance;
  how.parameter_tolerance = options.parameter_tolerance;
  how.logging_type = ceres::SILENT;
  how.num_threads = 1;
  how.update_state_every_iteration = true;
  how.callbacks = {&watch, &stop};
  how.max_num_consecutive_invalid_steps = 20;
  ceres::Solver::Summary summary;
  ceres::Solve(how, &least_squares, &summary);
  out.converged = summary.termination_type == ceres::CONVERGENCE;
  out.interrupted = options.stop && options.stop();
  out.reason = out.converged ? "" : out.interrupted ? "interrupted" : summary.message;
  out.cost = summary.final_cost;
  // Where a search fails Ceres gives the start back.
  if (!summary.IsSolutionUsable() && watch.best.size() > 0) {
    out.x = watch.best;
    out.cost = watch.cost;
  }
  out.iterations = static_cast<int>(summary.iterations.size());
  return out;
}

}  // namespace isochor::inverse
