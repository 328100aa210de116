// Checks and converts elastic constants; shared by the materials.
#pragma once

#include <string>
#include <string_view>

#include "isochor/materials.h"

namespace isochor {

// Small-strain constants with the incompressible limit kept exact: what would be infinite is held as its
// inverse.
struct LinearElastic {
  double young = 0, poisson = 0, mu = 0;
  double inverse_lambda = 0;  // 1/lambda_L [1/Pa]; 0 when incompressible, infinity at nu = 0
  double inverse_bulk = 0;    // 1/K [1/Pa]; 0 when incompressible
  bool incompressible() const { return inverse_bulk == 0; }
  double lambda() const { return 1 / inverse_lambda; }
};

// `material` names the material in messages; nu in [lowest_poisson, 0.5].
Result<LinearElastic> linear_elastic(std::string_view material, const ElasticConstants& constants,
                                     double lowest_poisson);

// Why a one-field energy is refused at nu = 0.5.
Error one_field_incompressible(std::string_view material);

}  // namespace isochor
