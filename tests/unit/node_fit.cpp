// Values at nodes from points around them.
#include "engine/world/node_fit.h"

#include <cmath>
#include <random>

#include "catch.h"

using isochor::Index;
using isochor::NodeFit;
using isochor::Vec3;

namespace {

constexpr double kSizes[] = {1e-6, 1, 1e6};

NodeFit<2>::Values pair(double a, double b) {
  NodeFit<2>::Values v;
  v << a, b;
  return v;
}

}  // namespace

TEST_CASE("where points leave a direction open, a constant is a constant") {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(-1, 1);
  for (const double size : kSizes) {
    for (int dimensions = 0; dimensions <= 3; ++dimensions) {
      for (int count = 1; count <= 6; ++count) {
        CAPTURE(size, dimensions, count);
        const std::vector<Vec3> node{{0.3 * size, -0.1 * size, 0.7 * size}};
        NodeFit<2> fit(node);
        const Vec3 start{0.31, 0.17, -0.23};
        for (int k = 0; k < count; ++k) {
          Vec3 d = start;
          if (dimensions > 0) d.x += any(random);
          if (dimensions > 1) d.y += any(random);
          if (dimensions > 2) d.z += any(random);
          fit.add(0, node[0] + size * d, std::abs(any(random)) + 0.1, pair(7e5, -3));
        }
        CHECK(fit.value(0)(0) == Approx(7e5).epsilon(1e-6));
        CHECK(fit.value(0)(1) == Approx(-3).epsilon(1e-6));
      }
    }
  }
}

TEST_CASE("linear fields are found again where points surround a node") {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> any(-1, 1);
  for (const double size : kSizes) {
    CAPTURE(size);
    const std::vector<Vec3> node{{0.3 * size, -0.1 * size, 0.7 * size}};
    const auto value = [&](const Vec3& x) {
      const Vec3 y = (1 / size) * x;
      return pair(2 + 3 * y.x - y.y + 0.5 * y.z, y.z);
    };
    NodeFit<2> fit(node);
    for (int k = 0; k < 12; ++k) {
      const Vec3 x = node[0] + size * Vec3{any(random), any(random), any(random)};
      fit.add(0, x, std::abs(any(random)) + 0.1, value(x));
    }
    CHECK(fit.value(0)(0) == Approx(value(node[0])(0)).epsilon(1e-5));
    CHECK(fit.value(0)(1) == Approx(value(node[0])(1)).epsilon(1e-5));
  }
}
