// Numbers that a user writes as a formula of position and time.
#pragma once

#include <string>
#include <vector>

#include "isochor/types.h"

namespace isochor {

// Parsed once, evaluated often, by many threads at a time and without allocation.
class Expression {
 public:
  // Numbers, x, y, z, t, pi, + - * / ^, brackets and the functions that TractionDef::profile lists. The error
  // is the end of a sentence that names the place, counted from 1.
  static Result<Expression> parse(const std::string& text);

  double operator()(const Vec3& x, double t) const;
  bool depends_on_time() const;

  // What is done in turn, to a stack of numbers. The functions are those of the C++ library.
  enum class Do : std::uint8_t {
    number,
    x,
    y,
    z,
    t,
    add,
    subtract,
    multiply,
    divide,
    power,
    negate,
    abs,
    sqrt,
    exp,
    log,
    sin,
    cos,
    tan,
    tanh,
    step,
    atan2,
    min,
    max,
  };
  struct Action {
    Do what = Do::number;
    double number = 0;
  };

 private:
  std::vector<Action> actions_;
};

}  // namespace isochor
