// A program with an effect, a material and a time scheme of its own: a bar of its material swings under its
// scheme while the tendon of docs/adding-a-constraint.md bends it. Links isochor::extend.
#include <isochor/generate.h>
#include <isochor/world.h>

#include <cmath>
#include <cstdio>

#include "engine/elements/material_model.h"
#include "engine/step/time_scheme.h"
#include "materials/energy_batch.h"
#include "tendon.h"

using namespace isochor;

namespace {

// psi = mu/2 (I - 3) - mu (J - 1) + shift/2 (J - 1)^2 [Pa] of I = tr F^T F and J = det F: Lame's parameters
// at small strain are mu and shift - mu.
struct RubberEnergy {
  double mu, shift;  // [Pa]
  InvariantResponse operator()(double I, double J) const {
    InvariantResponse r;
    r.psi = 0.5 * mu * (I - 3) - mu * (J - 1) + 0.5 * shift * (J - 1) * (J - 1);
    r.I = 0.5 * mu;
    r.J = shift * (J - 1) - mu;
    r.JJ = shift;
    return r;
  }
};

class Rubber final : public MaterialModel {
 public:
  Rubber(double mu, double lambda) : mu_(mu), lambda_(lambda) {}  // [Pa]
  std::string_view name() const override { return "rubber"; }
  std::shared_ptr<const Material> distortional() const override { return energy(0); }
  Result<std::shared_ptr<const Material>> complete() const override { return energy(mu_ + lambda_); }
  double shear_modulus() const override { return mu_; }
  double inverse_bulk() const override { return 1 / (mu_ + lambda_); }
  double poisson() const override { return 0.5 * lambda_ / (lambda_ + mu_); }
  double young() const override { return 2 * mu_ * (1 + poisson()); }
  bool defined_inverted() const override { return true; }

 private:
  std::shared_ptr<const Material> energy(double shift) const {
    return std::make_shared<InvariantMaterial<RubberEnergy>>("rubber", RubberEnergy{mu_, shift});
  }
  double mu_, lambda_;
};

// Implicit Euler in air that takes the same share of every velocity: v loses exp(-rate h) a step.
class EulerInAir final : public TimeScheme {
 public:
  explicit EulerInAir(double rate) : rate_(rate) {}  // [1/s]
  std::string_view name() const override { return "euler_in_air"; }
  void describe(Fingerprint& f) const override { f.add(name(), rate_); }
  int order() const override { return 1; }
  double error_constant() const override { return 0.5; }
  double begin(const State& state, std::span<const double>, double h,
               std::span<Vec3> predicted) const override {
    for (std::size_t i = 0; i < state.x.size(); ++i) predicted[i] = state.x[i] + h * state.v[i];
    return 1 / (h * h);
  }
  void finish(double h, std::span<const Vec3> x_new, std::span<const Vec3>, State& state,
              std::span<double>) const override {
    const double left = std::exp(-rate_ * h);
    for (std::size_t i = 0; i < state.x.size(); ++i) {
      state.v[i] = (left / h) * (x_new[i] - state.x[i]);
      state.x[i] = x_new[i];
    }
    state.t += h;
  }

 private:
  double rate_;
};

int refused(const std::string& why) {
  std::fprintf(stderr, "%s\n", why.c_str());
  return 2;
}

}  // namespace

int main() {
  WorldOptions options;
  options.scheme = std::make_shared<EulerInAir>(20.0);
  auto made = World::create(options);
  if (!made) return refused(made.error());
  World world = std::move(made).value();

  BodyDef bar;
  bar.mesh = box_mesh({{0, 0, 0}, {1, 0.2, 0.2}, {10, 2, 2}}).value();
  bar.materials = {{"", std::make_shared<Rubber>(3.5e4, 5e4), 1000}};
  const auto body = world.add_body(std::move(bar));
  if (!body) return refused(body.error());
  DirichletDef wall;
  wall.where.surfaces = {"x0"};
  if (const auto r = world.add(dirichlet(wall)); !r) return refused(r.error());
  TendonDef def;  // along the lower side, pulled in by 5 cm within a tenth of a second
  for (int i = 0; i <= 10; ++i) def.points.push_back({0.1 * i, 0.1, 0});
  def.stiffness = 2000;
  def.amount = Curve::ramp(0.05, 0.1);
  if (const auto r = world.add(tendon(def)); !r) return refused(r.error());

  for (int step = 0; step < 60; ++step) {
    const StepReport report = world.advance(0.02);
    if (report.status != StepStatus::converged) return refused(report.reason);
  }
  double tip = 0, tension = 0;
  const auto x = world.positions(body.value()), rest = world.rest_positions(body.value());
  for (std::size_t i = 0; i < x.size(); ++i) tip = std::min(tip, x[i].z - rest[i].z);
  for (const Gauge& g : world.gauges()) {
    if (g.quantity == "tension") tension = g.value;
  }
  std::printf("at %.2f s the tip is %.1f cm down, the tendon pulls with %.1f N\n", world.time(), -100 * tip,
              tension);
  // The row of the tendon is met: what it is longer than it should be, times its stiffness.
  double length = -1 + 0.05;
  for (int i = 0; i < 10; ++i) {
    Vec3 a{}, b{};
    for (std::size_t k = 0; k < rest.size(); ++k) {
      if (rest[k].y == 0.1 && rest[k].z == 0 && std::abs(rest[k].x - 0.1 * i) < 1e-9) a = x[k];
      if (rest[k].y == 0.1 && rest[k].z == 0 && std::abs(rest[k].x - 0.1 * (i + 1)) < 1e-9) b = x[k];
    }
    length += std::sqrt(dot(b - a, b - a));
  }
  return tip < -0.03 && std::abs(tension - 2000 * length) < 1e-3 * tension ? 0 : 1;
}
