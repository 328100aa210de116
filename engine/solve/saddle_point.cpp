#include "engine/solve/saddle_point.h"

namespace isochor {

SaddlePoint::SaddlePoint(std::shared_ptr<const System> system, const Parallel& parallel,
                         std::unique_ptr<LinearSolver> solver)
    : evaluator_(system, parallel),
      kkt_(system, parallel, std::move(solver)),
      matrix_(evaluator_, kkt_, seconds_),
      now_(*system),
      trial_(*system) {
  gap_.way.resize(at(system->nodes()));
}

void SaddlePoint::set_interrupt(std::function<bool()> asked) {
  kkt_.set_interrupt(asked);
  matrix_.set_interrupt(asked);
  interrupt_ = std::move(asked);
}

SaddleReport SaddlePoint::solve(const SaddleProblem& p, const SaddleOptions& options, std::span<Vec3> x,
                                std::span<double> lambda) {
  if (!all_finite(p)) {
    SaddleReport report;
    report.status = failed_as(SaddleStatus::not_finite);
    return report;
  }
  kkt_.linear_solver().begin_solve();
  evaluator_.begin(p);
  matrix_.begin(options.definiteness);
  now_.set(x, lambda);
  evaluator_.clamp(now_.lambda);
  SaddleReport report = solve_from_here(p, options);
  now_.get(x, lambda);
  return report;
}

StoredEnergy SaddlePoint::stored_at(const SaddleProblem& p, std::span<const Vec3> x,
                                    std::span<const double> lambda) {
  trial_.set(x, lambda);
  evaluator_.evaluate_values(p, trial_);
  return evaluator_.stored(p, trial_);
}

}  // namespace isochor
