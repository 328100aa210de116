#include <cmath>

#include "constraints/stencil/mesh_field.h"
#include "engine/base/text.h"
#include "isochor/effects/active.h"

namespace isochor {

namespace {

class AmountOverTime final : public NumberOverTime {
 public:
  explicit AmountOverTime(std::shared_ptr<const Amount> amount) : amount_(std::move(amount)) {}
  double at(double t) const override { return amount_->value(t); }

 private:
  std::shared_ptr<const Amount> amount_;
};

class GrowthInstance final : public EffectInstance {
 public:
  explicit GrowthInstance(std::shared_ptr<Amount> amount) : amount_(std::move(amount)) {}
  Amount* amount() override { return amount_.get(); }
  bool amount_in_energy() const override { return true; }

 private:
  std::shared_ptr<Amount> amount_;
};

// What declare() leaves for build().
struct Declared {
  std::shared_ptr<Amount> amount;
};

bool any(const Growth::Tensor& G) {
  return std::any_of(G.begin(), G.end(), [](double v) { return v != 0; });
}
bool finite_tensor(const Growth::Tensor& G) {
  return std::all_of(G.begin(), G.end(), [](double v) { return std::isfinite(v); });
}

class GrowthEffect final : public EffectSource {
 public:
  explicit GrowthEffect(GrowthDef def) : def_(std::move(def)) {}
  const std::string& name() const override { return def_.name; }
  void describe(Fingerprint& f) const override { f.add(def_); }

  Result<void> check() const override {
    for (const auto& [key, value] : {std::pair{"linear", def_.linear},
                                     {"volume", def_.volume},
                                     {"along", def_.along},
                                     {"across", def_.across}}) {
      if (!std::isfinite(value)) return Error{who() + key + " = " + number(value) + "; give a finite number"};
    }
    if (!finite_tensor(def_.strain)) return Error{who() + "strain has an entry that is no finite number"};
    for (std::size_t c = 0; c < def_.strains.size(); ++c) {
      if (!finite_tensor(def_.strains[c]))
        return Error{who() + "strains[" + std::to_string(c) + "] has an entry that is no finite number"};
    }
    for (std::size_t c = 0; c < def_.factors.size(); ++c) {
      if (!std::isfinite(def_.factors[c]))
        return Error{who() + "factors[" + std::to_string(c) + "] = " + number(def_.factors[c]) +
                     "; give a finite number"};
    }
    for (const auto& p : def_.amount.points) {
      if (!std::isfinite(p[1])) return Error{who() + "its amount has a value that is no finite number"};
    }
    if (!def_.factors.empty() && !def_.field.empty())
      return Error{who() + "factors and a field are given; give one of them"};
    const int forms = (def_.linear != 0) + (def_.volume != 0) + (def_.along != 0 || def_.across != 0) +
                      any(def_.strain) + !def_.strains.empty();
    if (forms > 1) {
      return Error{who() +
                   "several of linear, volume, along and across, strain and strains are given; give one"};
    }
    if (forms == 0 && def_.field.empty()) {
      return Error{who() +
                   "it has no strain; give linear, volume, along and across, strain, or a field of the mesh"};
    }
    const double n = dot(def_.direction, def_.direction);
    if (!(n > 0) || !std::isfinite(n))
      return Error{who() + "direction has no length; give three numbers that are not all zero"};
    return {};
  }

  Result<void> declare(Builder& builder) const override {
    auto regions = builder.regions(def_.body, def_.regions, def_.name);
    if (!regions) return regions.failure();
    const BodyData& body = builder.body(def_.body);
    auto made = strains_of(body.mesh);
    if (!made) return Error{who() + made.error()};
    auto growth = std::make_shared<Growth>(std::move(made).value());
    const auto amount = std::make_shared<Amount>(def_.amount);
    builder.shared<Declared>(key())->amount = amount;
    growth->amount = std::make_shared<AmountOverTime>(amount);
    for (const std::size_t r : regions.value()) {
      const RegionData& region = body.regions[r];
      if (region.material->memory()) {
        return Error{who() + "the material " + std::string(region.material->name()) + " of region \"" +
                     region.name + "\" has a memory, which does not follow growth; take the law without it"};
      }
      if (auto r2 = check_range(region, *growth); !r2) return r2;
      if (!builder.grow(def_.body, r, growth)) {
        return Error{who() + "region \"" + region.name +
                     "\" has a growth already; give each region one, with the sum of both strains"};
      }
    }
    return {};
  }

