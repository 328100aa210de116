// Elementary functions of lanes against those of the standard library.
#include "engine/math/lane_functions.h"

#include <random>

#include "catch.h"

using namespace isochor;

namespace {

// Largest error in units of the last place of the exact value, or of `floor` where that is larger.
template <class Ours, class Theirs>
double worst(double low, double high, bool logarithmic, Ours ours, Theirs theirs) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  double worst = 0;
  for (int i = 0; i < 20000; ++i) {
    Lanes v;
    for (int l = 0; l < kLanes; ++l) {
      const double t = unit(random);
      v[l] = logarithmic ? std::exp(std::log(low) + t * (std::log(high) - std::log(low)))
                         : low + t * (high - low);
    }
    const Lanes r = ours(v);
    for (int l = 0; l < kLanes; ++l) {
      const double exact = theirs(v[l]);
      worst = std::max(worst, std::abs(r[l] - exact) / (std::abs(exact) * 0x1p-53));
    }
  }
  return worst;
}

}  // namespace

TEST_CASE("functions of lanes agree with the standard library to a few units in the last place") {
  const auto log_1 = [](double v) { return std::log(v); };
  const auto our_log = [](const Lanes& v) { return log(v); };
  CHECK(worst(1e-300, 1e300, true, our_log, log_1) < 4);
  CHECK(worst(0.5, 2, false, our_log, log_1) < 4);
  CHECK(worst(
            -700, 700, false, [](const Lanes& v) { return exp(v); }, [](double v) { return std::exp(v); }) <
        4);
  CHECK(worst(
            -3, 3, false, [](const Lanes& v) { return expm1(v); }, [](double v) { return std::expm1(v); }) <
        6);
  CHECK(worst(
            1e-12, 1, true, [](const Lanes& v) { return expm1(v); }, [](double v) { return std::expm1(v); }) <
        6);
  CHECK(worst(
            1e-12, 10, true, [](const Lanes& v) { return log1p(v); },
            [](double v) { return std::log1p(v); }) < 6);
  CHECK(worst(
            1e-9, 0.9, true, [](const Lanes& v) { return log1p(-v); },
            [](double v) { return std::log1p(-v); }) < 8);
}

TEST_CASE("functions of lanes are exact at rest and say where they have no value") {
  CHECK(log(broadcast(1))[0] == 0);
  CHECK(exp(broadcast(0))[0] == 1);
  CHECK(expm1(broadcast(0))[0] == 0);
  CHECK(log1p(broadcast(0))[0] == 0);
  for (const double v : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    CHECK(std::isnan(log(broadcast(v))[0]));
  }
  CHECK(std::isinf(exp(broadcast(710))[0]));
  CHECK(std::isnan(exp(broadcast(std::nan("")))[0]));
  CHECK(std::abs(exp(broadcast(-800))[0]) < 1e-15);
}
