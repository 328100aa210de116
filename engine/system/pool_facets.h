// What a pool may be beside stencils or rows. A pool inherits the facets it has and returns them from
// facets(); it is asked once, when a system is compiled (System::facets()), so that what nobody has costs
// nothing.
#pragma once

#include <memory>

#include "engine/system/stencil_request.h"

namespace isochor {

class Parallel;
class StencilPool;

// Where the derivatives of the gradient in what a pool holds on to go (StencilLag), n and K as above.
struct LagSlots {
  std::span<const std::int64_t> block_offset;  // of every stencil in `block`
  std::span<Mat3> block;                       // [block_offset[s] + a * n + b] d gradient_a / d lag.x_b
  std::span<Vec3> column;                      // [first * K + k * n + a] d gradient_a / d lag multiplier_k
};

// Stencils whose evaluate() reads request.lag: what they hold on to within an iteration. An equilibrium is
// one with what would be renewed.
class LaggedStencils {
 public:
  // True when the linear systems are to know how forces change with what is held on to. They are unsymmetric
  // then, and converge as Newton's method does rather than in the pace of the lag.
  virtual bool couples() const { return false; }
  // Fills the slots of stencils [begin, end), zero so far, where a pool can tell how its forces change with
  // what it holds on to; read by coupled systems and by corrections of lagged ones. The lag is at x, with the
  // multipliers of the request.
  virtual void lag_derivatives(const StencilRequest& request, const LagSlots& slots) const {
    (void)request;
    (void)slots;
  }

 protected:
  ~LaggedStencils() = default;
};

// Stencils with numbers that are kept between steps (the pull of a friction force): part of State, zero at
// the start.
class RememberingStencils {
 public:
  virtual int memory() const = 0;
  // What they become when a step is accepted; the request holds the new positions and the old memory.
  virtual void accept(const StencilRequest& request, std::span<double> memory) const = 0;

 protected:
  ~RememberingStencils() = default;
};

// Gaps to what nodes could pass right through within an increment.
class BarrierStencils {
 public:
  // How many nodes pass through on the straight way from where the increment began to x, seen from what they
  // pass through. Where `stopped` is not empty they are put there where they meet it.
  virtual Index passing(const StencilIncrement& increment, std::span<const Vec3> x,
                        std::span<Vec3> stopped) const = 0;
  // How far what is prescribed (an obstacle) is moved from t0 to t1 into nodes that go from `from` to x, over
  // what can be met within one increment: more than 1 asks for a shorter one.
  virtual double intrusion(double t0, double t1, std::span<const Vec3> from,
                           std::span<const Vec3> x) const = 0;

 protected:
  ~BarrierStencils() = default;
};

struct RenewalRequest {
  std::span<const double> memory;  // of the pool, as State holds it; empty: go by the present stencils
  std::span<const Vec3> from, x;   // positions when the increment began, and now [m]
  bool solved = false;  // x is a solution with the present stencils; otherwise the guess before one
  const Parallel* parallel = nullptr;
};
struct Renewal {
  std::shared_ptr<const StencilPool> pool;  // with other stencils; null: the present ones do
  Index crossed = 0;                        // points that went through what the present stencils do not see
  Index passing = 0;  // points that are through although the stencils see what they went through
};

// Stencils that change with what is close (contact of surfaces that move). Between increments, and once a
// solution is found, they are asked whether the present ones do for the positions; the answer depends on the
// request alone. Pools that replace each other have the same name, numbers of stencils and functions, facets,
// and memory, in which they keep what their stencils are.
class RenewedStencils {
 public:
  virtual Renewal renewed(const RenewalRequest& request) const = 0;
  // The pool with the stencils that its memory tells of, as accept() left it there. Refused where the memory
  // is none of this pool.
  virtual Result<std::shared_ptr<const StencilPool>> restored(std::span<const double> memory) const = 0;

 protected:
  ~RenewedStencils() = default;
};

// Stencils that hold on to something which is moved (gaps to an obstacle on its way): it does work on the
// bodies that no potential knows of. Loads and growth are none of them; their balance is taken under what
// they are at the end of an increment.
class MovingStencils {
 public:
  // False only where functions and energies are the same at t0 and at t1, at any positions.
  virtual bool moves(double t0, double t1) const = 0;

