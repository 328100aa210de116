#include "engine/step/time_error.h"

#include <algorithm>
#include <cmath>

#include "engine/step/time_scheme.h"

namespace isochor {

// What is kept between increments: the last one's length and its suggestion, then velocities before it.

TimeError::TimeError(const StepContext& context) : context_(context), controls_(context.layout.error > 0) {
  if (controls_) before_ = context_.state;
}

double TimeError::suggested() {
  return context_.layout.of_error(context_.state.extra)[1];
}

void TimeError::begin() {
  if (controls_) before_ = context_.state;
}

// From velocities before and after the increment: that of the scheme's order, root mean square over the mass,
// relative to the scene's length. Infinity at the first increment of a second order scheme would forbid it,
// so that one is judged as of first order.
double TimeError::estimate(double h) {
  const State& state = context_.state;
  const System& system = context_.system();
  const TimeScheme& scheme = *context_.options.scheme;
  const auto memory = context_.layout.of_error(context_.state.extra);
  const double h_before = memory[0];
  const bool second = scheme.order() >= 2 && h_before > 0;
  double sum = 0, mass = 0;
  for (std::size_t i = 0; i < state.v.size(); ++i) {
    const Vec3 now = (1 / h) * (state.v[i] - before_.v[i]);
    Vec3 e = (0.5 * h * h) * now;
    if (second) {
      const Vec3 old{memory[2 + 3 * i], memory[3 + 3 * i], memory[4 + 3 * i]};
      const Vec3 then = (1 / h_before) * (before_.v[i] - old);
      e = (scheme.error_constant() * h * h * h / (0.5 * (h + h_before))) * (now - then);
    }
    const double m = system.parts().mass[i];
    sum += m * dot(e, e);
    mass += m;
  }
  return mass > 0 && system.length() > 0 ? std::sqrt(sum / mass) / system.length() : 0;
}

TimeError::Outcome TimeError::judge(double h) {
  constexpr double safety = 0.9, least = 0.2, most = 2;
  Outcome o;
  const double wanted = context_.options.time_error;
  o.error = estimate(h);
  const double power = context_.options.scheme->order() + 1.0;
  o.factor = o.error > 0 ? std::clamp(safety * std::pow(wanted / o.error, 1 / power), least, most) : most;
  o.too_large = o.error > wanted;
  return o;
}

void TimeError::keep(double h, double next) {
  const auto memory = context_.layout.of_error(context_.state.extra);
  memory[0] = h;
  memory[1] = next;
  for (std::size_t i = 0; i < before_.v.size(); ++i) {
    for (int k = 0; k < 3; ++k) memory[2 + 3 * i + static_cast<std::size_t>(k)] = before_.v[i][k];
  }
}

}  // namespace isochor
