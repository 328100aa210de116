// Formulas of position and time: random ones against the same tree evaluated here, and what is refused.
#include "engine/math/expression.h"

#include <cmath>
#include <numbers>
#include <random>

#include "catch.h"

using isochor::Expression;
using isochor::Vec3;

namespace {

struct Written {
  std::string text;
  double value = 0;
};

// A random formula as text with all its brackets, and its value.
class Writer {
 public:
  Writer(unsigned seed, const Vec3& x, double t) : random_(seed), x_(x), t_(t) {}

  Written any(int depth) {
    if (depth == 0) return leaf();
    switch (pick(6)) {
      case 0: {
        const Written a = any(depth - 1), b = any(depth - 1);
        return {"(" + a.text + " + " + b.text + ")", a.value + b.value};
      }
      case 1: {
        const Written a = any(depth - 1), b = any(depth - 1);
        return {"(" + a.text + "-" + b.text + ")", a.value - b.value};
      }
      case 2: {
        const Written a = any(depth - 1), b = any(depth - 1);
        return {a.text + " *" + b.text, a.value * b.value};
      }
      case 3: {
        const Written a = any(depth - 1), b = any(depth - 1);
        return {"max(" + a.text + ", " + b.text + ")", std::max(a.value, b.value)};
      }
      case 4: {
        const Written a = any(depth - 1);
        return {"sin( " + a.text + ")", std::sin(a.value)};
      }
      default: {
        const Written a = any(depth - 1);
        return {"(-" + a.text + ")", -a.value};
      }
    }
  }

 private:
  int pick(int n) { return std::uniform_int_distribution<int>(0, n - 1)(random_); }
  Written leaf() {
    switch (pick(6)) {
      case 0:
        return {"x", x_.x};
      case 1:
        return {"y", x_.y};
      case 2:
        return {" z", x_.z};
      case 3:
        return {"t", t_};
      case 4:
        return {"pi", std::numbers::pi};
      default:
        return {"1.25e-1", 0.125};
    }
  }

  std::mt19937 random_;
  Vec3 x_;
  double t_;
};

double value(const std::string& text, const Vec3& x = {}, double t = 0) {
  const auto made = Expression::parse(text);
  INFO(text);
  if (!made) FAIL(made.error());
  return made.value()(x, t);
}

std::string refusal(const std::string& text) {
  const auto made = Expression::parse(text);
  INFO(text);
  REQUIRE(!made);
  return made.error();
}

}  // namespace

TEST_CASE("random formulas have the value of what they say", "[unit]") {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (unsigned seed = 1; seed <= 300; ++seed) {
    const Vec3 x{unit(random), unit(random), unit(random)};
    const double t = 3 * unit(random);
    const Written w = Writer(seed, x, t).any(1 + static_cast<int>(seed % 6));
    INFO(w.text);
    CHECK(value(w.text, x, t) == Approx(w.value).margin(1e-12).epsilon(1e-13));
  }
}

TEST_CASE("what binds stronger comes first", "[unit]") {
  CHECK(value("1 + 2*3^2/2 - 4") == 6);
  CHECK(value("-2^2") == -4);
  CHECK(value("2^-1") == 0.5);
  CHECK(value("2^3^2") == 512);
  CHECK(value("8 - 4 - 2") == 2);
  CHECK(value("8/4/2") == 1);
  CHECK(value("--3 + +1") == 4);
  CHECK(value("step(x)*2 + step(y)", {0, -1e-9, 0}) == 2);
  CHECK(value("atan2(y, x)", {-1, 0, 0}) == Approx(std::numbers::pi));
  CHECK(value("min(abs(-3), sqrt(16)) + exp(0) + log(1) + cos(0) + tan(0) + tanh(0)") == 5);
  CHECK(Expression::parse("x + sin(t)").value().depends_on_time());
  CHECK_FALSE(Expression::parse("x*tan(y)").value().depends_on_time());
}

TEST_CASE("formulas that say nothing are refused with the place", "[unit]") {
  CHECK(refusal("") == "expected a number, x, y, z, t, a function or a bracket at character 1");
  CHECK(refusal("1 +").find("at character 4") != std::string::npos);
  CHECK(refusal("(x").find("expected \")\" at character 3") != std::string::npos);
  CHECK(refusal("2 x").find("expected an operator or the end at character 3") != std::string::npos);
  CHECK(refusal("r^2").find("\"r\" is not known") != std::string::npos);
  CHECK(refusal("sin x").find("expected \"(\" after sin") != std::string::npos);
  CHECK(refusal("max(1)").find("max takes two arguments") != std::string::npos);
  CHECK(refusal("sin(1, 2)").find("expected \")\"") != std::string::npos);
  CHECK(refusal(".").find("expected a number") != std::string::npos);
  CHECK(refusal(std::string("x\0y", 3)).find("the end at character 2") != std::string::npos);
  CHECK(refusal("1 $ 2").find("character 3") != std::string::npos);
  CHECK(refusal(std::string(1000, '(')).find("nested too deeply") != std::string::npos);
  CHECK(refusal(std::string(1000, '-') + "1").find("nested too deeply") != std::string::npos);
  std::string deep = "1";
  for (int i = 0; i < 60; ++i) deep = "1+(" + deep + ")";
  CHECK(refusal(deep).find("nested too deeply") != std::string::npos);
}
