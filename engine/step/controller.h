// How a world advances: single steps, steps within a budget, adaptive increments, steps along a path of
// equilibria. Decides on lengths; a Stepper makes the increments.
#pragma once

#include "engine/scene/amounts.h"
#include "engine/step/interrupt.h"
#include "engine/step/stepper.h"
#include "engine/step/time_error.h"

namespace isochor {

class Controller {
 public:
  // `settled`: the last state that a step arrived at in balance, while the present one is unfinished.
  Controller(const StepContext& context, Amounts& amounts, Interrupt& interrupt,
             std::optional<State>& settled);

  // As in World.
  StepReport step(double h, const StepBudget& budget);
  StepReport advance(double h);
  StepReport follow(double length);

  Stepper& stepper() { return stepper_; }

 private:
  struct Advance;
  struct Clock;
  double largest_turn(double t0, double t1) const;
  double largest_intrusion(double t0, double t1);
  void begin_amounts(double t0, double t1);
  SaddleReport attempt_within(double h, const StepBudget& budget);
  void describe_single(const SaddleReport& solve, double t_target, StepReport& report);
  double next_length(const Advance& a);
  bool make_increment(Advance& a);
  bool lost_too_much(const Advance& a) const;
  bool took_increment(Advance& a, double dt, const SaddleReport& solve);
  bool go_on_after_failure(Advance& a, double dt, const SaddleReport& solve);
  bool rescued(Advance& a, double dt);
  void give_up(Advance& a, double dt, const SaddleReport& solve, bool hopeless);
  bool give_back_unfinished(StepReport& report);
  SaddleReport follow_once(double length, StepReport& report);
  template <class Steps>
  StepReport within_memory(const char* call, bool once, Steps&& steps);
  bool give_back_memory(double t0, bool was_settled);
  void add(StepReport& total, const SaddleReport& r);
  void step_once(double h, const StepBudget& budget, StepReport& report);
  void advance_by(double h, StepReport& report);
  void follow_by(double length, StepReport& report);
  void take_cancel(StepReport& report);
  StepReport cancelled();
  void finish(const Clock& clock, StepReport& report);

  StepContext context_;
  Amounts& amounts_;
  Interrupt& interrupt_;
  Stepper stepper_;
  TimeError time_error_;
  std::optional<State>& settled_;
  std::vector<double> amounts_before_;
  std::vector<Vec3> ahead_;                              // where velocities carry the nodes
  bool amounts_began_ = false, memory_ran_out_ = false;  // in the step under way
};

}  // namespace isochor
