#include "isochor/schemes.h"

#include <algorithm>
#include <cmath>

#include "engine/step/time_scheme.h"

namespace isochor {

namespace {

// x is in equilibrium at every load factor; there is no inertia.
class Statics : public TimeScheme {
 public:
  std::string_view name() const override { return "static"; }
  bool has_inertia() const override { return false; }
  double begin(const State& state, std::span<const double>, double,
               std::span<Vec3> predicted) const override {
    std::copy(state.x.begin(), state.x.end(), predicted.begin());
    return 0;
  }
  void finish(double h, std::span<const Vec3> x_new, std::span<const Vec3>, State& state,
              std::span<double>) const override {
    std::copy(x_new.begin(), x_new.end(), state.x.begin());
    state.t += h;
  }
};

// Statics that can trace its path. Memory: the last step, three numbers a node, then its load factor.
class Continuation final : public Statics {
 public:
  std::string_view name() const override { return "continuation"; }
  bool follows_paths() const override { return true; }
  SchemeMemory memory() const override { return {.vectors = 1, .after = 1}; }
  void finish(double h, std::span<const Vec3> x_new, std::span<const Vec3> predicted, State& state,
              std::span<double> memory) const override {
    for (std::size_t i = 0; i < x_new.size(); ++i) {
      const Vec3 d = x_new[i] - state.x[i];
      for (int k = 0; k < 3; ++k) memory[3 * i + static_cast<std::size_t>(k)] = d[k];
    }
    memory.back() = h;
    Statics::finish(h, x_new, predicted, state, memory);
  }
};

// v_new = (x_new - x)/h and M (v_new - v)/h = forces at x_new: inertia 1/(2 h^2) |x_new - (x + h v)|^2.
double begin_euler(const State& state, double h, std::span<Vec3> predicted) {
  for (std::size_t i = 0; i < state.x.size(); ++i) predicted[i] = state.x[i] + h * state.v[i];
  return 1 / (h * h);
}
void finish_euler(double h, std::span<const Vec3> x_new, State& state) {
  for (std::size_t i = 0; i < state.x.size(); ++i) {
    state.v[i] = (1 / h) * (x_new[i] - state.x[i]);
    state.x[i] = x_new[i];
  }
  state.t += h;
}

class ImplicitEuler final : public TimeScheme {
 public:
  std::string_view name() const override { return "implicit_euler"; }
  int order() const override { return 1; }
  double error_constant() const override { return 0.5; }
  double largest_energy_gain() const override { return 1e-3; }
  double begin(const State& state, std::span<const double>, double h,
               std::span<Vec3> predicted) const override {
    return begin_euler(state, h, predicted);
  }
  void finish(double h, std::span<const Vec3> x_new, std::span<const Vec3>, State& state,
              std::span<double>) const override {
    finish_euler(h, x_new, state);
  }
};

// M 2 (v_mid - v)/h = forces at x_mid, x_mid = x + h/2 v_mid; then x_new and v_new by extrapolation through
// the middle (Simo & Tarnow 1992 discuss it beside their conserving variant).
class ImplicitMidpoint final : public TimeScheme {
 public:
  std::string_view name() const override { return "implicit_midpoint"; }
  double evaluated_at() const override { return 0.5; }
  double begin(const State& state, std::span<const double>, double h,
               std::span<Vec3> predicted) const override {
    for (std::size_t i = 0; i < state.x.size(); ++i) predicted[i] = state.x[i] + 0.5 * h * state.v[i];
    return 4 / (h * h);
  }
  void finish(double h, std::span<const Vec3> x_mid, std::span<const Vec3>, State& state,
              std::span<double>) const override {
    for (std::size_t i = 0; i < state.x.size(); ++i) {
      const Vec3 step = 2 * (x_mid[i] - state.x[i]);
      state.x[i] += step;
      state.v[i] = (2 / h) * step - state.v[i];
    }
    state.t += h;
  }
};

Vec3 kept_vector(std::span<const double> memory, std::size_t i) {
  return {memory[3 * i], memory[3 * i + 1], memory[3 * i + 2]};
}
void keep(std::span<double> memory, std::size_t i, const Vec3& v) {
  memory[3 * i] = v.x;
  memory[3 * i + 1] = v.y;
  memory[3 * i + 2] = v.z;
}

// h dy/dt = a y_new + b y + c y_old for a step h after one of length h_old (Hairer, Norsett & Wanner, III.5),
// used for positions and for velocities. Memory: h_old (0: no past), then old positions, then old velocities.
class Bdf2 final : public TimeScheme {
 public:
  std::string_view name() const override { return "bdf2"; }
  double error_constant() const override { return 2.0 / 9; }
  double largest_energy_gain() const override { return 0.01; }
  SchemeMemory memory() const override {
    return {.before = 1,
            .vectors = 2,
            .starts = {SchemeMemory::Starts::position, SchemeMemory::Starts::velocity}};
  }
  double begin(const State& state, std::span<const double> memory, double h,
               std::span<Vec3> predicted) const override {
    if (!(memory[0] > 0)) return begin_euler(state, h, predicted);
    const Weights w(h, memory[0]);
    const auto old_x = memory.subspan(1), old_v = memory.subspan(1 + 3 * state.x.size());
    for (std::size_t i = 0; i < state.x.size(); ++i) {
      predicted[i] = (-1 / w.a) * (w.b * state.x[i] + w.c * kept_vector(old_x, i)) -
                     (1 / (w.a * w.a)) * (w.b * state.v[i] + w.c * kept_vector(old_v, i));
    }
    return w.a * w.a;
  }
  void finish(double h, std::span<const Vec3> x_new, std::span<const Vec3>, State& state,
              std::span<double> memory) const override {
    const double h_old = memory[0];
    const auto old_x = memory.subspan(1), old_v = memory.subspan(1 + 3 * state.x.size());
    const Weights w(h, h_old > 0 ? h_old : h);
    for (std::size_t i = 0; i < state.x.size(); ++i) {
      const Vec3 v_new = h_old > 0 ? w.a * x_new[i] + w.b * state.x[i] + w.c * kept_vector(old_x, i)
                                   : (1 / h) * (x_new[i] - state.x[i]);
      keep(old_x, i, state.x[i]);
      keep(old_v, i, state.v[i]);
      state.x[i] = x_new[i];
      state.v[i] = v_new;
    }
    memory[0] = h;
    state.t += h;
  }

