// One increment: from the state to an end that may become the next one, or to a reason why there is none.
//
//   attempt       data and prediction at the end of the increment, stencils renewed around the guess, then
//     climb         the rungs of ladder.h, one after the other, until one solves it
//       judge         what converged is looked at: nothing passed through, admissible (end_check.h)
//     renew         stencils that change with what is close are renewed; where they were: once more
//   take          the trial positions become the state
#pragma once

#include "engine/step/end_check.h"
#include "engine/step/impacts.h"
#include "engine/step/ladder.h"
#include "engine/step/surroundings.h"

namespace isochor {

class Stepper {
 public:
  explicit Stepper(const StepContext& context);

  // On success, or where an unfinished iterate is kept, the state is the end of the increment; otherwise it
  // was not touched.
  SaddleReport attempt(double h, const Allowance& allowance);
  // Statics that no load step brings further: a motion with strong damping, see damped_motion.cpp.
  SaddleReport damped_motion(double h);
  // Makes the trial positions and multipliers an equilibrium of the state at t, without inertia.
  void take_equilibrium(double t);
  // Of a step of several increments: nothing has failed yet.
  void begin_step() { failures_.fill(0); }
  // Whether a method that others stand in for failed in so many increments on end that it is left out.
  bool gives_up_on(Method method) const;
  // Why the last attempt did not keep its iterate although it might have; empty: it did, or had none.
  const std::string& given_back() const { return given_back_; }
  // Farthest way of a node in the last increment [m].
  double moved() const { return moved_; }

  // Called after every iteration: times of the increment's end, iteration and the two residuals.
  void on_progress(std::function<void(const ProgressInfo&)> progress) { progress_ = std::move(progress); }
  void set_stop_wanted(std::function<bool()> wanted) { stop_wanted_ = std::move(wanted); }

  Methods& methods() { return context_.methods; }
  EndCheck& end() { return end_; }
  Surroundings& surroundings() { return surroundings_; }
  Trial& trial() { return trial_; }

  // For the rungs of the ladder.
  void begin_at_state() { trial_.begin_at(context_.state.x, context_.state.lambda); }
  SaddleReport solve(const SaddleProblem& problem, const SaddleOptions& options);
  SaddleReport solve_by(SaddlePoint& other, const SaddleProblem& problem, const SaddleOptions& options);

 private:
  struct Attempt;
  Attempt begin(double h);
  bool solve_and_renew(Attempt& a, const Allowance& allowance, int climbs);
  SaddleReport climb(Attempt& a);
  void judge(double h, const SaddleProblem& problem, SaddleReport& report);
  void refine_gradients(const SaddleProblem& problem, SaddleOptions options, SaddleReport& report);
  bool may_keep(Attempt& a, const Allowance& allowance);
  void show_progress(double t);
  void take(double h, bool jumps);
  void take_memory(const StencilIncrement& increment);
  void take_multipliers();
  SaddleReport settle(double h, SaddleProblem& problem, SaddleReport total);

  StepContext context_;
  Surroundings surroundings_;
  Impacts impacts_;
  EndCheck end_;
  Trial trial_;
  struct {
    std::vector<Vec3> x;
    std::vector<double> lambda;
  } found_;  // what refine_gradients() goes back to; empty with other methods
  std::vector<double> memory_before_;
  // Increments of the step under way, on end, that each method did not solve; automatic: that of the world.
  std::array<int, 8> failures_{};
  std::string given_back_;
  bool dynamic_ = false;  // the increment at work has inertia
  double moved_ = 0;
  std::function<void(const ProgressInfo&)> progress_;
  std::function<bool()> stop_wanted_;
};

}  // namespace isochor
