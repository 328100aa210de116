// Stencils that change with what is close (contact of surfaces that move): they are renewed around positions,
// kept as they are with a solution, or put back as a state remembers them.
#pragma once

#include "engine/step/allowance.h"
#include "engine/step/step_context.h"

namespace isochor {

class Surroundings {
 public:
  explicit Surroundings(const StepContext& context);

  struct Found {
    bool changed = false;
    Index crossed = 0, passing = 0;  // as in Renewal
    std::string error;
  };
  // Renews stencils around x: a solution with the present ones (`solved`), or a guess before one.
  enum class Around : std::uint8_t { guess, solution };
  Found renew(std::span<const Vec3> x, Around around);

  // Puts stencils back with which the trial positions are in balance, and solves with these.
  void keep(std::vector<std::shared_ptr<const StencilPool>> pools, const SaddleProblem& problem,
            const Allowance& allowance, Trial& trial, SaddleReport& report);

  // The stencils that a state has, from what its pools keep, in the place of the present ones.
  Result<void> restore(std::span<const double> memory);

  // Nodes of `x` that passed through something since the increment began; with `stop` they are put where they
  // met it.
  enum class Passing : std::uint8_t { count, stop };
  Index passing(const StencilIncrement& increment, std::span<Vec3> x, Passing passing) const;

 private:
  StepContext context_;
};

}  // namespace isochor
