// Constants that the cases of materials have in common.
#pragma once

#include "isochor/materials.h"
#include "support/hyper_dual.h"

namespace test {

inline constexpr double kYoung = 2.6, kPoisson = 0.3;
inline constexpr double kMu = kYoung / (2 * (1 + kPoisson));
inline constexpr double kLambda = kYoung * kPoisson / ((1 + kPoisson) * (1 - 2 * kPoisson));
inline constexpr double kBulk = kLambda + 2 * kMu / 3;

inline isochor::MaterialPtr made(isochor::Result<isochor::MaterialPtr> result) {
  return std::move(result).value();
}

inline isochor::ElasticConstants constants() {
  isochor::ElasticConstants c;
  c.young = kYoung;
  c.poisson = kPoisson;
  return c;
}

inline HyperDual square(const HyperDual& v) {
  return v * v;
}

}  // namespace test
