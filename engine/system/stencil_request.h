// What stencils are asked, and where their answers go.
#pragma once

#include "engine/base/base.h"

namespace isochor {

// The increment that stencils with a past look back over: damping, friction, obstacles that move.
struct StencilIncrement {
  double h = 0;                  // [s]; 0: no time passes (statics, results), and damping is zero
  std::span<const Vec3> before;  // positions of all nodes when it began [m]; empty: there is none (results)
  double t0 = 0, t1 = 0;         // when it began and ends [s]; load factors in statics
};

// What stencils hold on to within an iteration and renew between iterations, so that every linear system is
// symmetric and every line search descends one function: the normal force and the frame of a friction force.
struct StencilLag {
  std::span<const Vec3> x;                      // positions of all nodes [m]; empty: nothing to hold on to
  std::span<const double> function_multiplier;  // as in StencilRequest
};

// What evaluate() is asked, for stencils [begin, end) of the pool.
struct StencilRequest {
  Want want = Want::value;
  Definiteness definiteness = Definiteness::exact;
  Index begin = 0, end = 0;
  std::span<const Vec3> x;                      // positions of all nodes [m]
  std::span<const Vec3> rest;                   // rest positions of all nodes [m]
  std::span<const double> function_multiplier;  // functions() a stencil: sum over rows of weight * multiplier
  StencilIncrement increment{};
  StencilLag lag{};  // of pools that are LaggedStencils
  std::span<const double>
      memory{};  // of pools that are RememberingStencils, as the last accepted step left it
};

// Where the answers go: spans over the whole pool. Stencil s owns its own places and nothing else, so
// stencils can be evaluated in any order by any thread. `first` = nodes.offset[s], n = its number of nodes, K
// = functions().
struct StencilSlots {
  std::span<double> energy;  // [s] energy [J]; +infinity outside the domain (an inverted neo-Hookean tet)
  std::span<double> value;   // [s * K + k] function values
  std::span<Vec3> gradient;  // [first + a] d(energy + sum_k multiplier_k * function_k)/dx_a
  std::span<Vec3> jacobian;  // [first * K + k * n + a] dfunction_k/dx_a
  std::span<Mat3>
      hessian;  // [hessian_offset(s) + a (a + 1) / 2 + b], b <= a: second derivative of the same sum
};

}  // namespace isochor
