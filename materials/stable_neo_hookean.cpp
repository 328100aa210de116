#include "materials/stable_neo_hookean.h"

#include <limits>

#include "engine/material_model.h"
#include "materials/elastic_constants.h"

namespace isochor {

namespace {

class StableNeoHookean final : public MaterialModel {
 public:
  StableNeoHookean(const LinearElastic& e, BulkChoice choice) : e_(e), choice_(choice) {}
  std::string_view name() const override { return "stable_neo_hookean"; }
  std::shared_ptr<const Material> distortional() const override {
    return std::make_shared<InvariantMaterial<StableNeoHookeanEnergy>>(name(),
                                                                       StableNeoHookeanEnergy{e_.mu, 0});
  }
  Result<std::shared_ptr<const Material>> complete() const override {
    if (e_.incompressible()) return one_field_incompressible(name());
    const double lambda_L = e_.poisson == 0 ? 0 : e_.lambda();
    return std::shared_ptr<const Material>(std::make_shared<InvariantMaterial<StableNeoHookeanEnergy>>(
        name(), StableNeoHookeanEnergy{e_.mu, lambda_L + e_.mu}));
  }
  double shear_modulus() const override { return e_.mu; }
  double inverse_bulk() const override {
    if (choice_ == BulkChoice::bulk_modulus) return e_.inverse_bulk;
    // lambda_L + mu = E / (2 (1 + nu) (1 - 2 nu)): finite at nu = 0, its inverse exact at nu = 0.5.
    return 2 * (1 + e_.poisson) * (1 - 2 * e_.poisson) / e_.young;
  }
  double poisson() const override { return e_.poisson; }
  double young() const override { return e_.young; }
  bool defined_inverted() const override { return true; }

 private:
  LinearElastic e_;
  BulkChoice choice_;
};

}  // namespace

Result<MaterialPtr> stable_neo_hookean(const ElasticConstants& constants) {
  auto e = linear_elastic("stable_neo_hookean", constants, -0.99);
  if (!e) return Error{e.error()};
  return MaterialPtr(std::make_shared<StableNeoHookean>(e.value(), constants.bulk_choice));
}

}  // namespace isochor
