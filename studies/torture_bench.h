// What the cases of the torture suite are made of.
#pragma once

#include <cmath>
#include <optional>

#include "isochor/contact.h"
#include "isochor/effects.h"
#include "isochor/generate.h"
#include "isochor/schemes.h"
#include "studies/torture.h"

namespace isochor::studies {

// A world under construction; the first refusal is kept and makes everything after it void.
class TortureBench {
 public:
  TortureBench(const TortureSettings& settings, WorldOptions options = {});

  bool ok() const { return refusal_.empty(); }
  const std::string& refusal() const { return refusal_; }
  World& world() { return *world_; }
  BodyId body() const { return body_; }

  // Jitters the nodes as the settings ask, gives the body its material and rows. Where the law does not live
  // through inversion, no state may have J <= 0.
  void add_body(Result<Mesh> mesh, const Result<MaterialPtr>& material, double density = 1000,
                bool lives_through_inversion = false);
  template <class Effect>
  std::optional<EffectId> add(Effect effect) {
    if (!ok()) return {};
    auto id = world_->add(std::move(effect));
    if (id) return id.value();
    refusal_ = id.error();
    return {};
  }
  std::optional<EffectId> hold(std::vector<std::string> surfaces, std::vector<Vec3> directions = {});

  // The whole load at once in statics; in dynamics over a tenth of a second, at most thirty steps of it.
  TortureResult run(bool equilibrium_exists);
  // `steps` steps of h in dynamics.
  TortureResult march(double h, int steps);
  // When the load is complete: 1 in statics, [s] in dynamics.
  double load_time() const { return settings_.step > 0 ? 0.1 : 1; }

 private:
  void take(const StepReport& report, TortureResult& out) const;
  TortureResult judge(TortureResult out, const StepReport& last, bool equilibrium_exists);
  TortureResult refused() const;

  TortureSettings settings_;
  std::string refusal_;
  std::optional<World> world_;
  BodyId body_{};
  bool lives_through_inversion_ = false;
};

// Constants by Young's modulus and the settings' Poisson's ratio.
ElasticConstants torture_constants(const TortureSettings& settings, double young);

// The same sequence on every platform: uniform in [-1, 1].
class TortureNoise {
 public:
  explicit TortureNoise(unsigned seed) : state_(0x9e3779b97f4a7c15ull * (seed + 1)) {}
  double next() {
    state_ ^= state_ << 13;
    state_ ^= state_ >> 7;
    state_ ^= state_ << 17;
    return static_cast<double>(state_ >> 11) / 4503599627370496.0 - 1;
  }

 private:
  std::uint64_t state_;
};

}  // namespace isochor::studies
