#include "materials/energy_model.h"

#include <cstdio>
#include <limits>

namespace isochor {

namespace {

class Model final : public MaterialModel {
 public:
  explicit Model(EnergyModel m) : m_(std::move(m)) {}
  std::string_view name() const override { return m_.name; }
  std::shared_ptr<const Material> distortional() const override { return m_.distortional; }
  Result<std::shared_ptr<const Material>> complete() const override {
    if (!m_.complete) return one_field_incompressible(m_.name);
    return m_.complete;
  }
  double shear_modulus() const override { return m_.small_strain.mu; }
  double inverse_bulk() const override { return m_.inverse_kappa; }
  double poisson() const override { return m_.small_strain.poisson; }
  double young() const override { return m_.small_strain.young; }
  bool defined_inverted() const override { return m_.defined_inverted; }
  VolumeStrain volume_strain() const override { return m_.strain; }
  std::vector<std::string> warnings() const override { return m_.warnings; }
  bool has_separate_volume() const override { return m_.separate_volume; }

 private:
  EnergyModel m_;
};

}  // namespace

MaterialPtr make_model(EnergyModel model) {
  return std::make_shared<Model>(std::move(model));
}

Result<double> inverse_kappa(std::string_view material, const LinearElastic& e, double shift,
                             BulkChoice choice) {
  if (choice == BulkChoice::bulk_modulus) return e.inverse_bulk;
  if (e.incompressible()) return 0.0;
  // kappa (1 - 2 nu), which stays finite: lambda_L = 2 mu nu / (1 - 2 nu).
  const double gap = 1 - 2 * e.poisson;
  const double scaled = 2 * e.mu * e.poisson + shift * gap;
  if (scaled < 0) {
    char text[200];
    std::snprintf(text, sizeof text,
                  ": the volume part would need a negative modulus (%.6g Pa) to give Poisson's ratio %.6g at "
                  "small strain; take a larger ratio",
                  scaled / gap, e.poisson);
    return Error{std::string(material) + text};
  }
  return scaled == 0 ? std::numeric_limits<double>::infinity() : gap / scaled;
}

}  // namespace isochor
