// A material whose Poisson's ratio varies from cell to cell while its other constants stay.
//
// Every law of this folder is affine in its shear modulus and in the modulus of its volume part: psi = mu
// A(F)
// + kappa U(F) + rest(F). So three energies hold the whole family: the distortional ones at the smallest and
// the largest ratio, and the complete one at the largest.
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <map>

#include "engine/base/text.h"
#include "engine/elements/material_model.h"
#include "isochor/materials.h"

namespace isochor {

namespace {

// A sum of energies whose weights vary from element to element.
class MixedMaterial final : public Material {
 public:
  struct Part {
    std::shared_ptr<const Material> energy;
    std::vector<double> weight;  // one an element
  };
  explicit MixedMaterial(std::vector<Part> parts) : parts_(std::move(parts)) {}
  std::string_view name() const override { return parts_.front().energy->name(); }
  void describe(Fingerprint& f) const override { f.add(parts_); }

  void evaluate(Want want, const PointBatch& points, ResponseBatch& r) const override {
    ResponseBatch one;
    clear(want, r);
    for (const Part& part : parts_) {
      part.energy->evaluate(want, points, one);
      const Lanes w = weight(part, points);
      add(w, one.psi, r.psi);
      for (int i = 0; i < 9 && want != Want::value; ++i) add(w, one.P[i], r.P[i]);
      for (int i = 0; i < 45 && want == Want::hessian; ++i) add(w, one.A[i], r.A[i]);
    }
    // Two energies without a value make none together, not the difference of infinities.
    for (double& psi : r.psi) psi = std::isnan(psi) ? std::numeric_limits<double>::infinity() : psi;
  }
  void spectrum(const PointBatch& points, const Svd3& svd, Spectrum& out) const override {
    out = {};
    for (const Part& part : parts_) {
      Spectrum one = {};
      part.energy->spectrum(points, svd, one);
      const Lanes w = weight(part, points);
      for (int i = 0; i < 3; ++i) out.twist[i] += w * one.twist[i], out.flip[i] += w * one.flip[i];
      for (int i = 0; i < 6; ++i) out.scaling[i] += w * one.scaling[i];
    }
  }
  void add_anisotropic(Definiteness policy, const PointBatch& points, ResponseBatch& r) const override {
    for (const Part& part : parts_) {
      ResponseBatch one;
      for (auto& a : one.A) store(broadcast(0), a);
      part.energy->add_anisotropic(policy, points, one);
      const Lanes w = weight(part, points);
      for (int i = 0; i < 45; ++i) add(w, one.A[i], r.A[i]);
    }
  }

  std::shared_ptr<const Material> gathered(const Lists& cells, std::span<const double> share) const override {
    std::vector<Part> parts;
    for (const Part& part : parts_) {
      auto own = part.energy->gathered(cells, share);
      Part mean{own ? own : part.energy, std::vector<double>(at(cells.count()), 0)};
      for (Index s = 0; s < cells.count(); ++s) {
        for (Index k = cells.offset[at(s)]; k < cells.offset[at(s) + 1]; ++k) {
          mean.weight[at(s)] += share[at(k)] * part.weight[at(cells.item[at(k)])];
        }
      }
      parts.push_back(std::move(mean));
    }
    return std::make_shared<MixedMaterial>(std::move(parts));
  }

 private:
  static void clear(Want want, ResponseBatch& r) {
    store(broadcast(0), r.psi);
    for (int i = 0; i < 9 && want != Want::value; ++i) store(broadcast(0), r.P[i]);
    for (int i = 0; i < 45 && want == Want::hessian; ++i) store(broadcast(0), r.A[i]);
  }
  static void add(const Lanes& w, const double* from, double* to) { store(load(to) + w * load(from), to); }
  static Lanes weight(const Part& part, const PointBatch& points) {
    Lanes w;
    for (int l = 0; l < kLanes; ++l) w[l] = part.weight[at(points.element[l])];
    return w;
  }

