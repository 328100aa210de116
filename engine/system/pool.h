// The extension points of the engine. An effect is stencils (smooth functions of a few nodes), rows (weighted
// sums of stencil functions with a law), eliminated coordinates, and loads. The engine never asks what an
// effect is.
#pragma once

#include <cmath>
#include <limits>
#include <memory>

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
  StencilLag lag{};                  // of pools with has_lag()
  std::span<const double> memory{};  // StencilPool::memory() numbers as the last accepted step left them
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

// Where the derivatives of the gradient in what a pool holds on to go (StencilLag), n and K as above.
struct LagSlots {
  std::span<const std::int64_t> block_offset;  // of every stencil in `block`
  std::span<Mat3> block;                       // [block_offset[s] + a * n + b] d gradient_a / d lag.x_b
  std::span<Vec3> column;                      // [first * K + k * n + a] d gradient_a / d lag multiplier_k
};

class Parallel;
class StencilPool;

// What followed() is asked.
struct FollowRequest {
  std::span<const double> memory;  // of the pool, as State holds it; empty: go by the present stencils
  std::span<const Vec3> from, x;   // positions when the increment began, and now [m]
  bool solved = false;  // x is a solution with the present stencils; otherwise the guess before one
  const Parallel* parallel = nullptr;
};
struct FollowAnswer {
  std::shared_ptr<const StencilPool> pool;  // with other stencils; null: the present ones do
  Index crossed = 0;                        // points that went through what the present stencils do not see
  Index passing = 0;  // points that are through although the stencils see what they went through
};

// All stencils of one kind, contiguous. Pure: evaluation reads rest data and positions, writes slots, nothing
// else.
class StencilPool {
 public:
  virtual ~StencilPool() = default;
  virtual std::string_view name() const = 0;
  const Lists& nodes() const { return nodes_; }
  Index stencils() const { return nodes_.count(); }
  virtual bool has_energy() const = 0;
  virtual int functions() const = 0;  // K >= 0
  virtual bool has_hessian() const { return true; }
  // True when a rigid motion of all nodes changes its functions or its energy (a spring to a fixed point, a
  // floor): such stencils may hold a body in statics.
  virtual bool sees_rigid_motion() const { return false; }
  virtual void evaluate(const StencilRequest& request, const StencilSlots& slots) const = 0;

  // True when evaluate() reads request.lag. An equilibrium is one with what it would renew.
  virtual bool has_lag() const { return false; }
  // True when the linear systems are to know how forces change with what a pool with a lag holds on to. They
  // are unsymmetric then, and converge as Newton's method does rather than in the pace of the lag.
  virtual bool couples() const { return false; }
  // Fills the slots of stencils [begin, end), zero so far, of a pool with a lag that can tell how its forces
  // change with what it holds on to; read by coupled systems and by corrections of lagged ones. The lag is at
  // x, with the multipliers of the request.
  virtual void lag_derivatives(const StencilRequest& request, const LagSlots& slots) const {
    (void)request;
    (void)slots;
  }
  // Numbers kept between steps (the pull of a friction force): part of State, zero at the start.
  virtual int memory() const { return 0; }
  // What they become when a step is accepted; the request holds the new positions and the old memory.
  virtual void accept(const StencilRequest& request, std::span<double> memory) const {
    (void)request;
    (void)memory;
  }
  // True for pools of gaps to what nodes could pass right through within an increment.
  virtual bool has_barrier() const { return false; }
  // How many nodes pass through on the straight way from where the increment began to x, seen from what they
  // pass through. Where `stopped` is not empty they are put there where they meet it.
  virtual Index passing(const StencilIncrement& increment, std::span<const Vec3> x,
                        std::span<Vec3> stopped) const {
    (void)increment;
    (void)x;
    (void)stopped;
    return 0;
  }
  // How far what is prescribed (an obstacle) is moved from t0 to t1 into nodes that go from `from` to x, over
  // what can be met within one increment: more than 1 asks for a shorter one.
  virtual double entry(double t0, double t1, std::span<const Vec3> from, std::span<const Vec3> x) const {
    (void)t0;
    (void)t1;
    (void)from;
    (void)x;
    return 0;
  }

