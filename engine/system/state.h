// What survives a step. A checkpoint holds besides what a host has set (scene/amounts.h).
#pragma once

#include "engine/base/base.h"

namespace isochor {

struct State {
  double t = 0;                // [s]; the load factor in statics
  std::vector<Vec3> x;         // positions [m]
  std::vector<Vec3> v;         // velocities [m/s]
  std::vector<double> lambda;  // multipliers of compliant rows, energy per unit of the row
  std::vector<double> extra;   // what effects and schemes keep between steps (step/state_layout.h)
  // Set by a host, one a node [N]; empty: none was ever set.
  std::vector<Vec3> forces;
  // Internal minus load forces at the last step's end [N]: what supports take up. They follow from the rest
  // and the increment that led here, so the hash leaves them out.
  std::vector<Vec3> reactions;

  std::uint64_t hash() const {
    Hash h;
    h.add(&t, sizeof t);
    h.add(std::span<const Vec3>(x));
    h.add(std::span<const Vec3>(v));
    h.add(std::span<const double>(lambda));
    h.add(std::span<const double>(extra));
    if (!forces.empty()) h.add(std::span<const Vec3>(forces));
    return h.value();
  }
};

}  // namespace isochor
