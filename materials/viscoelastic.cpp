// A Prony series beside an isochoric material: what of it stays for good, and the springs of the Maxwell
// elements, whose flow is engine/elements/relaxation_pool.h.
#include "isochor/viscoelastic.h"

#include <cmath>
#include <limits>

#include "engine/base/text.h"
#include "engine/elements/material_model.h"
#include "engine/math/lane_functions.h"
#include "materials/isochoric_base.h"
#include "materials/stretch_lanes.h"
#include "materials/wrapped_model.h"

namespace isochor {

namespace {

// mu sum_i e_i^2 with e the deviator of the logarithms of the principal stretches (Hencky 1928, without its
// volume part). No value where an element is inverted.
struct LogarithmicSpring {
  double mu = 0;
  StretchLanes respond(Want want, const Lanes s[3]) const;
};

StretchLanes LogarithmicSpring::respond(Want want, const Lanes s[3]) const {
  const double mu2 = 2 * mu;
  StretchLanes r;
  Lanes e[3], inverse[3], mean{};
  for (int i = 0; i < 3; ++i) {
    e[i] = log(s[i]);
    inverse[i] = 1 / s[i];
    mean += e[i] * (1.0 / 3);
  }
  for (int i = 0; i < 3; ++i) {
    e[i] -= mean;
    r.psi += mu * e[i] * e[i];
    r.d[i] = mu2 * e[i] * inverse[i];
  }
  for (int i = 0; i < 3 && want == Want::hessian; ++i) {
    const int a = (i + 1) % 3, b = (i + 2) % 3, pair = 2 + a + b;
    const int j = i == 0 ? 1 : 0, k = 3 - i - j;  // s_k <= s_j: the stretches come in order
    const Lanes jk = inverse[j] * inverse[k], x = (s[j] - s[k]) * inverse[k];
    const Lanes slope = x > 0 ? log1p(x) / x : broadcast(1);  // of the logarithm between the two, times s_k
    r.second.scaling[i] = mu2 * (2.0 / 3 - e[i]) * inverse[i] * inverse[i];
    r.second.scaling[pair] = -mu2 / 3 * jk;
    r.second.twist[i] = (r.d[j] + r.d[k]) / (s[j] + s[k]);
    r.second.flip[i] = mu2 * (slope - e[k]) * jk;
  }
  keep_domain(s[2], r);
  return r;
}

// `all` less a share of `part`, which may be the same.
class RemainderMaterial final : public Material {
 public:
  RemainderMaterial(std::shared_ptr<const Material> all, std::shared_ptr<const Material> part, double share)
      : all_(std::move(all)), part_(std::move(part)), share_(share) {}
  std::string_view name() const override { return all_->name(); }
  void describe(Fingerprint& f) const override { f.add(all_, part_, share_); }

  void evaluate(Want want, const PointBatch& points, ResponseBatch& r) const override {
    all_->evaluate(want, points, r);
    if (all_ == part_) {
      const double rest = 1 - share_;
      store(rest * load(r.psi), r.psi);
      for (int i = 0; i < 9 && want != Want::value; ++i) store(rest * load(r.P[i]), r.P[i]);
      for (int i = 0; i < 45 && want == Want::hessian; ++i) store(rest * load(r.A[i]), r.A[i]);
      return;
    }
    ResponseBatch p;
    part_->evaluate(want, points, p);
    // Where neither has a value there is no difference of two infinities.
    const Lanes psi = load(r.psi);
    const LaneMask none = ~(magnitude(psi) <= std::numeric_limits<double>::max());
    store(none ? psi : psi - share_ * load(p.psi), r.psi);
    for (int i = 0; i < 9 && want != Want::value; ++i) store(load(r.P[i]) - share_ * load(p.P[i]), r.P[i]);
    for (int i = 0; i < 45 && want == Want::hessian; ++i) store(load(r.A[i]) - share_ * load(p.A[i]), r.A[i]);
  }
  void spectrum(const PointBatch& points, const Svd3& svd, Spectrum& out) const override {
    all_->spectrum(points, svd, out);
    Spectrum p;
    part_->spectrum(points, svd, p);
    for (int i = 0; i < 3; ++i) {
      out.twist[i] -= share_ * p.twist[i];
      out.flip[i] -= share_ * p.flip[i];
      out.scaling[i] -= share_ * p.scaling[i];
      out.scaling[3 + i] -= share_ * p.scaling[3 + i];
    }
  }

 private:
  std::shared_ptr<const Material> all_, part_;
  double share_;
};

class PronyModel final : public WrappedModel {
 public:
  PronyModel(MaterialPtr of, const std::vector<PronyTerm>& terms, StaticTime statics)
      : WrappedModel(std::move(of)), name_(std::string(base().name()).append(" with memory")) {
    memory_.in_statics = statics == StaticTime::seconds;
    for (const PronyTerm& term : terms) {
      share_ += term.ratio;
      memory_.branches.push_back(
          {std::make_shared<StretchLanesMaterial<LogarithmicSpring>>(
               "logarithmic spring", LogarithmicSpring{term.ratio * base().shear_modulus()}),
           term.time});
    }
  }
  std::string_view name() const override { return name_; }
  std::shared_ptr<const Material> distortional() const override {
    const auto all = base().distortional();
    return std::make_shared<RemainderMaterial>(all, all, share_);
  }
  Result<std::shared_ptr<const Material>> complete() const override {
    auto all = base().complete();
    if (!all) return all;
    return std::shared_ptr<const Material>(
        std::make_shared<RemainderMaterial>(all.value(), base().distortional(), share_));
  }
  bool defined_inverted() const override { return false; }
  const MaterialMemory* memory() const override { return &memory_; }

 private:
  std::string name_;
  double share_ = 0;
  MaterialMemory memory_;
};

}  // namespace

Result<MaterialPtr> with_prony_series(MaterialPtr base, const std::vector<PronyTerm>& terms,
                                      StaticTime statics) {
  const std::string who = "viscoelastic: ";
  if (!base) return Error{who + "the material is empty"};
  if (base->memory() || base->distortional()->remembers())
    return Error{who + base->name().data() +
                 " has a memory already; give all terms at once, and no softening beside them"};
  if (terms.empty()) return Error{who + "there are no terms; give at least one pair of ratio and time"};
  double sum = 0;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const std::string term = who + "terms[" + std::to_string(i) + "].";
    if (!(terms[i].ratio > 0) || !std::isfinite(terms[i].ratio))
      return Error{term + "ratio = " + number(terms[i].ratio) +
                   "; it must be positive, a share of the instantaneous shear modulus"};
    if (!(terms[i].time > 0) || !std::isfinite(terms[i].time))
      return Error{term + "time = " + number(terms[i].time) + " s; relaxation times must be positive"};
    sum += terms[i].ratio;
  }
  if (!(sum < 1))
    return Error{who + "the ratios sum to " + number(sum) +
                 "; together they must stay below 1, or nothing is left to carry a load that lasts"};
  if (base->field_cells() > 0)
    return Error{who +
                 "the material has a field; a field of stiffness goes around the series, and one of "
                 "Poisson's ratio does not go with it"};
  if (!is_isochoric(*base->distortional())) {
    return Error{who + "the energy of " + std::string(base->name()) +
                 " depends on the volume beside its volume part, or on fibers; take an isochoric law "
                 "(isochoric_neo_hookean, isochoric_ogden, ...), and put fibers around the series"};
  }
  return MaterialPtr(std::make_shared<PronyModel>(std::move(base), terms, statics));
}

}  // namespace isochor
