// What outputs read of a scene beside positions and multipliers themselves: how it changes with a parameter
// while these are held is a part of the gradient.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "engine/world/recovery.h"
#include "engine/world/world_impl.h"

namespace isochor {

struct EquationsAt;

struct Watched {
  enum class What : std::uint8_t { gauge, stress, force, elastic, gravity, loads, pressures, kinetic };
  What what = What::gauge;
  Index effect = -1;
  std::string quantity;  // of a gauge or of a stress
  Index body = -1, cell = -1;
  Vec3 direction{};
  bool operator==(const Watched&) const = default;
};

// At the last evaluation of the assembly, which was one of the state. NaN: there is no such gauge.
double watched_value(const EquationsAt& where, const State& state, const Watched& watched);
double gauge_value(const EffectInstance& effect, const std::string& quantity, const System& system,
                   const State& state);

// What recover_fields() takes, of a body at the last evaluation.
struct Recovery {
  Recovery(const BodyData& body, const SystemParts& parts, const Assembly& assembly, const State& state);
  Recovery(const Recovery&) = delete;
  Recovery& operator=(const Recovery&) = delete;

  std::vector<std::span<const double>> multipliers;
  std::vector<double> nodal;  // none
  RecoveryInput in;
};

// Stresses are six numbers: xx yy zz xy yz zx. A measure of them, and its derivative by each; false: there is
// no measure of that name.
using Stress = std::array<double, 6>;
bool is_stress_measure(const std::string& name);
double stress_measure(const std::string& name, const Stress& stress);
Stress stress_weights(const std::string& name, const Stress& stress);

// The stencils of an effect, evaluated once more each by itself: gradients, Jacobians, and Hessians where
// these are wanted.
struct PoolAnswers {
  PoolAnswers(const System& system, const Assembly& assembly, Index pool, Want want, std::span<const Vec3> x);
  std::vector<double> energy, value;
  std::vector<Vec3> gradient, jacobian;
  std::vector<Mat3> hessian;
};

// Of World::energies(). Forces of loads on all nodes, and their work: sum f . (x - X).
std::vector<Vec3> load_forces(const SystemParts& parts, const State& state);
double work_on(std::span<const Vec3> force, std::span<const Vec3> x, std::span<const Vec3> rest);
// Of given multipliers and of rows with a law. Evaluates elsewhere and then at the state again.
double pressure_energy(const EquationsAt& where, const State& state);

}  // namespace isochor
