// What friction keeps of its points from one step to the next, in the memory of a pool of contact.
#pragma once

#include "constraints/contact/friction/friction_law.h"

namespace isochor {

// By point: `ahead` numbers that are the pool's own, then the pull that the last step left, in axes that turn
// with the surface [N], and what the law keeps.
struct FrictionMemory {
  FrictionLaw law;
  int ahead = 0;

  int per_point() const { return ahead + (law.any() ? 3 + law.memory() : 0); }
  Vec3 pull(Index point, std::span<const double> memory) const {
    if (memory.empty() || !law.any()) return {};
    const double* m = memory.data() + first(point);
    return {m[0], m[1], m[2]};
  }
  double coefficient(Index point, std::span<const double> memory) const {
    return law.coefficient(memory.empty() ? nullptr : memory.data() + first(point) + 3);
  }
  void keep(Index point, const Vec3& pull, bool slips, std::span<double> memory) const {
    double* m = memory.data() + first(point);
    for (int i = 0; i < 3; ++i) m[i] = pull[i];
    if (law.memory() > 0) m[3] = slips ? 1 : 0;
  }

 private:
  std::size_t first(Index point) const {
    return static_cast<std::size_t>(per_point()) * at(point) + static_cast<std::size_t>(ahead);
  }
};

}  // namespace isochor
