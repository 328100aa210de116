// The extension points of the engine. An effect is stencils (smooth functions of a few nodes), rows (weighted
// sums of stencil functions with a law), eliminated coordinates, and loads. The engine never asks what an
// effect is.
#pragma once

#include <cmath>
#include <limits>
#include <memory>

#include "engine/base/base.h"
#include "engine/system/pool_facets.h"

namespace isochor {

// What all stencils of a pool have in common.
struct StencilShape {
  bool energy = false;  // they have one
  int functions = 0;    // K, for rows
  bool hessian = true;  // false: linear, there are no Hessian slots
  Index grain = 256;    // stencils a parallel task
};

// All stencils of one kind, contiguous. Pure: evaluation reads rest data and positions, writes slots, nothing
// else. Most pools are done with these four functions and nodes_; what a pool is beside, it says by facets.
class StencilPool {
 public:
  virtual ~StencilPool() = default;
  virtual std::string_view name() const = 0;
  virtual StencilShape shape() const = 0;
  virtual void evaluate(const StencilRequest& request, const StencilSlots& slots) const = 0;
  // True when a rigid motion of all nodes changes its functions or its energy (a spring to a fixed point, a
  // floor): such stencils may hold a body in statics.
  virtual bool sees_rigid_motion() const { return false; }
  virtual StencilFacets facets() const { return {}; }

  const Lists& nodes() const { return nodes_; }
  Index stencils() const { return nodes_.count(); }
  bool has_energy() const { return shape().energy; }
  int functions() const { return shape().functions; }
  bool has_hessian() const { return shape().hessian; }
  Index grain() const { return shape().grain; }
  // Offsets of each stencil's packed Hessian blocks, in blocks; filled by finish_topology().
  std::span<const std::int64_t> hessian_offset() const { return hessian_offset_; }

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

// Rows as data: phi_r = sum_i weight_i * function_i, and what comes with each of them.
struct RowSet {
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
  // Bounds on the multipliers: both empty, or one entry a row with -infinity or +infinity where there is
  // none. A cable that only pulls has lower = 0. A bounded row reads: lambda is where the projection of
  // lambda + theta / metric on the bounds leaves it, theta = phi - target - C lambda (complementarity).
  std::vector<double> lower, upper;
  // The effect that each row is of, where a pool has rows of several: their numbers (Builder::owner()).
  // Empty: all are of the one that added the pool.
  std::vector<Index> owner;
  // How far a row that its bound has let go may be violated at the end of an iteration, in the unit of phi:
  // longer steps are cut. For gaps to what is thin, which a long step would leave behind.
  double largest_overshoot = std::numeric_limits<double>::infinity();

  Index rows() const { return map.count(); }
};

// Rows of one effect over the functions of one stencil pool.
class RowPool : public RowSet {
 public:
  virtual ~RowPool() = default;
  virtual std::string_view name() const = 0;
  // Targets (compliant) or multipliers (prescribed) at time t, one a row.
  virtual void update(double t, std::span<double> value) const {
    (void)t;
    for (double& v : value) v = 0;
  }
  virtual RowFacets facets() const { return {}; }
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
  // As TurningRows::turn().
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