  Result<std::unique_ptr<EffectInstance>> build(Builder& builder) const override {
    return std::unique_ptr<EffectInstance>(
        std::make_unique<GrowthInstance>(builder.shared<Declared>(key())->amount));
  }

 private:
  std::string who() const { return "growth \"" + def_.name + "\": "; }
  std::string key() const { return "growth " + def_.name; }

  // G at one cell, without factors.
  Growth::Tensor tensor() const {
    if (def_.volume != 0) return {def_.volume, def_.volume, def_.volume, 0, 0, 0};
    if (def_.along != 0 || def_.across != 0) {
      const Vec3 d = (1 / norm(def_.direction)) * def_.direction;
      const double a = def_.along - def_.across, c = def_.across;
      return {c + a * d.x * d.x, c + a * d.y * d.y, c + a * d.z * d.z,
              a * d.x * d.y,     a * d.y * d.z,     a * d.z * d.x};
    }
    if (any(def_.strain)) return def_.strain;
    return {def_.linear, def_.linear, def_.linear, 0, 0, 0};
  }

  // Without its amount.
  Result<Growth> strains_of(const Mesh& mesh) const {
    Growth out;
    out.by_volume = def_.volume != 0;
    const Growth::Tensor one = tensor();
    std::vector<double> factors = def_.factors;
    out.rate = def_.strains;
    if (!def_.strains.empty()) {
      if (auto r = check_cells(mesh, "strains", def_.strains.size()); !r) return r.failure();
    }
    if (!def_.field.empty()) {
      auto found = cell_field(mesh, def_.field);
      if (!found) return found.failure();
      const MeshField& field = *found.value();
      const bool alone = !any(one) && out.rate.empty();
      if (field.components != (alone ? 6 : 1)) {
        return Error{"field \"" + def_.field + "\" has " + std::to_string(field.components) +
                     " components; " +
                     (alone ? "strains have six: xx, yy, zz, xy, yz, zx (factors with one go with a strain)"
                            : "factors on the strains that are given have one (strains with six go alone)")};
      }
      if (!alone) factors = field.values;
      for (std::size_t c = 0; alone && c < field.values.size(); c += 6) {
        auto& G = out.rate.emplace_back();
        std::copy_n(field.values.begin() + static_cast<std::ptrdiff_t>(c), 6, G.begin());
        if (!finite_tensor(G))
          return Error{"field \"" + def_.field + "\" has no finite number in cell " + std::to_string(c / 6)};
      }
    }
    if (!factors.empty()) {
      if (auto r = check_cells(mesh, "factors", factors.size()); !r) return r.failure();
      if (out.rate.empty()) out.rate.assign(factors.size(), one);
      for (std::size_t c = 0; c < factors.size(); ++c) {
        for (double& v : out.rate[c]) v *= factors[c];
      }
    }
    out.field = !out.rate.empty();
    if (!out.field) out.rate = {one};
    return out;
  }

  // Growth along the curve of its definition turns nothing inside out; between points it is linear.
  Result<void> check_range(const RegionData& region, const Growth& growth) const {
    for (const auto& point : def_.amount.points) {
      for (const Index c : region.cells) {
        if (!growth.at(c, point[1]).valid) {
          return Error{who() + "at amount " + number(point[1]) + " cell " + std::to_string(c) +
                       " would shrink to nothing or turn over; 1 + amount strain must stay positive in every "
                       "direction"};
        }
        if (!growth.field) break;
      }
    }
    return {};
  }

  GrowthDef def_;
};

}  // namespace

EffectPtr growth(GrowthDef def) {
  return std::make_shared<GrowthEffect>(std::move(def));
}

}  // namespace isochor
