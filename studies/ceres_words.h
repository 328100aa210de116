// What every search by Ceres of ours says and does not say.
#pragma once

#include <ceres/ceres.h>
#include <glog/logging.h>

#include <functional>

namespace isochor::studies {

// What a trial without a value makes Ceres say is no news to the user.
inline void quiet_ceres() {
  static const bool once = [] {
    FLAGS_minloglevel = 3;
    FLAGS_logtostderr = true;
    return true;
  }();
  (void)once;
}

// Ends a search in good order where it is asked to. An abort would put the start in the place of what was
// found.
struct StopSearch : ceres::IterationCallback {
  explicit StopSearch(const std::function<bool()>& asked) : stop(asked) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary&) override {
    return stop && stop() ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }
  const std::function<bool()>& stop;
};

// Of small problems that are searched to the last digits.
inline ceres::Solver::Options to_last_digits(int most_iterations) {
  ceres::Solver::Options how;
  how.linear_solver_type = ceres::DENSE_QR;
  how.max_num_iterations = most_iterations;
  how.function_tolerance = 1e-15;
  how.gradient_tolerance = 1e-14;
  how.parameter_tolerance = 1e-12;
  how.logging_type = ceres::SILENT;
  how.num_threads = 1;
  return how;
}

}  // namespace isochor::studies
