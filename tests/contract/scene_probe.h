// A scene of the registry, compiled, with a deformed sample state; and one of its pools, with slots to
// evaluate into.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstring>
#include <span>
#include <vector>

#include "contract/registry.h"
#include "support/compiled.h"

namespace test {

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

class SceneProbe {
 public:
  explicit SceneProbe(const SceneCase& c);

  const isochor::System& system() const { return *compiled_.system; }
  std::shared_ptr<const isochor::System> shared_system() const { return compiled_.system; }
  const std::vector<std::unique_ptr<isochor::EffectInstance>>& instances() const {
    return compiled_.instances;
  }
  const std::vector<isochor::Vec3>& rest() const { return compiled_.system->parts().rest; }
  // A deformed state inside the domain of every energy.
  const std::vector<isochor::Vec3>& x() const { return x_; }
  // Multipliers of the size of the shear modulus, without a pattern.
  std::vector<double> multipliers(std::size_t count) const;
  std::vector<isochor::Vec3> direction(unsigned seed) const;
  std::vector<isochor::Vec3> moved(std::span<const isochor::Vec3> d, double h) const;

 private:
  Compiled compiled_;
  std::vector<isochor::Vec3> x_;
};

// Slots of one pool, NaN until written.
struct Slots {
  explicit Slots(const isochor::StencilPool& pool);
  isochor::StencilSlots spans() { return {energy, value, gradient, jacobian, hessian}; }
  std::vector<double> energy, value;
  std::vector<isochor::Vec3> gradient, jacobian;
  std::vector<isochor::Mat3> hessian;
};
bool all_finite(const Slots& slots);

// Length of the increment that pools with a past are evaluated for; it began at rest.
inline constexpr double kProbeStep = 0.1;

class PoolProbe {
 public:
  PoolProbe(const isochor::StencilPool& pool, const SceneProbe& scene);

  const isochor::StencilPool& pool() const { return pool_; }
  const SceneProbe& scene() const { return scene_; }
  const std::vector<double>& multiplier() const { return multiplier_; }

  Slots evaluate(isochor::Want want, const std::vector<isochor::Vec3>& x) const;
  Slots evaluate(isochor::Want want, const std::vector<isochor::Vec3>& x,
                 const std::vector<double>& multiplier,
                 isochor::Definiteness definiteness = isochor::Definiteness::exact) const;
  // In ranges of `grain` stencils, last range first.
  Slots evaluate_split(const std::vector<isochor::Vec3>& x, isochor::Index grain) const;
  Slots evaluate_range(const std::vector<isochor::Vec3>& x, isochor::Index begin, isochor::Index end) const;
  // With what moves by itself where it is at time t.
  Slots evaluate_at(double t) const;
  // In an increment that begins at one place and ends at another.
  Slots evaluate_between(const std::vector<isochor::Vec3>& before, const std::vector<isochor::Vec3>& x) const;
  void evaluate_into(Slots& slots, isochor::Want want, isochor::Definiteness definiteness,
                     const std::vector<isochor::Vec3>& x) const;
  Eigen::MatrixXd dense_hessian(const Slots& slots, isochor::Index stencil) const;

 private:
  isochor::StencilRequest request(isochor::Want want, isochor::Definiteness definiteness,
                                  isochor::Index begin, isochor::Index end, std::span<const isochor::Vec3> x,
                                  std::span<const double> multiplier) const;
  const isochor::StencilPool& pool_;
  const SceneProbe& scene_;
  std::vector<double> multiplier_;
};

}  // namespace test
