// What the end of an increment is tested for before it becomes the state, whoever solved it: cells right side
// out where law, guard or rows have no value below (admission.h), a finite energy, rows met at the end of the
// step, and no energy from nothing.
#pragma once

#include "engine/step/admission.h"
#include "engine/step/step_context.h"
#include "isochor/reports.h"

namespace isochor {

class EndCheck {
 public:
  explicit EndCheck(const StepContext& context);

  // Of a step: what an earlier one said is forgotten.
  void begin_step() { led_away_.clear(); }
  // Takes the energy that an increment begins with, under the loads of its end. `jumps`: velocities jump.
  void begin(const SaddleProblem& problem, bool jumps);
  // Whether the trial positions may become the state; otherwise the report is that of a rejection. Of what
  // did not converge: whether it may be kept as an unfinished iterate.
  bool admits(double h, const SaddleProblem& problem, const Trial& trial, SaddleReport& report);
  // Of cells alone, for steps that have no inertia and no end but x.
  bool admits_cells(std::span<const Vec3> x, SaddleReport& report);

  // What a report says about the state that its last increment arrived at. What an earlier one said about the
  // way there stays. `moved`: farthest way of a node in that increment [m].
  void describe(const SaddleReport& solve, double moved, StepReport& report);
  // Of the present state.
  Admission::Verdict judge_state() const { return admission_.judge(context_.state.x, context_.state.x); }

 private:
  bool moved_from_outside(const SaddleProblem& problem) const;
  bool may_stay_unfinished(const StoredEnergy& stored, SaddleReport& report) const;
  std::string energy_gained(double h, const Trial& trial, const StoredEnergy& stored);
  std::string far_away(const SaddleReport& solve, double moved) const;

  StepContext context_;
  Admission admission_;
  Admission::Verdict verdict_;  // of the last end that was looked at
  struct {
    bool known = false;  // false: outside forces do work, or there is nothing to compare with
    double kinetic = 0;
    StoredEnergy stored;
  } before_;
  State ahead_;                 // of dynamics: the state that an end would make
  std::vector<Vec3> momentum_;  // one a node
  std::string led_away_;        // of this step: an increment that ended far from where it began
};

}  // namespace isochor
