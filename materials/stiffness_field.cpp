// A material whose stiffness varies from cell to cell: its energy, and the modulus of its volume rows, times
// a factor. Poisson's ratio and the shape of the law stay.
#include <cmath>

#include "engine/base/text.h"
#include "engine/elements/material_model.h"
#include "isochor/materials.h"
#include "materials/wrapped_model.h"

namespace isochor {

namespace {

class ScaledMaterial final : public Material {
 public:
  ScaledMaterial(std::shared_ptr<const Material> base, std::vector<double> factor)
      : base_(std::move(base)), factor_(std::move(factor)) {}
  std::string_view name() const override { return base_->name(); }
  void describe(Fingerprint& f) const override { f.add(base_, factor_); }
  bool remembers() const override { return base_->remembers(); }
  void keep(const PointBatch& points, double* kept) const override { base_->keep(points, kept); }

  void evaluate(Want want, const PointBatch& points, ResponseBatch& r) const override {
    base_->evaluate(want, points, r);
    const Lanes f = factor(points);
    store(load(r.psi) * f, r.psi);
    for (int i = 0; i < 9 && want != Want::value; ++i) store(load(r.P[i]) * f, r.P[i]);
    for (int i = 0; i < 45 && want == Want::hessian; ++i) store(load(r.A[i]) * f, r.A[i]);
  }
  void spectrum(const PointBatch& points, const Svd3& svd, Spectrum& out) const override {
    base_->spectrum(points, svd, out);
    const Lanes f = factor(points);
    for (int i = 0; i < 3; ++i) out.twist[i] *= f, out.flip[i] *= f;
    for (Lanes& v : out.scaling) v *= f;
  }
  void add_anisotropic(Definiteness policy, const PointBatch& points, ResponseBatch& r) const override {
    ResponseBatch share;
    for (auto& a : share.A) store(broadcast(0), a);
    base_->add_anisotropic(policy, points, share);
    const Lanes f = factor(points);
    for (int i = 0; i < 45; ++i) store(load(r.A[i]) + f * load(share.A[i]), r.A[i]);
  }

  std::shared_ptr<const Material> gathered(const Lists& cells,
                                           std::span<const double> weight) const override {
    auto base = base_->gathered(cells, weight);
    std::vector<double> mean(at(cells.count()), 0);
    for (Index s = 0; s < cells.count(); ++s) {
      for (Index k = cells.offset[at(s)]; k < cells.offset[at(s) + 1]; ++k) {
        mean[at(s)] += weight[at(k)] * factor_[at(cells.item[at(k)])];
      }
    }
    return std::make_shared<ScaledMaterial>(base ? base : base_, std::move(mean));
  }

 private:
  Lanes factor(const PointBatch& points) const {
    Lanes f;
    for (int l = 0; l < kLanes; ++l) f[l] = factor_[at(points.element[l])];
    return f;
  }

  std::shared_ptr<const Material> base_;
  std::vector<double> factor_;
};

class ScaledModel final : public WrappedModel {
 public:
  ScaledModel(MaterialPtr of, std::vector<double> factor)
      : WrappedModel(std::move(of)), factor_(std::move(factor)) {
    if (!base().memory()) return;
    memory_ = *base().memory();
    for (auto& branch : memory_.branches)
      branch.spring = std::make_shared<ScaledMaterial>(std::move(branch.spring), factor_);
  }
  std::shared_ptr<const Material> distortional() const override {
    return std::make_shared<ScaledMaterial>(base().distortional(), factor_);
  }
  Result<std::shared_ptr<const Material>> complete() const override {
    auto complete = base().complete();
    if (!complete) return complete;
    return std::shared_ptr<const Material>(std::make_shared<ScaledMaterial>(complete.value(), factor_));
  }
  const MaterialMemory* memory() const override { return base().memory() ? &memory_ : nullptr; }
  std::size_t field_cells() const override { return factor_.size(); }
  double stiffness_factor(Index cell) const override {
    return base().stiffness_factor(cell) * factor_[at(cell)];
  }
  double inverse_bulk_of(Index cell) const override {
    return base().inverse_bulk_of(cell) / factor_[at(cell)];
  }

 private:
  std::vector<double> factor_;
  MaterialMemory memory_;
};

}  // namespace

Result<MaterialPtr> with_stiffness_field(MaterialPtr base, std::vector<double> factor) {
  if (!base) return Error{"stiffness field: the material is empty"};
  if (factor.empty())
    return Error{"stiffness field: it has no entry; give one factor a cell of the body's mesh"};
  for (std::size_t c = 0; c < factor.size(); ++c) {
    if (factor[c] > 0 && std::isfinite(factor[c])) continue;
    return Error{"stiffness field: factor[" + std::to_string(c) + "] = " + number(factor[c]) +
                 "; every cell needs a positive number (a cell without stiffness would not hold together)"};
  }
  if (base->field_cells() > 0 && base->field_cells() != factor.size()) {
    return Error{"stiffness field: it has " + std::to_string(factor.size()) +
                 " entries, another field of the material " + std::to_string(base->field_cells()) +
                 "; fields have one entry a cell of the body's mesh"};
  }
  return MaterialPtr(std::make_shared<ScaledModel>(std::move(base), std::move(factor)));
}

}  // namespace isochor
