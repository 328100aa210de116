// Newton's method for stresses that are no derivative of an energy: for comparison runs only. There is no
// merit function; a step is halved a few times while the residual grows, and then taken as it is.
#pragma once

#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "engine/elements/material_model.h"
#include "engine/scene/builder.h"
#include "engine/solve/kkt/kkt.h"
#include "engine/solvers/linear_solver.h"
#include "engine/world/recovery.h"
#include "isochor/effects/effect.h"

namespace residual_newton {

using namespace isochor;

// A stress, and eigenvalues of a symmetric tangent near its own.
class StressOnly : public Material {
 public:
  virtual void stress(const Lanes F[9], Lanes P[9]) const = 0;
  void describe(Fingerprint& f) const override { f.add(name()); }
  void evaluate(Want want, const PointBatch& points, ResponseBatch& r) const override {
    store(broadcast(0), r.psi);
    if (want == Want::value) return;
    Lanes F[9], P[9];
    for (int i = 0; i < 9; ++i) F[i] = load(points.F[i]);
    stress(F, P);
    for (int i = 0; i < 9; ++i) store(P[i], r.P[i]);
    if (want != Want::hessian) return;
    Svd3 svd;
    svd3(F, svd);
    Spectrum s;
    spectrum(points, svd, s);
    Lanes A[45];
    assemble(svd, s, A);
    for (int i = 0; i < 45; ++i) store(A[i], r.A[i]);
  }
};

class Model final : public MaterialModel {
 public:
  explicit Model(std::shared_ptr<const Material> material) : material_(std::move(material)) {}
  std::string_view name() const override { return material_->name(); }
  std::shared_ptr<const Material> distortional() const override { return material_; }
  Result<std::shared_ptr<const Material>> complete() const override { return material_; }
  double shear_modulus() const override { return 1; }
  double inverse_bulk() const override { return 1; }
  double poisson() const override { return 0; }
  double young() const override { return 2; }
  bool defined_inverted() const override { return true; }

 private:
  std::shared_ptr<const Material> material_;
};

class Solver {
 public:
  Solver(Mesh mesh, std::shared_ptr<const Material> material, const std::vector<EffectPtr>& supports) {
    BodyDef def;
    def.mesh = std::move(mesh);
    def.element = Element::hex8;
    def.materials = {{"", std::make_shared<Model>(std::move(material)), 1}};
    need(builder_.add_body(def));
    for (const EffectPtr& e : supports) need(e->declare(builder_));
    need(builder_.build_solids());
    for (const EffectPtr& e : supports) instances_.push_back(need(e->build(builder_)));
    system_ = need(System::compile(need(builder_.finish(true))));
    assembly_ = std::make_unique<Assembly>(system_, parallel_);
    kkt_ = std::make_unique<Kkt>(system_, parallel_, make_linear_solver(isochor::Solver::automatic));
    x_ = system_->parts().rest;
    const std::size_t n = x_.size();
    r_.resize(n), dx_.resize(n), stiffness_.resize(n), magnitude_.resize(n);
    target_.resize(system_->free_bases().size());
  }

  std::vector<Vec3>& x() { return x_; }
  BodyMeasures measures() const { return measure_body(builder_.body(BodyId{0}), system_->parts(), x_); }

  struct Outcome {
    int iterations = 0;
    bool converged = false;
  };
  // Supports at time t; residual relative to the forces that cancel.
  Outcome solve(double t, double tolerance, int most) {
    place_supports(t);
    Outcome out;
    for (; out.iterations < most; ++out.iterations) {
      assembly_->evaluate(Want::hessian, Definiteness::projected, x_, {}, {});
      const double before = residual();
      if (before <= tolerance) {
        out.converged = true;
        return out;
      }
      assembly_->stiffness_diagonal(stiffness_);
      Kkt::Values values;
      values.stiffness = stiffness_;
      if (kkt_->factor(*assembly_, values, seconds_).status != FactorStatus::ok) return out;
      for (Vec3& r : r_) r = -r;
      if (!kkt_->solve(r_, {}, dx_, {}, seconds_)) return out;
      double tau = 1;
      const std::vector<Vec3> start = x_;
      for (int halving = 0; halving < 6; ++halving, tau *= 0.5) {
        for (std::size_t i = 0; i < x_.size(); ++i) x_[i] = start[i] + tau * dx_[i];
        assembly_->evaluate(Want::gradient, Definiteness::exact, x_, {}, {});
        if (residual() < before) break;
      }
    }
    return out;
  }

 private:
  template <class T>
  static T need(Result<T> result) {
    if (!result) std::fprintf(stderr, "%s\n", result.error().c_str()), std::exit(2);
    return std::move(result).value();
  }
  static void need(const Result<void>& result) {
    if (!result) std::fprintf(stderr, "%s\n", result.error().c_str()), std::exit(2);
  }

  void place_supports(double t) {
    std::size_t first = 0;
    for (const auto& p : system_->parts().prescribers) {
      p->target(t, std::span(target_).subspan(first, p->nodes.size()));
      first += p->nodes.size();
    }
    for (std::size_t i = 0; i < x_.size(); ++i) {
      const Index b = system_->basis_of()[i];
      if (b < 0) continue;
      const FreeBasis& basis = system_->free_bases()[at(b)];
      Vec3 q = transposed_times(basis.directions, target_[at(b)] - x_[i]);
      for (int c = 0; c < basis.count; ++c) q[c] = 0;
      x_[i] += basis.directions * q;
    }
  }

  // Norm of the forces in free directions over that of what cancels in them.
  double residual() {
    assembly_->residual(r_);
    assembly_->residual_magnitude(magnitude_);
    double force = 0, size = 0;
    for (std::size_t i = 0; i < r_.size(); ++i) {
      const Index b = system_->basis_of()[i];
      const FreeBasis* basis = b >= 0 ? &system_->free_bases()[at(b)] : nullptr;
      const Vec3 q = basis ? transposed_times(basis->directions, r_[i]) : r_[i];
      for (int c = 0; c < (basis ? basis->count : 3); ++c) force += q[c] * q[c];
      size += magnitude_[i] * magnitude_[i];
    }
    return size > 0 ? std::sqrt(force / size) : 0;
  }

  TbbParallel parallel_{1};
  Builder builder_;
  std::vector<std::unique_ptr<EffectInstance>> instances_;
  std::shared_ptr<const System> system_;
  std::unique_ptr<Assembly> assembly_;
  std::unique_ptr<Kkt> kkt_;
  StageSeconds seconds_;
  std::vector<Vec3> x_, r_, dx_, target_;
  std::vector<double> stiffness_, magnitude_;
};

}  // namespace residual_newton
