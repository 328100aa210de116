// How a world is solved: the scheme, the method, tolerances and budgets.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "isochor/choices.h"
#include "isochor/curves.h"
#include "isochor/types.h"

namespace isochor {

class TimeScheme;  // engine-side
// Made by the functions of <isochor/schemes.h>.
using SchemePtr = std::shared_ptr<const TimeScheme>;

// How the saddle point of a step is solved. All but `position_based` end at the same solution; docs/solver.md
// compares their cost.
enum class Method : std::uint8_t {
  automatic,            // chosen when the world is compiled; World::method() says what and why
  saddle_point,         // Newton, direct factors of the whole saddle point
  condensation,         // Newton, compliant rows condensed into the stiffness, wide ones bordered
  dual_gradients,       // Newton, direct factors of the stiffness, conjugate gradients on the multipliers
  augmented_gradients,  // the same on an augmented stiffness: positive definite more often, fewer iterations
  dual_ascent,          // positions by Newton at fixed multipliers, these by steepest ascent; no saddle point
  augmented_ascent,     // the same on an augmented Lagrangian, steps in units of the row metric
  position_based,  // XPBD: a fixed number of Gauss-Seidel sweeps. Cheap, and not the solution: see the page
};

struct WorldOptions {
  SchemePtr scheme;  // required: implicit_euler(), statics(), ...
  Method method = Method::automatic;
  Solver solver = Solver::automatic;
  int sweeps = 20;          // of Method::position_based, a step
  int threads = 0;          // 0: all the machine has. The answer does not depend on it.
  int max_iterations = 60;  // Newton iterations a step; advance() may take five times as many in dynamics
  // Hessians of elements in Newton's method. Exact ones, made definite only where the matrix of a whole step
  // has the wrong inertia, need the fewest iterations; definite ones from the start lead other ways out of
  // crushed and tangled shapes (docs/elements.md).
  Definiteness definiteness = Definiteness::exact;
  double force_tolerance = 1e-9;  // unbalanced force, relative to the forces that cancel
  double row_tolerance = 1e-10;   // relative volume (or other measure) error of a row
  // Adaptive increments of advance(): smallest fraction of the increment asked for.
  double smallest_fraction = 1.0 / 64;
  // Where increments have shrunk to that and still fail, statics tries to reach the equilibrium through a
  // damped motion (pseudo-transient continuation) before it gives up.
  bool transient_rescue = true;
  // Dynamics: largest local error of positions an increment of advance() may have, root mean square over the
  // mass, relative to the scene's length. 0: increments are as long as they converge.
  double time_error = 0;
  // Inertia by the consistent mass matrix instead of the lumped one.
  bool consistent_mass = false;
  Vec3 gravity{};  // [m/s^2]; scaled by gravity_curve
  Curve gravity_curve = Curve::constant(1);
  std::function<void(const std::string&)> log;  // warnings; may be empty
};

// What a step may cost: Newton iterations and wall time. Time makes results depend on the machine.
struct StepBudget {
  int iterations = 0;  // 0: WorldOptions::max_iterations
  double seconds = 0;  // 0: no limit; an iteration under way is finished
};

}  // namespace isochor