  // True for pools whose stencils change with what is close (contact of surfaces that move). Between
  // increments, and once a solution is found, they are asked whether the present stencils do for the
  // positions; the answer depends on the request alone. Pools that replace each other have the same name,
  // numbers of stencils and functions, and memory.
  virtual bool follows() const { return false; }
  virtual FollowAnswer followed(const FollowRequest& request) const {
    (void)request;
    return {};
  }
  // The pool with the stencils that its memory tells of, as accept() left it there. Refused where the memory
  // is none of this pool.
  virtual Result<std::shared_ptr<const StencilPool>> restored(std::span<const double> memory) const {
    (void)memory;
    return Error{std::string(name()) + " has no stencils to restore"};
  }

  // Offsets of each stencil's packed Hessian blocks, in blocks; filled by finish_topology().
  std::span<const std::int64_t> hessian_offset() const { return hessian_offset_; }
  // Stencils per parallel task.
  virtual Index grain() const { return 256; }

 protected:
  // Call once nodes_ is complete.
  void finish_topology() {
    hessian_offset_.assign(1, 0);
    for (Index s = 0; s < nodes_.count(); ++s) {
      const std::int64_t n = static_cast<std::int64_t>(nodes_[s].size());
      hessian_offset_.push_back(hessian_offset_.back() + n * (n + 1) / 2);
    }
  }
  Lists nodes_;

 private:
  std::vector<std::int64_t> hessian_offset_;
};

// How the multiplier of a row comes about.
enum class RowLaw : std::uint8_t {
  compliant,   // phi - target - C lambda = 0, lambda is an unknown; C = 0 is a hard row
  prescribed,  // lambda is given (a pressure in pascal); the row is no unknown and enters as a load
};

struct ComplianceEntry {
  Index row = 0, col = 0;  // row >= col, both inside the pool
  double value = 0;
};

// The increment of time that rows are evaluated for, and what the pool keeps between steps.
struct RowIncrement {
  double t0 = 0, t1 = 0;           // [s]; load factors in statics
  std::span<const double> memory;  // RowPool::memory() numbers as the last accepted step left them
};

// What an increment of dynamics begins from, for rows that look back at it.
struct RowStart {
  double t0 = 0, t1 = 0;           // [s]
  std::span<const Vec3> x, v;      // positions [m] and velocities [m/s] of all nodes
  std::span<const Vec3> ahead;     // where these velocities carry them until t1 [m]
  std::span<const double> mass;    // of all nodes, lumped [kg]
  std::span<const double> target;  // of the rows of the pool, at t1
  std::span<double> work;          // two numbers a row of the pool to work with
};

// Rows of one effect over the functions of one stencil pool: phi_r = sum_i weight_i * function_i.
class RowPool {
 public:
  virtual ~RowPool() = default;
  virtual std::string_view name() const = 0;

  Index rows() const { return map.count(); }

  Index stencil_pool = -1;     // which pool's functions; stencil * K + k numbers a function
  Lists map;                   // per row: function numbers
  std::vector<double> weight;  // parallel to map.item
  RowLaw law = RowLaw::compliant;
  RowTreatment treatment = RowTreatment::automatic;
  std::vector<ComplianceEntry> compliance;  // lower triangle; none: hard
  // Row metric D > 0: phi^2 / D is an energy of the size that distortion costs (shear modulus times volume
  // for a volume row). It weighs the rows in the merit function and scales the linear system; the solution
  // does not depend on it.
  std::vector<double> metric;
  // What |phi - target - C lambda| is compared with to decide convergence, in the unit of phi (a volume).
  std::vector<double> measure;

