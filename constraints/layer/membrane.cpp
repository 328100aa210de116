// A neo-Hookean membrane on faces of a body: in-plane stretch and shear in plane stress, no bending.
#include <cmath>

#include "constraints/layer/sheet_pool.h"
#include "engine/base/text.h"
#include "engine/scene/builder.h"
#include "isochor/effects/layer.h"

namespace isochor {

namespace {

class MembraneInstance final : public EffectInstance {
 public:
  MembraneInstance(std::string name, std::shared_ptr<const MembranePool> pool, std::shared_ptr<Amount> amount)
      : name_(std::move(name)), pool_(std::move(pool)), amount_(std::move(amount)) {}
  Amount* amount() override { return amount_.get(); }
  bool amount_in_energy() const override { return true; }
  void gauges(const GaugeContext& c, std::vector<Gauge>& out) const override {
    out.push_back({name_, "membrane", "area", "m^2", pool_->area(c.state.x, c.system.parts().rest)});
  }

 private:
  std::string name_;
  std::shared_ptr<const MembranePool> pool_;
  std::shared_ptr<Amount> amount_;  // of the prestretch; null: there is none
};

class MembraneEffect final : public EffectSource {
 public:
  explicit MembraneEffect(MembraneDef def) : def_(std::move(def)) {}
  const std::string& name() const override { return def_.name; }
  void describe(Fingerprint& f) const override { f.add(def_); }

  Result<void> check() const override {
    if (def_.surfaces.empty()) {
      return Error{who() + "surfaces is empty; name the surfaces that carry the membrane"};
    }
    if (!(def_.young > 0) || !std::isfinite(def_.young)) {
      return Error{who() + "young = " + number(def_.young) + " Pa; it must be positive"};
    }
    if (!(def_.thickness > 0) || !std::isfinite(def_.thickness)) {
      return Error{who() + "thickness = " + number(def_.thickness) + " m; it must be positive"};
    }
    if (!(def_.poisson >= 0) || !(def_.poisson <= 0.5)) {
      return Error{who() + "poisson = " + number(def_.poisson) +
                   "; it must lie between 0 and 0.5, 0.5 is an incompressible membrane"};
    }
    if (auto r = check_sheet(def_.prestretch, def_.amount, {}); !r) return Error{who() + r.error()};
    return {};
  }

  Result<std::unique_ptr<EffectInstance>> build(Builder& builder) const override {
    auto named = builder.faces(def_.body, def_.surfaces, def_.name);
    if (!named) return named.failure();
    const auto per_face = static_cast<std::size_t>(nodes_per_face(builder.body(def_.body).mesh.cell_type));
    const auto faces = distinct_faces(named.value(), per_face);
    Sheet sheet;
    sheet.mu = def_.young / (2 * (1 + def_.poisson));
    sheet.poisson = def_.poisson;
    sheet.thickness = def_.thickness;
    sheet.prestretch = def_.prestretch;
    std::shared_ptr<Amount> amount;
    if (sheet.prestretched()) sheet.amount = amount = std::make_shared<Amount>(def_.amount);
    std::string undirected;
    const auto pool = make_sheet(def_.name, per_face, faces, builder.rest(), sheet, undirected);
    if (!undirected.empty()) {
      return Error{who() + "the direction of its " + undirected +
                   " stands across one of its faces; give one that lies in the membrane"};
    }
    builder.add_stencils(pool);
    return std::unique_ptr<EffectInstance>(
        std::make_unique<MembraneInstance>(def_.name, pool, std::move(amount)));
  }

 private:
  std::string who() const { return "membrane \"" + def_.name + "\": "; }

  MembraneDef def_;
};

}  // namespace

EffectPtr membrane(MembraneDef def) {
  return std::make_shared<MembraneEffect>(std::move(def));
}

}  // namespace isochor
