// The local error of increments of dynamics, and the length that the next one may have for it.
#pragma once

#include "engine/step/step_context.h"

namespace isochor {

class TimeError {
 public:
  explicit TimeError(const StepContext& context);

  // Whether WorldOptions::time_error asks for it.
  bool controls() const { return controls_; }
  // Length of the next increment that the last one suggested [s]; 0: none.
  double suggested();
  // Takes the state that an increment begins at.
  void begin();
  // Of the increment just taken, which led from the state of begin() to the present one.
  struct Outcome {
    double error = 0;   // relative to the scene's length
    double factor = 1;  // of the increment's length, for the next one
    bool too_large = false;
  };
  Outcome judge(double h);
  // Goes back to the state of begin().
  void take_back() { context_.state = before_; }
  // What the next estimate needs of this increment.
  void keep(double h, double next);

 private:
  double estimate(double h);

  StepContext context_;
  bool controls_;
  State before_;
};

}  // namespace isochor
