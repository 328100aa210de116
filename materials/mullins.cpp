// Ogden & Roxburgh, A pseudo-elastic model for the Mullins effect in filled rubber (1999), with the
// softening variable of Abaqus and others (the error function with m + beta W_m).
//
// While W is below the W_m that a point remembers its energy density is that of the law plus
//   D(W) = integral of eta - 1 from 0 to W = -(G(W_m) - G(W_m - W)) / r,
//   G(u) = integral of erf(s/c) ds = u erf(u/c) + c (exp(-u^2/c^2) - 1) / sqrt(pi),   c = m + beta W_m,
// and above it D stays at -G(W_m) / r: the derivative is eta on one side and 1 on the other, and both are 1
// where they meet. So an increment, in which W_m is given, has a potential with a continuous gradient; what
// W_m has grown by at its end takes (G(new) - G(old)) / r away, which is the dissipation.
#include "isochor/mullins.h"

#include <cmath>
#include <numbers>

#include "engine/base/text.h"
#include "engine/elements/material_model.h"
#include "materials/isochoric_base.h"
#include "materials/wrapped_model.h"

namespace isochor {

namespace {

// What is added to psi, and to the factors of its derivatives.
struct Softening {
  Lanes energy = {};  // D
  Lanes factor = {};  // eta - 1
  Lanes slope = {};   // d eta / dW
};

// `all` with the share `part` of it softened; both may be the same.
class SoftenedMaterial final : public Material {
 public:
  SoftenedMaterial(std::shared_ptr<const Material> all, std::shared_ptr<const Material> part,
                   const MullinsSoftening& constants)
      : all_(std::move(all)), part_(std::move(part)), constants_(constants) {
    PointBatch rest{};
    ResponseBatch r;
    for (int i = 0; i < 9; i += 4) store(broadcast(1), rest.F[i]);
    part_->evaluate(Want::value, rest, r);
    at_rest_ = r.psi[0];
  }
  std::string_view name() const override { return all_->name(); }
  void describe(Fingerprint& f) const override {
    f.add(all_, part_, constants_.r, constants_.m, constants_.beta);
  }
  bool remembers() const override { return true; }

  void keep(const PointBatch& points, double* kept) const override {
    ResponseBatch p;
    part_->evaluate(Want::value, points, p);
    for (int l = 0; l < kLanes; ++l) {
      const double W = p.psi[l] - at_rest_;
      if (std::isfinite(W) && W > kept[l]) kept[l] = W;
    }
  }

  void evaluate(Want want, const PointBatch& points, ResponseBatch& r) const override {
    all_->evaluate(want, points, r);
    ResponseBatch other;
    const bool same = all_ == part_;
    if (!same) part_->evaluate(want, points, other);
    const ResponseBatch& p = same ? r : other;
    const Softening s = soften(points, p.psi);
    Lanes P[9];
    for (int i = 0; i < 9 && want != Want::value; ++i) P[i] = load(p.P[i]);
    for (int i = 0, k = 0; i < 9 && want == Want::hessian; ++i) {
      for (int j = 0; j <= i; ++j, ++k)
        store(load(r.A[k]) + s.factor * load(p.A[k]) + s.slope * P[i] * P[j], r.A[k]);
    }
    for (int i = 0; i < 9 && want != Want::value; ++i) store(load(r.P[i]) + s.factor * P[i], r.P[i]);
    store(load(r.psi) + s.energy, r.psi);
  }

  void spectrum(const PointBatch& points, const Svd3& svd, Spectrum& out) const override {
    all_->spectrum(points, svd, out);
    Spectrum other;
    const bool same = all_ == part_;
    if (!same) part_->spectrum(points, svd, other);
    const Spectrum& p = same ? out : other;
    ResponseBatch r;
    part_->evaluate(Want::gradient, points, r);
    const Softening s = soften(points, r.psi);
    for (int i = 0; i < 3; ++i) {
      out.twist[i] += s.factor * p.twist[i];
      out.flip[i] += s.factor * p.flip[i];
    }
    // Of the principal stretches: u_i . P v_i.
    Lanes d[3] = {};
    for (int k = 0; k < 3; ++k) {
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) d[k] += svd.U[3 * i + k] * load(r.P[3 * i + j]) * svd.V[3 * j + k];
      }
    }
    constexpr int pair[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
    for (int k = 0; k < 6; ++k)
      out.scaling[k] += s.factor * p.scaling[k] + s.slope * d[pair[k][0]] * d[pair[k][1]];
  }

