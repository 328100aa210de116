// Jumps of velocities as an increment of dynamics begins: rows of contact with Newton's law of impact.
#pragma once

#include "engine/step/step_context.h"

namespace isochor {

class Impacts {
 public:
  explicit Impacts(const StepContext& context);

  // Asks rows for jumps in an increment that is evaluated at t, h after its beginning; true when there are
  // any, which trial.x holds then [m/s]. trial.predicted is overwritten.
  bool jump(double t, double h, Trial& trial);
  // In place of what the time scheme keeps: an increment that begins with a jump has no past.
  std::span<const double> no_past() const { return no_past_; }

 private:
  StepContext context_;
  std::vector<double> row_work_;  // two numbers a row; empty: no rows have impacts
  std::vector<double> no_past_;
};

}  // namespace isochor