  std::vector<Part> parts_;
};

// The modulus of the volume part of a complete energy [Pa]: what its tangent at rest has more than that of
// the distortional one. Volume rows may carry another (BulkChoice).
double volume_modulus(const Material& complete, const Material& distortional) {
  PointBatch rest{};
  for (int i = 0; i < 9; i += 4) store(broadcast(1), rest.F[i]);
  ResponseBatch with, without;
  complete.evaluate(Want::hessian, rest, with);
  distortional.evaluate(Want::hessian, rest, without);
  constexpr int xx_yy = 4 * 5 / 2;
  return with.A[xx_yy][0] - without.A[xx_yy][0];
}

// Members of the family, by ascending Poisson's ratio; which one each cell is of.
class PoissonFieldModel final : public MaterialModel {
 public:
  PoissonFieldModel(std::vector<MaterialPtr> members, std::vector<Index> member_of)
      : members_(std::move(members)), member_of_(std::move(member_of)) {}
  std::string_view name() const override { return members_.front()->name(); }
  std::shared_ptr<const Material> distortional() const override {
    return std::make_shared<MixedMaterial>(distortional_parts());
  }
  Result<std::shared_ptr<const Material>> complete() const override {
    std::vector<double> modulus;
    for (const MaterialPtr& m : members_) {
      auto energy = m->complete();
      if (!energy) return energy;
      modulus.push_back(volume_modulus(*energy.value(), *m->distortional()));
    }
    std::vector<MixedMaterial::Part> parts = distortional_parts();
    if (modulus.back() > 0) {
      std::vector<double> plus, minus;
      for (const Index m : member_of_) {
        plus.push_back(modulus[at(m)] / modulus.back());
        minus.push_back(-plus.back());
      }
      parts.push_back({members_.back()->complete().value(), std::move(plus)});
      parts.push_back({members_.back()->distortional(), std::move(minus)});
    }
    return std::shared_ptr<const Material>(std::make_shared<MixedMaterial>(std::move(parts)));
  }
  double shear_modulus() const override { return members_.front()->shear_modulus(); }
  // Of the softest: zero only where all cells are incompressible.
  double inverse_bulk() const override { return members_.front()->inverse_bulk(); }
  double poisson() const override { return members_.front()->poisson(); }
  double young() const override { return members_.front()->young(); }
  bool defined_inverted() const override { return members_.front()->defined_inverted(); }
  VolumeStrain volume_strain() const override { return members_.front()->volume_strain(); }
  std::vector<std::string> warnings() const override { return members_.front()->warnings(); }
  std::size_t field_cells() const override { return member_of_.size(); }
  double stiffness_factor(Index cell) const override {
    return member(cell).shear_modulus() / shear_modulus();
  }
  double inverse_bulk_of(Index cell) const override { return member(cell).inverse_bulk(); }
  double poisson_of(Index cell) const override { return member(cell).poisson(); }

 private:
  const MaterialModel& member(Index cell) const { return *members_[at(member_of_[at(cell)])]; }
  // Between the two ends of the family, by the shear modulus.
  std::vector<MixedMaterial::Part> distortional_parts() const {
    const MaterialModel &low = *members_.front(), &high = *members_.back();
    const double a = low.shear_modulus(), b = high.shear_modulus();
    std::vector<double> first, second;
    for (const Index m : member_of_) {
      second.push_back(a == b ? 0 : (members_[at(m)]->shear_modulus() - a) / (b - a));
      first.push_back(1 - second.back());
    }
    std::vector<MixedMaterial::Part> parts{{low.distortional(), std::move(first)}};
    if (a != b) parts.push_back({high.distortional(), std::move(second)});
    return parts;
  }

  std::vector<MaterialPtr> members_;
  std::vector<Index> member_of_;
};

}  // namespace

Result<MaterialPtr> with_poisson_field(const std::function<Result<MaterialPtr>(double)>& law,
                                       const std::vector<double>& poisson) {
  if (!law) return Error{"field of Poisson's ratio: there is no law; give a function from nu to a material"};
  if (poisson.empty())
    return Error{"field of Poisson's ratio: it has no entry; give one number a cell of the body's mesh"};
  std::map<double, MaterialPtr> made;
  for (std::size_t c = 0; c < poisson.size(); ++c) {
    const std::string who = "field of Poisson's ratio: entry " + std::to_string(c) + ": ";
    if (std::isnan(poisson[c])) return Error{who + "not a number"};
    const auto [it, fresh] = made.try_emplace(poisson[c]);
    if (!fresh) continue;
    auto material = law(poisson[c]);
    if (!material) return Error{who + material.error()};
    if (!material.value()) return Error{who + "the law gave no material"};
    if (material.value()->field_cells() > 0) {
      return Error{who +
                   "the law has a field of its own; put the field of Poisson's ratio on the law without "
                   "fields and the others on top"};
    }
    if (material.value()->memory() || material.value()->distortional()->remembers()) {
      return Error{who +
                   "the law has a memory, which does not go with a field of Poisson's ratio; give each "
                   "ratio a region of its own"};
    }
    if (!material.value()->has_separate_volume()) {
      return Error{who + "the energy of the law " + std::string(material.value()->name()) +
                   " is no sum of a part without Poisson's ratio and a volume part; give each ratio a region "
                   "of its own"};
    }
    if (std::isinf(material.value()->inverse_bulk())) {
      return Error{who + "nu = " + number(poisson[c]) +
                   " leaves this law no volume part (kappa = 0); take a slightly larger ratio"};
    }
    it->second = std::move(material).value();
  }
  std::vector<MaterialPtr> members;
  for (const auto& [nu, material] : made) members.push_back(material);
  std::vector<Index> member_of;
  for (const double nu : poisson) {
    member_of.push_back(static_cast<Index>(std::distance(made.begin(), made.find(nu))));
  }
  return MaterialPtr(std::make_shared<PoissonFieldModel>(std::move(members), std::move(member_of)));
}

}  // namespace isochor