 protected:
  ~MovingStencils() = default;
};

// Stencils whose energy is a potential of both ends of an increment that stays the same when these change
// places (viscosity, drag), so that how forces at its end depend on its beginning follows from evaluate().
class DissipativeStencils {
 protected:
  ~DissipativeStencils() = default;
};

struct StencilFacets {
  const LaggedStencils* lagged = nullptr;
  const RememberingStencils* remembering = nullptr;
  const BarrierStencils* barrier = nullptr;
  const RenewedStencils* renewed = nullptr;
  const MovingStencils* moving = nullptr;
  const DissipativeStencils* dissipative = nullptr;
};

// The increment of time that rows are evaluated for, and what the pool keeps between steps.
struct RowIncrement {
  double t0 = 0, t1 = 0;           // [s]; load factors in statics
  std::span<const double> memory;  // of pools that are RememberingRows, as the last accepted step left it
};

// A law c(lambda) in place of C lambda (a gas, say): the row is phi - target - c(lambda) = 0 and
// `compliance` only names the places of dc/dlambda. The law must be non-decreasing (dc/dlambda positive
// semi-definite); an unsymmetric tangent is given by a symmetric one close to it.
class LawRows {
 public:
  // Of a law that takes every row by itself, with `compliance` as its slope at zero: such rows may be
  // condensed, and methods that know no laws take them as linear.
  virtual bool local() const { return false; }
  // Fills strain = c (one a row) and, where not empty, tangent (one for each entry of `compliance`); returns
  // a potential U with dU/dlambda = c. Outside the law's domain: infinity, never NaN.
  virtual double evaluate_law(const RowIncrement& increment, std::span<const double> lambda,
                              std::span<double> strain, std::span<double> tangent) const = 0;

 protected:
  ~LawRows() = default;
};

// Rows with numbers that are kept between steps (the mass of a gas): part of State, so saved, restored and
// hashed with it.
class RememberingRows {
 public:
  virtual int memory() const = 0;
  virtual void start(std::span<double> memory) const = 0;
  // What they become when a step is accepted; increment.memory still holds the old ones.
  virtual void accept(const RowIncrement& increment, std::span<const double> lambda,
                      std::span<double> memory) const = 0;

 protected:
  ~RememberingRows() = default;
};

// What an increment of dynamics begins from, for rows with impacts.
struct ImpactStart {
  double t0 = 0, t1 = 0;           // [s]
  std::span<const Vec3> x, v;      // positions [m] and velocities [m/s] of all nodes
  std::span<const Vec3> ahead;     // where these velocities carry them until t1 [m]
  std::span<const double> mass;    // of all nodes, lumped [kg]
  std::span<const double> target;  // of the rows of the pool, at t1
  std::span<double> work;          // two numbers a row of the pool to work with
};

// Rows that make velocities jump as an increment of dynamics begins. Such an increment is one of implicit
// Euler, from the velocities behind the jump, and schemes start anew behind it.
class ImpactRows {
 public:
  // Adds jumps to those of other rows, one a node [m/s], and says whether there are any.
  virtual bool add_jumps(const ImpactStart& start, std::span<Vec3> jump) const = 0;

 protected:
  ~ImpactRows() = default;
};

// Rows whose targets turn with something.
class TurningRows {
 public:
  // Largest angle [rad] by which anything turns from t0 to t1: beyond half a turn the targets at t1 alone do
  // not tell which way round.
  virtual double turn(double t0, double t1) const = 0;

 protected:
  ~TurningRows() = default;
};

// What one stencil adds to an entry of the compliance.
struct ComplianceShare {
  Index row = 0, col = 0;  // row >= col, both inside the pool
  Index stencil = 0;       // of the pool that the rows are over
  double value = 0;
};

// Rows whose compliance is a sum over stencils: asked where it matters how it changes with one of them.
class SharedCompliance {
 public:
  // They add up to RowSet::compliance.
  virtual std::vector<ComplianceShare> compliance_shares() const = 0;

 protected:
  ~SharedCompliance() = default;
};

struct RowFacets {
  const LawRows* law = nullptr;
  const RememberingRows* remembering = nullptr;
  const ImpactRows* impact = nullptr;
  const TurningRows* turning = nullptr;
  const SharedCompliance* shared = nullptr;
};

}  // namespace isochor
