// How positions relate to inertia. The unknown is x; time is an affine map around it.
#pragma once

#include "engine/state.h"

namespace isochor {

class TimeScheme {
 public:
  virtual ~TimeScheme() = default;
  virtual std::string_view name() const = 0;
  // The factor s of the mass matrix [1/s^2]: 1/h^2 for implicit Euler, 0 in statics.
  virtual double mass_scale(double h) const = 0;
  // Where inertia alone would carry the nodes: inertia is s/2 |x - predicted|^2 in the mass metric.
  virtual void predict(const State& state, double h, std::span<Vec3> predicted) const = 0;
  // Velocities and time from the accepted positions. state.x still holds the old positions.
  virtual void finish(double h, std::span<const Vec3> x_new, State& state) const = 0;
};

}  // namespace isochor
