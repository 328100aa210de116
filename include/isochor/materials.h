// Hyperelastic materials a body can be made of.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "isochor/export.h"
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

// Each function below makes a material that can be used with volume rows (its energy is then the distortional
// part) or without (the complete one-field energy; refused at nu = 0.5). I = tr F^T F, J = det F, sigma_i the
// principal stretches. Unless said otherwise E and nu come back at small strain. One page each in
// docs/materials.

// psi = mu/2 (I - 3) - mu log J, complete with lambda/2 log^2 J. Undefined for inverted elements. nu in [0,
// 0.5].
ISOCHOR_API Result<MaterialPtr> neo_hookean(const ElasticConstants& constants);

// The same with Ogden's volume term lambda/2 (J - 1)^2 in the complete energy.
ISOCHOR_API Result<MaterialPtr> neo_hookean_ogden(const ElasticConstants& constants);

// psi = mu/2 (I - 3) - mu (J - 1), complete with lambda/2 (J - 1)^2: Smith, de Goes & Kim 2018, eq. 13.
// Defined for inverted elements. nu in [-0.99, 0.5]. Mooney's solid mu/2 (I - 3), its multiplier counted from
// rest, is this one.
ISOCHOR_API Result<MaterialPtr> stable_neo_hookean(const ElasticConstants& constants);

// The same paper's eq. 14: mu/2 (I - 3) - mu/2 log(I + 1) + lambda/2 (J - alpha)^2, stiff also at the origin.
ISOCHOR_API Result<MaterialPtr> stable_neo_hookean_barrier(const ElasticConstants& constants);

// psi = mu/2 (J^(-2/3) I - 3), complete with K/2 (J - 1)^2 (Bonet & Wood; Rivlin). nu in [-0.99, 0.5].
// Undefined for inverted elements.
ISOCHOR_API Result<MaterialPtr> isochoric_neo_hookean(const ElasticConstants& constants);

// The same with J^(-1/3) continued to the second order below J = threshold: defined for inverted elements.
ISOCHOR_API Result<MaterialPtr> isochoric_extended(const ElasticConstants& constants, double threshold = 0.1);

// psi = mu |F - R|^2, complete with lambda/2 tr^2(S - 1); R the rotation of F = R S. nu in [0, 0.5].
ISOCHOR_API Result<MaterialPtr> corotated(const ElasticConstants& constants);

// The same with lambda/2 (J - 1)^2.
ISOCHOR_API Result<MaterialPtr> fixed_corotated(const ElasticConstants& constants);

// psi = mu |E|^2, complete with lambda/2 tr^2 E; E Green's strain. Softens and collapses under compression.
ISOCHOR_API Result<MaterialPtr> stvk(const ElasticConstants& constants);

// The same with resistance/12 ((1 - J)/6)^3 for J < 1; resistance > 0 [Pa].
ISOCHOR_API Result<MaterialPtr> stvk_resistant(const ElasticConstants& constants, double resistance);

// Linear elasticity: small strains and small rotations only. With volume rows: the deviatoric part.
ISOCHOR_API Result<MaterialPtr> linear(const ElasticConstants& constants);

// psi = c1 (I - 3) + c2 (II - 3), II = (I^2 - tr C^2)/2, with mu_L = 2 (c1 + c2).
struct MooneyRivlinConstants {
  double c1 = 0, c2 = 0;  // [Pa] >= 0, not both zero
  double poisson = 0.5;   // at small strain, in [-0.99, 0.5]; it must leave lambda_L + 2 c1 >= 0
};
ISOCHOR_API Result<MaterialPtr> mooney_rivlin(const MooneyRivlinConstants& constants);

// psi = mu0/2 (I - 3) + gamma/2 (exp(mu1 (I - 3)) - 1), with mu_L = mu0 + gamma mu1.
struct FungConstants {
  double mu0 = 0;        // [Pa] >= 0
  double mu1 = 0;        // [-] >= 0, how soon it stiffens
  double gamma = 0;      // [Pa] >= 0
  double poisson = 0.5;  // at small strain; it must leave lambda_L + mu_L - 2 gamma mu1^2 >= 0
};
ISOCHOR_API Result<MaterialPtr> fung(const FungConstants& constants);

// psi = mu/2 (I - 3) + mu beta1/4 (I^2 - 9) + mu beta2/6 (I^3 - 27), with mu_L = mu (1 + 3 beta1 + 9 beta2).
// For chains of N links beta1 = 1/(5 N) and beta2 = 11/(175 N^2).
struct ArrudaBoyceConstants {
  double mu = 0;                // [Pa] > 0
  double beta1 = 0, beta2 = 0;  // [-] >= 0
  double poisson = 0.5;         // at small strain; it must leave lambda_L + mu (1 + beta1 - 3 beta2) >= 0
};
ISOCHOR_API Result<MaterialPtr> arruda_boyce(const ArrudaBoyceConstants& constants);

// psi = sum mu/alpha (sigma_0^alpha + sigma_1^alpha + sigma_2^alpha - 3) - (sum mu) log J, with mu_L = sum mu
// alpha / 2. Undefined for inverted elements.
struct OgdenTerm {
  double mu = 0;     // [Pa], of the sign of alpha
  double alpha = 0;  // [-], not zero
};
struct OgdenConstants {
  std::vector<OgdenTerm> terms;
  double poisson = 0.5;  // at small strain, in [0, 0.5]
};
ISOCHOR_API Result<MaterialPtr> ogden(const OgdenConstants& constants);

// ---- additions to a material of any kind
// ----------------------------------------------------------------------------------

// Fibers that only pull: k1/(2 k2) (exp(k2 E^2) - 1) for E = a . C a - 1 > 0 (Holzapfel, Gasser & Ogden
// 2000); k2 = 0: k1/2 E^2.
struct FiberFamily {
  Vec3 direction{1, 0, 0};  // at rest; any length
  double k1 = 0;            // [Pa] > 0
  double k2 = 0;            // [-] >= 0, how soon they stiffen
  double dispersion = 0;    // 0: all parallel; 1/3: no direction at all
  // One a cell of the body's mesh, in place of `direction`.
  std::vector<Vec3> directions;
};
ISOCHOR_API Result<MaterialPtr> with_fibers(MaterialPtr matrix, const std::vector<FiberFamily>& families);

// Stiffness that varies from cell to cell at the same Poisson's ratio: energy and bulk modulus times a
// positive factor, one a cell of the body's mesh.
ISOCHOR_API Result<MaterialPtr> with_stiffness_field(MaterialPtr base, std::vector<double> factor);

// Poisson's ratio that varies from cell to cell: `law` makes the material for one ratio, its other constants
// are its own affair (with E fixed the shear modulus changes with nu). 0.5 is allowed where volume rows carry
// the bulk modulus; a ratio that leaves the law no volume part (kappa = 0) is refused.
ISOCHOR_API Result<MaterialPtr> with_poisson_field(const std::function<Result<MaterialPtr>(double)>& law,
                                                   const std::vector<double>& poisson);

// Lambda U(J; beta) with U = (J - 1)^2 (beta (J - 1)^2 + 6) / 12, added to the energy of every element: holds
// single elements against crushing where volume rows keep only the volume of a zone (Sheen, Larionov & Pai
// 2021). At small strain it adds its modulus to the bulk modulus.
struct CompressionPenalty {
  double modulus = 0;  // Lambda [Pa] > 0
  double beta = 9;     // [-] >= 0, how soon it stiffens; 0: quadratic
};
ISOCHOR_API Result<MaterialPtr> with_compression_penalty(MaterialPtr base, const CompressionPenalty& penalty);

}  // namespace isochor
