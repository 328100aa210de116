#include "isochor/schemes.h"

#include "engine/time_scheme.h"

namespace isochor {

namespace {

// x is in equilibrium at every load factor; there is no inertia.
class Statics final : public TimeScheme {
 public:
  std::string_view name() const override { return "static"; }
  double mass_scale(double) const override { return 0; }
  void predict(const State& state, double, std::span<Vec3> predicted) const override {
    std::copy(state.x.begin(), state.x.end(), predicted.begin());
  }
  void finish(double h, std::span<const Vec3> x_new, State& state) const override {
    std::copy(x_new.begin(), x_new.end(), state.x.begin());
    state.t += h;
  }
};

// v_new = (x_new - x)/h and M (v_new - v)/h = forces at x_new: inertia 1/(2 h^2) |x_new - (x + h v)|^2.
class ImplicitEuler final : public TimeScheme {
 public:
  std::string_view name() const override { return "implicit_euler"; }
  double mass_scale(double h) const override { return 1 / (h * h); }
  void predict(const State& state, double h, std::span<Vec3> predicted) const override {
    for (std::size_t i = 0; i < state.x.size(); ++i) predicted[i] = state.x[i] + h * state.v[i];
  }
  void finish(double h, std::span<const Vec3> x_new, State& state) const override {
    for (std::size_t i = 0; i < state.x.size(); ++i) {
      state.v[i] = (1 / h) * (x_new[i] - state.x[i]);
      state.x[i] = x_new[i];
    }
    state.t += h;
  }
};

}  // namespace

SchemePtr statics() {
  return std::make_shared<Statics>();
}
SchemePtr implicit_euler() {
  return std::make_shared<ImplicitEuler>();
}

}  // namespace isochor
