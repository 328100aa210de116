// What each cell of a body adds to the equations, per unit of a factor on its stiffness.
#pragma once

#include <functional>

#include "engine/scene/builder.h"
#include "engine/system/assembly.h"

namespace isochor {

// Forces of energies are in proportion to the stiffness of their cells, compliances in inverse proportion, so
// that both are known without a difference.
class CellTerms {
 public:
  CellTerms(const BodyData& body, const System& system, const Assembly& assembly, const Parallel& parallel,
            std::span<const Vec3> x, std::span<const double> lambda);

  // d force_a/d factor of the cell = share * forces[a], and the same of the energy.
  struct Stencil {
    Index cell = -1;
    Index pool = -1, patch = -1;  // of edge-smoothed bodies: the stencil of the elastic pool
    double share = 1;
    double energy = 0;
    std::span<const Index> nodes;
    std::span<const Vec3> forces;
  };
  using Force = std::function<void(const Stencil&)>;
  Result<void> each_force(const Force& visit) const;
  // (cell, row, value): d theta_row/d factor of the cell = value.
  using Row = std::function<void(Index, Index, double)>;
  void each_row(const Row& visit) const;

 private:
  void pool_forces(Index pool, const Force& visit) const;
  Result<void> patch_forces(const RegionData& region, const Force& visit) const;

  const BodyData& body_;
  const System& system_;
  const Assembly& assembly_;
  const Parallel& parallel_;
  std::span<const Vec3> x_;
  std::span<const double> lambda_;
};

}  // namespace isochor
