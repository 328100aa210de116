// W = sum over i = 1 ... 5 of mu beta_(i-1)/(2 i) (I^i - 3^i) [Pa] with beta_0 = 1: the series of Arruda &
// Boyce 1993.
#include <array>
#include <cmath>

#include "engine/base/text.h"
#include "materials/native_constants.h"
#include "materials/strain_law.h"

namespace isochor {

namespace {

struct ArrudaBoyceStrain {
  static constexpr bool kSecond = false;
  double mu = 0;                 // [Pa]
  std::array<double, 5> beta{};  // beta_0 = 1
  StrainPartBatch operator()(const Lanes& I, const Lanes&) const {
    StrainPartBatch w;
    // I^i - 3^i by its factor I - 3, which keeps the digits near rest: I^(i-1) + 3 I^(i-2) + ... + 3^(i-1).
    Lanes quotient = broadcast(1), power = broadcast(1), sum = {}, slope = {};
    double three = 1;
    for (std::size_t i = 0; i < 5; ++i) {
      const double b = beta[i];
      sum += b / (2 * (static_cast<double>(i) + 1)) * quotient;
      w.d1 += 0.5 * b * power;
      if (i + 1 < 5) slope += 0.5 * beta[i + 1] * (static_cast<double>(i) + 1) * power;
      power *= I;
      three *= 3;
      quotient = quotient * I + three;
    }
    w.value = mu * (I - 3) * sum;
    w.d1 = mu * w.d1;
    w.d11 = mu * slope;
    return w;
  }
};

Result<std::array<double, 5>> betas(std::string_view name, const ArrudaBoyceConstants& c) {
  const double given[] = {c.beta1, c.beta2, c.beta3, c.beta4};
  constexpr const char* keys[] = {"beta1", "beta2", "beta3", "beta4"};
  std::array<double, 5> beta{1, 0, 0, 0, 0};
  for (std::size_t i = 0; i < 4; ++i) {
    if (auto r = not_negative(name, keys[i], given[i]); !r) return r.failure();
    beta[i + 1] = given[i];
    if (given[i] != 0 && c.locking_stretch != 0) {
      return Error{std::string(name) + ": both " + keys[i] + " = " + number(given[i]) +
                   " and locking_stretch = " + number(c.locking_stretch) +
                   " are given; give the series or the stretch that it follows from"};
    }
  }
  if (c.locking_stretch == 0) return beta;
  if (!(c.locking_stretch > 0) || !std::isfinite(c.locking_stretch)) {
    return Error{std::string(name) + ": locking_stretch = " + number(c.locking_stretch) +
                 "; the stretch at which chains are straight must be a positive number, sqrt(N) for N links"};
  }
  const double n = c.locking_stretch * c.locking_stretch;
  return std::array<double, 5>{1, 1 / (5 * n), 11 / (175 * n * n), 19 / (875 * n * n * n),
                               519 / (67375 * n * n * n * n)};
}

Result<MaterialPtr> make(std::string_view name, const ArrudaBoyceConstants& c, bool isochoric) {
  if (auto r = not_negative(name, "mu", c.mu); !r) return r.failure();
  auto beta = betas(name, c);
  if (!beta) return beta.failure();
  return strain_model(
      {name, "mu (1 + 3 beta1 + 9 beta2 + 27 beta3 + 81 beta4)", c.poisson, c.volume, isochoric},
      ArrudaBoyceStrain{c.mu, beta.value()}, Stability::known);
}

}  // namespace

Result<MaterialPtr> arruda_boyce(const ArrudaBoyceConstants& constants) {
  return make("arruda_boyce", constants, false);
}

Result<MaterialPtr> isochoric_arruda_boyce(const ArrudaBoyceConstants& constants) {
  return make("isochoric_arruda_boyce", constants, true);
}

}  // namespace isochor