 private:
  struct Weights {
    double a, b, c;
    Weights(double h, double h_old) {
      const double w = h / h_old;
      a = (1 + 2 * w) / (1 + w) / h;
      b = -(1 + w) / h;
      c = w * w / (1 + w) / h;
    }
  };
};

// Chung & Hulbert 1993 as Arnold & Bruels 2007 write it, with an acceleration-like variable a beside the true
// acceleration q: (1 - am) a_new + am a = (1 - af) q_new + af q, M q_new = forces at x_new,
//   x_new = x + h v + h^2 ((1/2 - beta) a + beta a_new),  v_new = v + h ((1 - gamma) a + gamma a_new).
// Solved for q_new it is affine in x_new: q_new = s (x_new - predicted). Memory: 1 when there is a past, then
// a, then q.
class GeneralizedAlpha final : public TimeScheme {
 public:
  GeneralizedAlpha(std::string_view name, double am, double af)
      : name_(name), am_(am), af_(af), gamma_(0.5 - am + af), beta_(0.25 * (1 - am + af) * (1 - am + af)) {}
  std::string_view name() const override { return name_; }
  void describe(Fingerprint& f) const override { f.add(name_, am_, af_); }
  SchemeMemory memory() const override { return {.before = 1, .vectors = 2}; }
  double begin(const State& state, std::span<const double> memory, double h,
               std::span<Vec3> predicted) const override {
    if (memory[0] == 0) return begin_euler(state, h, predicted);
    const double s = scale(h);
    const auto a = memory.subspan(1), q = memory.subspan(1 + 3 * state.x.size());
    for (std::size_t i = 0; i < state.x.size(); ++i) {
      const Vec3 a_i = kept_vector(a, i);
      predicted[i] = state.x[i] + h * state.v[i] + (h * h * (0.5 - beta_)) * a_i -
                     (1 / ((1 - af_) * s)) * (am_ * a_i - af_ * kept_vector(q, i));
    }
    return s;
  }
  void finish(double h, std::span<const Vec3> x_new, std::span<const Vec3> predicted, State& state,
              std::span<double> memory) const override {
    const bool past = memory[0] != 0;
    const auto a = memory.subspan(1), q = memory.subspan(1 + 3 * state.x.size());
    const double s = past ? scale(h) : 1 / (h * h);
    for (std::size_t i = 0; i < state.x.size(); ++i) {
      const Vec3 q_new = s * (x_new[i] - predicted[i]);
      Vec3 a_new = q_new;
      if (past) {
        const Vec3 a_old = kept_vector(a, i);
        a_new = (1 / (beta_ * h * h)) *
                (x_new[i] - state.x[i] - h * state.v[i] - (h * h * (0.5 - beta_)) * a_old);
        state.v[i] = state.v[i] + h * ((1 - gamma_) * a_old + gamma_ * a_new);
      } else {
        state.v[i] = (1 / h) * (x_new[i] - state.x[i]);
      }
      state.x[i] = x_new[i];
      keep(a, i, a_new);
      keep(q, i, q_new);
    }
    memory[0] = 1;
    state.t += h;
  }