  // Targets (compliant) or multipliers (prescribed) at time t, one a row.
  virtual void update(double t, std::span<double> value) const {
    (void)t;
    for (double& v : value) v = 0;
  }
  // True when velocities may jump as an increment of dynamics begins (impacts).
  virtual bool looks_back() const { return false; }
  // Adds jumps to those of other rows, one a node [m/s], and says whether there are any. An increment that
  // begins so is one of implicit Euler, from the velocities behind the jump, and schemes start anew behind
  // it.
  virtual bool look_back(const RowStart& start, std::span<Vec3> jump) const {
    (void)start;
    (void)jump;
    return false;
  }
  // As Prescriber::turn(), of the targets.
  virtual double turn(double t0, double t1) const {
    (void)t0;
    (void)t1;
    return 0;
  }

  // Bounds on the multipliers: both empty, or one entry a row with -infinity or +infinity where there is
  // none. A cable that only pulls has lower = 0. A bounded row reads: lambda is where the projection of
  // lambda + theta / metric on the bounds leaves it, theta = phi - target - C lambda (complementarity).
  std::vector<double> lower, upper;
  // How far a row that its bound has let go may be violated at the end of an iteration, in the unit of phi:
  // longer steps are cut. For gaps to what is thin, which a long step would leave behind.
  double largest_overshoot = std::numeric_limits<double>::infinity();

  // A law c(lambda) in place of C lambda (a gas, say): the row is phi - target - c(lambda) = 0 and
  // `compliance` only names the places of dc/dlambda. The law must be non-decreasing (dc/dlambda positive
  // semi-definite); an unsymmetric tangent is given by a symmetric one close to it.
  virtual bool has_law() const { return false; }
  // Of a law that takes every row by itself, with `compliance` as its slope at zero: such rows may be
  // condensed, and methods that know no laws take them as linear.
  virtual bool has_local_law() const { return false; }
  // Fills strain = c (one a row) and, where not empty, tangent (one for each entry of `compliance`); returns
  // a potential U with dU/dlambda = c. Outside the law's domain: infinity, never NaN.
  virtual double evaluate_law(const RowIncrement& increment, std::span<const double> lambda,
                              std::span<double> strain, std::span<double> tangent) const {
    (void)increment;
    (void)lambda;
    (void)strain;
    (void)tangent;
    return 0;
  }

  // Numbers kept between steps (the mass of a gas): part of State, so saved, restored and hashed with it.
  virtual int memory() const { return 0; }
  virtual void start(std::span<double> memory) const { (void)memory; }
  // What they become when a step is accepted; increment.memory still holds the old ones.
  virtual void accept(const RowIncrement& increment, std::span<const double> lambda,
                      std::span<double> memory) const {
    (void)increment;
    (void)lambda;
    (void)memory;
  }
};

// Coordinates that are given: removed from the unknowns, their forces recovered as reactions.
struct PrescribedNode {
  Index node = -1;
  int directions = 0;  // 1..3 orthonormal directions in which the node is given
  std::array<Vec3, 3> direction{};
};

class Prescriber {
 public:
  virtual ~Prescriber() = default;
  virtual std::string_view name() const = 0;
  std::vector<PrescribedNode> nodes;
  // Target positions at time t, one for each entry of nodes; only the given directions of it count.
  virtual void target(double t, std::span<Vec3> position) const = 0;
  // Largest angle [rad] by which anything turns from t0 to t1: beyond half a turn the targets at t1 alone do
  // not tell which way round.
  virtual double turn(double t0, double t1) const {
    (void)t0;
    (void)t1;
    return 0;
  }
};

// Forces that do not depend on positions (gravity, dead tractions): potential -f . x.
class LoadPool {
 public:
  virtual ~LoadPool() = default;
  virtual std::string_view name() const = 0;
  virtual void add(double t, std::span<Vec3> force) const = 0;  // adds newtons to all nodes of the scene
};

// An entry of the mass matrix beside the lumped masses, the same for the three coordinates.
struct MassEntry {
  Index row = 0, col = 0;  // nodes, row >= col
  double value = 0;        // [kg]
};

// A named number that an effect reports beside the state (a chamber's pressure and volume).
struct GaugeValue {
  std::string effect, kind, quantity, unit;
  double value = 0;
};

}  // namespace isochor
