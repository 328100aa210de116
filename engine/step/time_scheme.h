// How positions relate to inertia. The unknown is x; time is an affine map around it.
#pragma once

#include "engine/base/fingerprint.h"
#include "engine/system/state.h"

namespace isochor {

// Numbers that a scheme keeps between steps, beside positions and velocities: some, then lists of one vector
// a node, then some. All zero at the start, which a scheme takes as having no past.
struct SchemeMemory {
  enum class Starts : std::uint8_t { zero, position, velocity };
  std::size_t before = 0, vectors = 0, after = 0;
  std::array<Starts, 4> starts{};  // of each list: what a node without a past has in it

  std::size_t numbers(std::size_t nodes) const { return before + 3 * vectors * nodes + after; }
};

class TimeScheme {
 public:
  virtual ~TimeScheme() = default;
  virtual std::string_view name() const = 0;
  // Its name and parameters: what it keeps between steps is of use to no other.
  virtual void describe(Fingerprint& f) const { f.add(name()); }
  virtual bool has_inertia() const { return true; }
  // Whether World::follow() may trace paths of equilibria; memory() is then 3 numbers a node and one.
  virtual bool follows_paths() const { return false; }
  // Part of the step at whose end forces and rows are evaluated: x of begin() and finish() is there.
  virtual double evaluated_at() const { return 1; }
  // Order of accuracy, and the local error of positions as error_constant * h^2 |acceleration| (first order)
  // or error_constant * h^3 |its rate of change| (second).
  virtual int order() const { return 2; }
  virtual double error_constant() const { return 1.0 / 6; }

  // Energy that an increment may gain from nothing, relative to what moves and is stored, before its end is
  // refused. Implicit Euler promises next to
  // none; the others keep energy for linear bodies in motion, and may gain
  // it without end where large rotations, impacts or long steps break what their proofs assume.
  virtual double largest_energy_gain() const { return 0.05; }

  virtual SchemeMemory memory() const { return {}; }
  // Begins a step of length h: inertia is s/2 |x - predicted|^2 in the mass metric. Fills `predicted`, where
  // inertia alone would carry the nodes, and returns s [1/s^2]: 1/h^2 for implicit Euler, 0 in statics.
  virtual double begin(const State& state, std::span<const double> memory, double h,
                       std::span<Vec3> predicted) const = 0;
  // Velocities and time from the accepted positions. state.x still holds the old positions; `predicted` is
  // what begin() filled in.
  virtual void finish(double h, std::span<const Vec3> x_new, std::span<const Vec3> predicted, State& state,
                      std::span<double> memory) const = 0;
};

}  // namespace isochor
