// The amounts of all effects of a scene, in the order of the effects.
#pragma once

#include "engine/scene/builder.h"

namespace isochor {

class Amounts {
 public:
  explicit Amounts(const std::vector<std::unique_ptr<EffectInstance>>& instances) : instances_(instances) {}

  // Announces the increment [t0, t1] to those that a host has set.
  void begin(double t0, double t1) {
    for (const auto& instance : instances_) {
      if (Amount* a = instance->amount()) a->begin(t0, t1);
    }
  }
  // As numbers, and back.
  void save(std::vector<double>& all) const {
    for (const auto& instance : instances_) {
      if (const Amount* a = instance->amount()) a->save(all);
    }
  }
  void load(std::span<const double> all) {
    for (const auto& instance : instances_) {
      if (Amount* a = instance->amount()) a->load(all);
    }
  }
  // Whether numbers are amounts of these effects.
  bool fit(std::span<const double> all) const {
    for (const auto& instance : instances_) {
      if (instance->amount() && !Amount::take(all)) return false;
    }
    return all.empty();
  }

 private:
  const std::vector<std::unique_ptr<EffectInstance>>& instances_;
};

}  // namespace isochor
