// Fibers in all directions as families: a quadrature over half a sphere, cones about the direction of a
// family (Gauss points of the cosine from 0 to 1) with directions at equal angles on each.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/base.h"
#include "engine/base/text.h"
#include "engine/elements/fiber_law.h"
#include "isochor/fiber_fields.h"

namespace isochor {

namespace {

// Points and weights of Gauss and Legendre on [0, 1], by Newton's method on the polynomial.
std::vector<std::array<double, 2>> gauss_points(int n) {
  std::vector<std::array<double, 2>> out;
  for (int i = 0; i < n; ++i) {
    double x = std::cos(std::numbers::pi * (i + 0.75) / (n + 0.5)), slope = 1;
    for (int iteration = 0; iteration < 50; ++iteration) {
      double p = 1, before = 0;
      for (int k = 1; k <= n; ++k) {
        const double next = ((2 * k - 1) * x * p - (k - 1) * before) / k;
        before = p;
        p = next;
      }
      slope = n * (x * p - before) / (x * x - 1);
      const double step = p / slope;
      x -= step;
      if (std::abs(step) < 1e-15) break;
    }
    out.push_back({0.5 * (1 + x), 1 / ((1 - x * x) * slope * slope)});
  }
  return out;
}

// Two directions across a unit vector.
std::array<Vec3, 2> across(const Vec3& a) {
  const Vec3 other = std::abs(a.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 b = direction(cross(a, other));
  return {b, cross(a, b)};
}

}  // namespace

Result<std::vector<FiberFamily>> spread_fibers(const FiberFamily& family, const FiberSpread& spread) {
  if (!std::isfinite(spread.concentration) || std::abs(spread.concentration) > 100) {
    return Error{"spread.concentration = " + number(spread.concentration) +
                 "; give a number from -100 (across) over 0 (all alike) to 100 (along)"};
  }
  if (spread.rings < 1 || spread.rings > 64 || spread.around < 1 || spread.around > 128) {
    return Error{"spread.rings = " + std::to_string(spread.rings) + " and spread.around = " +
                 std::to_string(spread.around) + "; give 1 to 64 cones and 1 to 128 directions on each"};
  }
  if (family.dispersion != 0) {
    return Error{"dispersion = " + number(family.dispersion) +
                 " beside a spread, which is another way to say the same; give one"};
  }
  if (auto r = check_fibers("", family); !r) return r.failure();
  std::vector<double> share;
  double sum = 0;
  // The cosine squared goes off its largest value, so that the exponential stays within numbers.
  const double top = spread.concentration > 0 ? 1 : 0;
  const auto cones = gauss_points(spread.rings);
  for (const auto& [c, w] : cones) {
    share.push_back(w * std::exp(2 * spread.concentration * (c * c - top)));
    sum += share.back() * spread.around;
  }
  std::vector<FiberFamily> out;
  for (std::size_t ring = 0; ring < cones.size(); ++ring) {
    const double c = cones[ring][0], s = std::sqrt(1 - c * c);
    for (int k = 0; k < spread.around; ++k) {
      // Rings are turned against each other.
      const double turn = 2 * std::numbers::pi * (k + 0.5 * static_cast<double>(ring % 2)) / spread.around;
      const auto placed = [&](const Vec3& mean) {
        const Vec3 a = direction(mean);
        const auto [u, v] = across(a);
        return c * a + (s * std::cos(turn)) * u + (s * std::sin(turn)) * v;
      };
      FiberFamily one = family;
      one.k1 *= share[ring] / sum;
      one.straight_modulus *= share[ring] / sum;
      one.direction = placed(family.direction);
      std::transform(one.directions.begin(), one.directions.end(), one.directions.begin(), placed);
      out.push_back(std::move(one));
    }
  }
  return out;
}

}  // namespace isochor
