// A material of checked small-strain constants and ready energies: what most files of this folder end in.
#pragma once

#include "engine/elements/material_model.h"
#include "materials/elastic_constants.h"

namespace isochor {

struct EnergyModel {
  std::string_view name;
  LinearElastic small_strain;
  double inverse_kappa = 0;  // of the volume rows [1/Pa]
  std::shared_ptr<const Material> distortional;
  std::shared_ptr<const Material> complete;  // null at nu = 0.5
  bool defined_inverted = false;
  VolumeStrain strain = VolumeStrain::linear;  // MaterialModel::volume_strain()
  std::vector<std::string> warnings = {};
  bool separate_volume = true;
};
MaterialPtr make_model(EnergyModel model);

// 1/kappa [1/Pa] for kappa = lambda_L + shift, exact at nu = 0.5; infinity where kappa is 0 (the rows are
// left out). Refused where kappa would be negative.
Result<double> inverse_kappa(std::string_view material, const LinearElastic& e, double shift,
                             BulkChoice choice = BulkChoice::consistent);

// The kappa of a complete energy: 1 / inverse_kappa, 0 where the rows are left out.
inline double kappa_of(double inverse) {
  return 1 / inverse;  // 0 for an infinite inverse
}

}  // namespace isochor
