// Time schemes for WorldOptions::scheme.
#pragma once

#include "isochor/export.h"
#include "isochor/options.h"

namespace isochor {

// Equilibrium without inertia. Time is the load factor: curves ramp from 0 to 1 by default.
ISOCHOR_API SchemePtr statics();

// The same, for World::follow() too: paths of equilibria through limit points. step() and advance() stay
// those of statics. Curves must reach as far as the load factor may go.
ISOCHOR_API SchemePtr continuation();

// First order; damps fast motion strongly; the safest with large steps.
ISOCHOR_API SchemePtr implicit_euler();

// Second order backward differences (variable step), begun with one implicit Euler step. Damps fast motion,
// hardly damps slow motion; multipliers of hard rows do not oscillate.
ISOCHOR_API SchemePtr bdf2();

// The generalized-alpha method of Chung & Hulbert 1993 in the form of Arnold & Bruels 2007, which meets hard
// rows at the end of each step; second order. spectral_radius in [0, 1] is what is left of the fastest motion
// after a step: 1 keeps energy best and lets multipliers of hard rows oscillate from step to step, 0 damps
// them within a step. Begun with one implicit Euler step. A value outside [0, 1] is refused by World::create.
ISOCHOR_API SchemePtr generalized_alpha(double spectral_radius = 0.8);

// Newmark's method with beta = 1/4, gamma = 1/2 (the trapezoidal rule): generalized_alpha's forces at the end
// of a step and no damping of its own. For bodies without hard rows; with them, multipliers oscillate.
ISOCHOR_API SchemePtr newmark();

// The implicit midpoint rule: second order, no damping of its own; forces, supports and rows are met in the
// middle of a step, so that the end of a step misses hard rows by what is of second order in its length, and
// the residuals of rows at the end say so. Multipliers belong to the middle and do not oscillate.
// Not for contact or other rows with bounds.
ISOCHOR_API SchemePtr implicit_midpoint();

// Statics then dynamics in one run: increments that begin before `time` [s] end in equilibrium, without
// inertia and without damping, and leave the body at rest; from there `then` goes on. Time is seconds
// throughout, so that loads that come gradually have curves. World::create refuses a time that is not
// positive and a scheme without inertia or implicit_midpoint(). The time error is that of dynamics and wants
// no control here.
ISOCHOR_API SchemePtr static_until(double time, SchemePtr then);

}  // namespace isochor
