// Hyperelastic materials a body can be made of.
#pragma once

#include <memory>

#include "isochor/types.h"

namespace isochor {

class MaterialModel;  // engine-side; hosts only pass it around

// A material with its parameters, checked. Copies share the same object.
using MaterialPtr = std::shared_ptr<const MaterialModel>;

// Which bulk modulus the volume rows carry.
enum class BulkChoice : std::uint8_t {
  consistent,    // gives E and nu back at small strain (default)
  bulk_modulus,  // kappa = K = E / (3 (1 - 2 nu)), the choice of Frâncu et al. 2021; does not give nu back
};

// Linear-elastic constants at small strain: either E and nu, or mu and the first Lamé parameter, or mu and
// the bulk modulus. Exactly one pair must be given.
struct ElasticConstants {
  double young = 0;    // E [Pa] > 0
  double poisson = 0;  // nu in [0, 0.5]; 0.5: incompressible
  double mu = 0;       // shear modulus [Pa] > 0, instead of E and nu
  double lambda = -1;  // first Lamé parameter [Pa] >= 0, with mu; infinity: incompressible
  double bulk = -1;    // bulk modulus K [Pa], with mu; infinity: incompressible
  BulkChoice bulk_choice = BulkChoice::consistent;
};

// psi = mu/2 (I - 3) - mu log J, with the volume rows or with lambda/2 log^2 J. Undefined for inverted
// elements.
Result<MaterialPtr> neo_hookean(const ElasticConstants& constants);

// psi = mu/2 (I - 3) - mu (J - 1), with the volume rows or with lambda/2 (J - 1)^2: Smith, de Goes & Kim
// 2018, eq. 13. Defined for inverted elements.
Result<MaterialPtr> stable_neo_hookean(const ElasticConstants& constants);

}  // namespace isochor