 private:
  Softening soften(const PointBatch& points, const double psi[kLanes]) const {
    constexpr double root_pi = 1 / std::numbers::inv_sqrtpi;
    Softening s;
    for (int l = 0; l < kLanes; ++l) {
      const double most = points.kept[l], c = constants_.m + constants_.beta * most;
      if (!(most > 0) || !std::isfinite(psi[l])) continue;
      const auto integral = [&](double u) {
        return u * std::erf(u / c) + c / root_pi * std::expm1(-(u / c) * (u / c));
      };
      const double left = most - (psi[l] - at_rest_);
      s.energy[l] = -integral(most) / constants_.r;
      if (left <= 0) continue;
      s.energy[l] += integral(left) / constants_.r;
      s.factor[l] = -std::erf(left / c) / constants_.r;
      s.slope[l] = 2 / (root_pi * c * constants_.r) * std::exp(-(left / c) * (left / c));
    }
    return s;
  }

  std::shared_ptr<const Material> all_, part_;
  MullinsSoftening constants_;
  double at_rest_ = 0;  // what the energy of the law is where nothing is stretched [Pa]
};

class SoftenedModel final : public WrappedModel {
 public:
  SoftenedModel(MaterialPtr of, const MullinsSoftening& constants)
      : WrappedModel(std::move(of)),
        name_(std::string(base().name()).append(" with Mullins softening")),
        constants_(constants) {}
  std::string_view name() const override { return name_; }
  std::shared_ptr<const Material> distortional() const override {
    const auto part = base().distortional();
    return std::make_shared<SoftenedMaterial>(part, part, constants_);
  }
  Result<std::shared_ptr<const Material>> complete() const override {
    auto all = base().complete();
    if (!all) return all;
    return std::shared_ptr<const Material>(
        std::make_shared<SoftenedMaterial>(all.value(), base().distortional(), constants_));
  }

 private:
  std::string name_;
  MullinsSoftening constants_;
};

}  // namespace

Result<MaterialPtr> with_mullins_softening(MaterialPtr base, const MullinsSoftening& softening) {
  const std::string who = "Mullins softening: ";
  if (!base) return Error{who + "the material is empty"};
  const auto [r, m, beta] = softening;
  if (!(r > 1) || !std::isfinite(r))
    return Error{who + "r = " + number(r) +
                 "; it must be above 1, or nothing of the stress would be left (1.1 to 5 is usual)"};
  if (!(m >= 0) || !std::isfinite(m)) return Error{who + "m = " + number(m) + " Pa; it must not be negative"};
  if (!(beta >= 0) || !std::isfinite(beta))
    return Error{who + "beta = " + number(beta) + "; it must not be negative"};
  if (m == 0 && beta == 0)
    return Error{who + "m and beta are both 0; one of them must be positive, or stresses would jump"};
  const auto energy = base->distortional();
  if (base->memory() || energy->remembers())
    return Error{who + std::string(base->name()) + " remembers already; take the law without it"};
  if (base->field_cells() > 0)
    return Error{who +
                 "the material has a field; a field of stiffness goes around the softening, and one of "
                 "Poisson's ratio does not go with it"};
  if (!is_isochoric(*energy)) {
    return Error{who + "the energy of " + std::string(base->name()) +
                 " depends on the volume beside its volume part, or on fibers; take an isochoric law "
                 "(isochoric_neo_hookean, isochoric_ogden, ...), and put fibers around the softening"};
  }
  return MaterialPtr(std::make_shared<SoftenedModel>(std::move(base), softening));
}

}  // namespace isochor
