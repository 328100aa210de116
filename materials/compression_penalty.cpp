// Lambda U(J; beta), U = (J - 1)^2 (beta (J - 1)^2 + 6) / 12 [Pa], added to a material of any kind: what each
// element has against changes of its own volume where rows only keep that of a zone.
#include <cmath>

#include "engine/base/text.h"
#include "engine/elements/material_model.h"
#include "isochor/materials.h"
#include "materials/energy_batch.h"
#include "materials/wrapped_model.h"

namespace isochor {

namespace {

struct PenaltyEnergy {
  double modulus = 0, beta = 0;
  InvariantResponse operator()(double, double J) const {
    const double d = J - 1, square = beta * d * d;
    InvariantResponse r;
    r.psi = modulus * d * d * (square + 6) / 12;
    r.J = modulus * d * (square + 3) / 3;
    r.JJ = modulus * (square + 1);
    return r;
  }
};

class PenalizedMaterial final : public Material {
 public:
  PenalizedMaterial(std::string_view name, std::shared_ptr<const Material> base, PenaltyEnergy penalty)
      : name_(name), base_(std::move(base)), penalty_(name, penalty) {}
  std::string_view name() const override { return name_; }
  void describe(Fingerprint& f) const override { f.add(name_, base_, penalty_); }
  bool remembers() const override { return base_->remembers(); }
  void keep(const PointBatch& points, double* kept) const override { base_->keep(points, kept); }

  void evaluate(Want want, const PointBatch& points, ResponseBatch& r) const override {
    base_->evaluate(want, points, r);
    ResponseBatch share;
    penalty_.evaluate(want, points, share);
    store(load(r.psi) + load(share.psi), r.psi);
    for (int i = 0; i < 9 && want != Want::value; ++i) store(load(r.P[i]) + load(share.P[i]), r.P[i]);
    for (int i = 0; i < 45 && want == Want::hessian; ++i) store(load(r.A[i]) + load(share.A[i]), r.A[i]);
  }
  void spectrum(const PointBatch& points, const Svd3& svd, Spectrum& out) const override {
    base_->spectrum(points, svd, out);
    Spectrum share;
    penalty_.spectrum(points, svd, share);
    for (int i = 0; i < 3; ++i) out.twist[i] += share.twist[i], out.flip[i] += share.flip[i];
    for (int i = 0; i < 6; ++i) out.scaling[i] += share.scaling[i];
  }
  void add_anisotropic(Definiteness policy, const PointBatch& points, ResponseBatch& r) const override {
    base_->add_anisotropic(policy, points, r);
  }
  std::shared_ptr<const Material> gathered(const Lists& cells,
                                           std::span<const double> weight) const override {
    auto base = base_->gathered(cells, weight);
    if (!base) return nullptr;
    return std::make_shared<PenalizedMaterial>(name_, std::move(base), penalty_.energy());
  }

 private:
  std::string_view name_;
  std::shared_ptr<const Material> base_;
  InvariantMaterial<PenaltyEnergy> penalty_;
};

class PenalizedModel final : public WrappedModel {
 public:
  PenalizedModel(MaterialPtr of, PenaltyEnergy penalty)
      : WrappedModel(std::move(of)),
        name_(std::string(base().name()).append(" with compression penalty")),
        penalty_(penalty) {}
  std::string_view name() const override { return name_; }
  std::shared_ptr<const Material> distortional() const override {
    return std::make_shared<PenalizedMaterial>(name_, base().distortional(), penalty_);
  }
  Result<std::shared_ptr<const Material>> complete() const override {
    auto complete = base().complete();
    if (!complete) return complete;
    return std::shared_ptr<const Material>(
        std::make_shared<PenalizedMaterial>(name_, complete.value(), penalty_));
  }
  double poisson() const override { return with_penalty(base().poisson(), shear_modulus()); }
  double young() const override { return 2 * shear_modulus() * (1 + poisson()); }
  double poisson_of(Index cell) const override {
    return with_penalty(base().poisson_of(cell), shear_modulus() * stiffness_factor(cell));
  }

 private:
  // The penalty adds its modulus to the first Lamé parameter: nu = lambda / (2 (lambda + mu)).
  double with_penalty(double nu, double mu) const {
    if (nu == 0.5) return nu;
    const double lambda = 2 * mu * nu / (1 - 2 * nu) + penalty_.modulus;
    return lambda / (2 * (lambda + mu));
  }
  std::string name_;
  PenaltyEnergy penalty_;
};

}  // namespace

Result<MaterialPtr> with_compression_penalty(MaterialPtr base, const CompressionPenalty& penalty) {
  if (!base) return Error{"compression penalty: the material is empty"};
  if (!(penalty.modulus > 0) || !std::isfinite(penalty.modulus)) {
    return Error{"compression penalty: modulus = " + number(penalty.modulus) +
                 " Pa; it must be positive (some 25 times the shear modulus is usual)"};
  }
  if (!(penalty.beta >= 0) || !std::isfinite(penalty.beta)) {
    return Error{"compression penalty: beta = " + number(penalty.beta) +
                 "; it must be zero (quadratic) or positive (9 is usual)"};
  }
  return MaterialPtr(
      std::make_shared<PenalizedModel>(std::move(base), PenaltyEnergy{penalty.modulus, penalty.beta}));
}

}  // namespace isochor
