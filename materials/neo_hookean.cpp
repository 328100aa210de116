#include "materials/neo_hookean.h"

#include <cmath>
#include <limits>

#include "engine/material_model.h"
#include "materials/elastic_constants.h"
#include "materials/energy_batch.h"

namespace isochor {

InvariantResponse NeoHookeanEnergy::operator()(double I, double J) const {
  InvariantResponse r;
  if (!(J > 0)) {
    r.psi = std::numeric_limits<double>::infinity();
    return r;
  }
  const double log_J = std::log(J);
  r.psi = mu / 2 * (I - 3) - mu * log_J + lambda / 2 * log_J * log_J;
  r.I = mu / 2;
  r.J = (lambda * log_J - mu) / J;
  r.JJ = (lambda * (1 - log_J) + mu) / (J * J);
  return r;
}

namespace {

class NeoHookean final : public MaterialModel {
 public:
  NeoHookean(const LinearElastic& e, BulkChoice choice) : e_(e), choice_(choice) {}
  std::string_view name() const override { return "neo_hookean"; }
  std::shared_ptr<const Material> distortional() const override {
    return std::make_shared<InvariantMaterial<NeoHookeanEnergy>>(name(), NeoHookeanEnergy{e_.mu, 0});
  }
  Result<std::shared_ptr<const Material>> complete() const override {
    if (e_.incompressible()) return one_field_incompressible(name());
    return std::shared_ptr<const Material>(
        std::make_shared<InvariantMaterial<NeoHookeanEnergy>>(name(), NeoHookeanEnergy{e_.mu, e_.lambda()}));
  }
  double shear_modulus() const override { return e_.mu; }
  double inverse_bulk() const override {
    return choice_ == BulkChoice::bulk_modulus ? e_.inverse_bulk : e_.inverse_lambda;
  }
  double poisson() const override { return e_.poisson; }
  double young() const override { return e_.young; }
  bool defined_inverted() const override { return false; }

 private:
  LinearElastic e_;
  BulkChoice choice_;
};

}  // namespace

Result<MaterialPtr> neo_hookean(const ElasticConstants& constants) {
  auto e = linear_elastic("neo_hookean", constants, 0);
  if (!e) return Error{e.error()};
  return MaterialPtr(std::make_shared<NeoHookean>(e.value(), constants.bulk_choice));
}

}  // namespace isochor