 private:
  double scale(double h) const { return (1 - am_) / ((1 - af_) * beta_ * h * h); }

  std::string_view name_;
  double am_, af_, gamma_, beta_;
};

// Equilibria up to a time, then a scheme of dynamics from rest.
class StaticUntil final : public TimeScheme {
 public:
  StaticUntil(double time, SchemePtr then)
      : time_(time), then_(std::move(then)), name_("static, then " + std::string(then_->name())) {}
  std::string_view name() const override { return name_; }
  void describe(Fingerprint& f) const override { f.add(name(), time_, then_); }
  int order() const override { return then_->order(); }
  double error_constant() const override { return then_->error_constant(); }
  double largest_energy_gain() const override { return then_->largest_energy_gain(); }
  SchemeMemory memory() const override { return then_->memory(); }
  double begin(const State& state, std::span<const double> memory, double h,
               std::span<Vec3> predicted) const override {
    return rests(state, h) ? statics_.begin(state, memory, h, predicted)
                           : then_->begin(state, memory, h, predicted);
  }
  void finish(double h, std::span<const Vec3> x_new, std::span<const Vec3> predicted, State& state,
              std::span<double> memory) const override {
    if (!rests(state, h)) return then_->finish(h, x_new, predicted, state, memory);
    statics_.finish(h, x_new, predicted, state, memory);
    std::fill(state.v.begin(), state.v.end(), Vec3{});
    std::fill(memory.begin(), memory.end(), 0.0);
  }

 private:
  // Increments that begin before the time, but for rounding.
  bool rests(const State& state, double h) const { return state.t + 1e-6 * h < time_; }

  double time_;
  SchemePtr then_;
  std::string name_;
  Statics statics_;
};

}  // namespace

SchemePtr statics() {
  return std::make_shared<Statics>();
}
SchemePtr continuation() {
  return std::make_shared<Continuation>();
}
SchemePtr implicit_midpoint() {
  return std::make_shared<ImplicitMidpoint>();
}
SchemePtr implicit_euler() {
  return std::make_shared<ImplicitEuler>();
}
SchemePtr bdf2() {
  return std::make_shared<Bdf2>();
}
SchemePtr generalized_alpha(double spectral_radius) {
  if (!(spectral_radius >= 0 && spectral_radius <= 1)) return nullptr;
  return std::make_shared<GeneralizedAlpha>("generalized_alpha",
                                            (2 * spectral_radius - 1) / (spectral_radius + 1),
                                            spectral_radius / (spectral_radius + 1));
}
SchemePtr newmark() {
  return std::make_shared<GeneralizedAlpha>("newmark", 0, 0);
}

SchemePtr static_until(double time, SchemePtr then) {
  if (!(time > 0) || !std::isfinite(time) || !then || !then->has_inertia() || then->evaluated_at() != 1)
    return nullptr;
  return std::make_shared<StaticUntil>(time, std::move(then));
}

}  // namespace isochor
