// The stress-free state of a solid where it is not that of its mesh: F = F_e F_g (Rodriguez, Hoger &
// McCulloch 1994), F_g the growth of a piece that nothing holds and F_e what strains it. Swelling, thermal
// expansion and prestrain are of this kind.
#pragma once

#include <memory>
#include <vector>

#include "engine/base/base.h"

namespace isochor {

// A number over time, asked once for all stencils of a task.
class NumberOverTime {
 public:
  virtual ~NumberOverTime() = default;
  virtual double at(double t) const = 0;
};

// The growth of one stencil.
struct GrownState {
  double inverse[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};  // F_g^-1, symmetric
  double J = 1;                                     // det F_g
  bool valid = true;                                // F_g is positive definite
};

struct Growth {
  // Symmetric, packed xx yy zz xy yz zx.
  using Tensor = std::array<double, 6>;

  std::shared_ptr<const NumberOverTime> amount;
  // F_g = 1 + amount G; or J_g = 1 + amount tr G/3, the same in all directions.
  bool by_volume = false;
  std::vector<Tensor> rate;  // G, one for all or one a cell of the mesh; once gathered one a stencil
  bool field = false;        // of cells

  GrownState at(Index element, double amount) const;
  // For the stencils of a pool, each with the mean over its cells; weights sum to one.
  std::shared_ptr<const Growth> gathered(const Lists& cells, std::span<const double> weight) const;
};

}  // namespace isochor
