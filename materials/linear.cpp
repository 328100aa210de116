// psi = mu e:e + lambda/2 tr^2 e [Pa] with e = (F + F^T)/2 - 1: linear elasticity, for small strains and
// rotations. Its distortional part is mu (e:e - tr^2 e / 3).
#include "materials/energy_model.h"

namespace isochor {

namespace {

class LinearMaterial final : public Material {
 public:
  LinearMaterial(double mu, double lambda) : mu_(mu), lambda_(lambda) {}
  std::string_view name() const override { return "linear"; }
  void describe(Fingerprint& f) const override { f.add(name(), mu_, lambda_); }

  void evaluate(Want want, const PointBatch& points, ResponseBatch& r) const override {
    for (int l = 0; l < kLanes; ++l) {
      double e[9], square = 0;
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
          const double identity = i == j ? 1.0 : 0.0;
          e[3 * i + j] = 0.5 * ((points.F[3 * i + j][l] - identity) + (points.F[3 * j + i][l] - identity));
        }
      }
      for (const double v : e) square += v * v;
      const double trace = e[0] + e[4] + e[8];
      r.psi[l] = mu_ * square + 0.5 * lambda_ * trace * trace;
      if (want == Want::value) continue;
      for (int i = 0; i < 9; ++i) r.P[i][l] = 2 * mu_ * e[i] + (i % 4 == 0 ? lambda_ * trace : 0.0);
    }
    if (want != Want::hessian) return;
    for (auto& a : r.A) store(broadcast(0), a);
    add_stiffness(r);
  }

  // The tangent is constant and does not turn with F: all of it counts as anisotropic.
  void spectrum(const PointBatch&, const Svd3&, Spectrum& out) const override { out = {}; }
  void add_anisotropic(Definiteness, const PointBatch&, ResponseBatch& r) const override { add_stiffness(r); }

 private:
  // Positive semidefinite: mu > 0 and lambda + 2 mu / 3 >= 0.
  void add_stiffness(ResponseBatch& r) const {
    int k = 0;
    for (int i = 0; i < 9; ++i) {
      for (int j = 0; j <= i; ++j, ++k) {
        double v = 0;
        if (i == j) v += mu_;
        if (i == 3 * (j % 3) + j / 3) v += mu_;  // the transposed entry
        if (i % 4 == 0 && j % 4 == 0) v += lambda_;
        for (double& a : r.A[k]) a += v;
      }
    }
  }

  double mu_, lambda_;
};

}  // namespace

Result<MaterialPtr> linear(const ElasticConstants& constants) {
  auto e = linear_elastic("linear", constants, -0.99);
  if (!e) return e.failure();
  const LinearElastic& small = e.value();
  EnergyModel m{
      "linear", small, small.inverse_bulk, std::make_shared<LinearMaterial>(small.mu, -2 * small.mu / 3),
      nullptr,  true};
  if (!small.incompressible()) {
    m.complete = std::make_shared<LinearMaterial>(small.mu, 1 / small.inverse_bulk - 2 * small.mu / 3);
  }
  return make_model(std::move(m));
}

}  // namespace isochor
