// What is tried to solve one increment, in order. docs/solver.md prints these tables, and a test holds that
// it does.
#pragma once

#include "engine/step/allowance.h"

namespace isochor {

class Stepper;

// One solve on its way up the ladder.
struct Climb {
  double h = 0;
  SaddleProblem& problem;
  const Allowance& allowance;
  bool from_guess = false;    // the trial positions are inertia's prediction
  bool stopped = false;       // nodes of it were put where they meet an obstacle
  bool stuck = false;         // the first solve found nothing that may be kept
  bool own_given_up = false;  // the method of the world failed before in this step (Stepper::gives_up_on())
  SaddleReport report;
};

struct Rung {
  std::string_view name, when, counted_as;
  // By which method; automatic: that of the world.
  Method method = Method::automatic;
  bool (*applies)(Stepper&, const Climb&) = nullptr;
  SaddleReport (*run)(Stepper&, Climb&, const SaddleOptions&) = nullptr;
};
std::span<const Rung> ladder();

// What advance() does with an increment that no rung solved.
struct Remedy {
  std::string_view name, when, counted_as;
};
std::span<const Remedy> remedies();

}  // namespace isochor
