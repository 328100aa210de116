// What solves one saddle point, whichever way: an evaluator, the linear systems with the ladder that mends
// their inertia, and the iterates.
#pragma once

#include "engine/solve/inertia_correction.h"

namespace isochor {

class SaddlePoint {
 public:
  SaddlePoint(std::shared_ptr<const System> system, const Parallel& parallel,
              std::unique_ptr<LinearSolver> solver);
  virtual ~SaddlePoint() = default;
  SaddlePoint(const SaddlePoint&) = delete;
  SaddlePoint& operator=(const SaddlePoint&) = delete;

  // Improves x and lambda in place; on anything but converged they hold the last iterate.
  SaddleReport solve(const SaddleProblem& problem, const SaddleOptions& options, std::span<Vec3> x,
                     std::span<double> lambda);

  // Derivatives at a solution: evaluates and factors there as it is, nothing mended; then, as often as
  // wanted, steps and multipliers with which other problems would be solved to first order. False: the report
  // says why, without a reason where the method has no factors.
  virtual bool linearize(const SaddleProblem& p, std::span<const Vec3> x, std::span<const double> lambda,
                         SaddleReport& report) {
    (void)p, (void)x, (void)lambda, (void)report;
    return false;
  }
  virtual bool respond(const SaddleProblem& p, std::span<Vec3> dx, std::span<double> lambda,
                       SaddleReport& report) {
    (void)p, (void)dx, (void)lambda, (void)report;
    return false;
  }

  // Asked often, from any thread that works; true stops the solve.
  void set_interrupt(std::function<bool()> asked);
  // Called after every iteration: iteration number and the two residuals.
  std::function<void(int, double, double)> progress;

  const Assembly& assembly() const { return evaluator_.assembly(); }
  Assembly& assembly() { return evaluator_.assembly(); }
  LinearSolver& linear_solver() { return kkt_.linear_solver(); }
  // The system has other numbers than before, in the same structure.
  void take_new_numbers() {
    evaluator_.calibrate();
    kkt_.take_new_numbers();
  }
  // For what replaces it; there is no solving any more.
  std::unique_ptr<LinearSolver> release_solver() { return kkt_.release_solver(); }
  std::unique_ptr<LinearSolver> release_unsymmetric() { return kkt_.release_unsymmetric(); }
  const StageSeconds& seconds() const { return seconds_; }
  // Counts the time of a method that this one takes the place of.
  void add_seconds(const StageSeconds& earlier) { seconds_ += earlier; }
  std::int64_t factor_nonzeros() const { return kkt_.factor_nonzeros(); }
  int analyses() const { return kkt_.analyses(); }
  // Largest diagonal stiffness of each node at rest [N/m].
  std::span<const double> rest_stiffness() const { return evaluator_.rest_stiffness(); }

  // Energy at the given positions and multipliers, or at the last solve's iterate.
  StoredEnergy stored_at(const SaddleProblem& p, std::span<const Vec3> x, std::span<const double> lambda);
  StoredEnergy stored(const SaddleProblem& p) const { return evaluator_.stored(p, now_); }
  // Internal minus load forces, plus inertia, at the last solve's iterate: zero at free coordinates in
  // balance, the support force on the body at given ones [N].
  std::span<const Vec3> residual() const { return now_.force; }

 protected:
  // From now_, which holds positions, and multipliers within their bounds; improves it in place.
  virtual SaddleReport solve_from_here(const SaddleProblem& problem, const SaddleOptions& options) = 0;

  const System& system() const { return evaluator_.system(); }
  Assembly& slots() { return evaluator_.assembly(); }
  bool interrupted() const { return interrupt_ && interrupt_(); }
  // The status of a solve that failed: whatever the reason seems to be, if it was stopped that is it.
  SaddleStatus failed_as(SaddleStatus status) const {
    return interrupted() ? SaddleStatus::cancelled : status;
  }

  Evaluator evaluator_;
  Kkt kkt_;
  StageSeconds seconds_;
  InertiaCorrection matrix_;
  Iterate now_, trial_;
  Gap gap_;  // of given coordinates that are not at their targets yet

 private:
  std::function<bool()> interrupt_;
};

}  // namespace isochor
