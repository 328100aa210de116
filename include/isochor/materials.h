// Hyperelastic materials a body can be made of.
#pragma once

#include <functional>
#include <memory>
#include <string>
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

// ---- laws with constants of their own
//
// Each law is a strain part W(I, II) with I = tr C, II = (I^2 - tr C^2)/2, C = F^T F, in one of two forms:
//   full:     W(I, II) - c B(J) + U(J), where c = 2 dW/dI + 4 dW/dII at rest balances its stress, with
//             B = J - 1 beside the quadratic U and B = log J beside the others;
//   isochoric (the names with that prefix; "uncoupled" in FEBio, what Abaqus means by a hyperelastic law):
//   the
//             same W of the invariants of J^(-1/3) F, plus U(J); kappa is then the bulk modulus.
// The distortional energy, for volume rows, is all but U(J); the rows carry kappa, and unless they are asked
// for another strain they measure the one whose square makes U. Constants that make the law unstable at some
// stretch are accepted, with a warning of the world that names the stretches at which it is stable; what is
// unstable at rest is refused. Errors name the constant, its value and what it may be. docs/materials has the
// names of the same constants in FEBio and Abaqus.

// U(J), times kappa.
enum class VolumeEnergy : std::uint8_t {
  quadratic,    // 1/2 (J - 1)^2: as Abaqus's polynomial laws
  logarithmic,  // 1/2 log^2 J: FEBio unless it is told otherwise
  mixed,        // 1/4 (J^2 - 1 - 2 log J): Abaqus's Arruda-Boyce and Holzapfel-Gasser-Ogden laws
};

// `poisson` beside it is Poisson's ratio at small strain; `bulk` may be given in its place.
struct VolumePart {
  VolumeEnergy energy = VolumeEnergy::quadratic;
  double bulk = -1;  // kappa [Pa] > 0; infinity: incompressible
};

// W = c1 (I - 3) + c2 (II - 3) + c20 (I - 3)^2 + c11 (I - 3) (II - 3) + c02 (II - 3)^2, with mu_L = 2 (c1 +
// c2) > 0 (Rivlin 1948; Mooney 1940 with two terms).
struct MooneyRivlinConstants {
  double c1 = 0, c2 = 0;             // [Pa], c10 and c01 elsewhere
  double poisson = 0.5;              // [-], at most 0.5; full: it must leave kappa >= 0
  double c20 = 0, c11 = 0, c02 = 0;  // [Pa]
  VolumePart volume = {};
};
ISOCHOR_API Result<MaterialPtr> mooney_rivlin(const MooneyRivlinConstants& constants);
ISOCHOR_API Result<MaterialPtr> isochoric_mooney_rivlin(const MooneyRivlinConstants& constants);

// W = sum over i of c[i - 1] (I - 3)^i, with mu_L = 2 c[0] > 0 (Yeoh 1993, who takes three terms).
struct YeohConstants {
  std::vector<double> c;  // [Pa], at least one
  double poisson = 0.5;
  VolumePart volume = {};
};
ISOCHOR_API Result<MaterialPtr> yeoh(const YeohConstants& constants);
ISOCHOR_API Result<MaterialPtr> isochoric_yeoh(const YeohConstants& constants);

// W = mu0/2 (I - 3) + gamma/2 (exp(mu1 (I - 3)) - 1), with mu_L = mu0 + gamma mu1 (Fung's exponential;
// Demiray 1972).
struct FungConstants {
  double mu0 = 0;        // [Pa] >= 0
  double mu1 = 0;        // [-] >= 0, how soon it stiffens
  double gamma = 0;      // [Pa] >= 0
  double poisson = 0.5;  // full: it must leave lambda_L + mu_L - 2 gamma mu1^2 >= 0 beside the quadratic U
  VolumePart volume = {};
};
ISOCHOR_API Result<MaterialPtr> fung(const FungConstants& constants);
ISOCHOR_API Result<MaterialPtr> isochoric_fung(const FungConstants& constants);

// W = sum over i = 1 ... 5 of mu beta_(i-1)/(2 i) (I^i - 3^i) with beta_0 = 1 and mu_L = mu (1 + 3 beta1 + 9
// beta2 + 27 beta3 + 81 beta4): the series of Arruda & Boyce 1993. For chains of N links, whose stretch locks
// at sqrt(N), beta1 = 1/(5 N), beta2 = 11/(175 N^2), beta3 = 19/(875 N^3), beta4 = 519/(67375 N^4).
struct ArrudaBoyceConstants {
  double mu = 0;                // [Pa] > 0
  double beta1 = 0, beta2 = 0;  // [-] >= 0
  double poisson = 0.5;         // full: it must leave kappa >= 0
  double beta3 = 0, beta4 = 0;  // [-] >= 0
  double locking_stretch = 0;   // [-] > 0, in place of the betas
  VolumePart volume = {};
};
ISOCHOR_API Result<MaterialPtr> arruda_boyce(const ArrudaBoyceConstants& constants);
ISOCHOR_API Result<MaterialPtr> isochoric_arruda_boyce(const ArrudaBoyceConstants& constants);

// W = -mu jm/2 log(1 - (I - 3)/jm), with mu_L = mu (Gent 1996). It has no value from I - 3 = jm on.
struct GentConstants {
  double mu = 0;  // [Pa] > 0
  double jm = 0;  // [-] > 0: I - 3 where the chains are straight
  double poisson = 0.5;
  VolumePart volume = {};
};
ISOCHOR_API Result<MaterialPtr> gent(const GentConstants& constants);
ISOCHOR_API Result<MaterialPtr> isochoric_gent(const GentConstants& constants);

// W = c1 (exp(c2 (I - 3)) - 1) - c1 c2/2 (II - 3), with mu_L = c1 c2 (Veronda & Westmann 1970).
struct VerondaWestmannConstants {
  double c1 = 0;  // [Pa] > 0
  double c2 = 0;  // [-] > 0
  double poisson = 0.5;
  VolumePart volume = {};
};
ISOCHOR_API Result<MaterialPtr> veronda_westmann(const VerondaWestmannConstants& constants);
ISOCHOR_API Result<MaterialPtr> isochoric_veronda_westmann(const VerondaWestmannConstants& constants);

// Holmes & Mow 1990. Full: (lambda_L + 2 mu)/(4 beta) (exp Q - 1) with Q = beta ((2 mu - lambda_L) (I - 3) +
// lambda_L (II - 3))/(lambda_L + 2 mu) - 2 beta log J, which has no part U(J) of its own: with volume rows it
// is that energy at lambda_L = 0 and kappa = lambda_L, and `volume.energy` must be logarithmic. Isochoric:
// mu/(2 beta) (exp(beta (I - 3)) - 1).
struct HolmesMowConstants {
  double mu = 0;         // [Pa] > 0, mu_L
  double beta = 0;       // [-] >= 0, how soon it stiffens; 0: the limit
  double poisson = 0.5;  // full: in [0, 0.5]
  VolumePart volume = {};
};
ISOCHOR_API Result<MaterialPtr> holmes_mow(const HolmesMowConstants& constants);
ISOCHOR_API Result<MaterialPtr> isochoric_holmes_mow(const HolmesMowConstants& constants);

// W = sum mu/alpha (s_0^alpha + s_1^alpha + s_2^alpha - 3) over the principal stretches s, with mu_L = sum mu
// alpha/2 > 0 (Ogden 1972). Undefined for inverted elements.
struct OgdenTerm {
  double mu = 0;     // [Pa]
  double alpha = 0;  // [-], not zero
};
struct OgdenConstants {
  std::vector<OgdenTerm> terms;
  double poisson = 0.5;                                 // full: in [0, 0.5]
  VolumePart volume = {VolumeEnergy::logarithmic, -1};  // full: no other
};
ISOCHOR_API Result<MaterialPtr> ogden(const OgdenConstants& constants);
ISOCHOR_API Result<MaterialPtr> isochoric_ogden(const OgdenConstants& constants);

// Materials by name, with constants that a paper or a data sheet states.
struct NamedMaterial {
  std::string name;         // "ecoflex_00_30_..."
  std::string description;  // what it is, and the law with its constants
  std::string source;       // who states the numbers, and where
  int year = 0;
  double density = 0;  // [kg/m^3]; 0: the source does not say
  std::function<Result<MaterialPtr>(double poisson)> make;
};
ISOCHOR_API const std::vector<NamedMaterial>& named_materials();
// The error lists the names that there are.
ISOCHOR_API Result<MaterialPtr> named_material(const std::string& name, double poisson = 0.5);

// ---- additions to a material of any kind
// ----------------------------------------------------------------------------------

// How a family of fibers pulls, by E = H : (C - 1) with H = dispersion 1 + (1 - 3 dispersion) a a^T, or by
// the stretch s of its fibers, s^2 = a . C a.
enum class FiberLaw : std::uint8_t {
  exponential,  // k1/(exponent k2) (exp(k2 E^exponent) - 1) for E > 0; k2 = 0: its limit
  toe,          // s dpsi/ds = k1 (exp(k2 (s - 1)) - 1) for s > 1, straight_modulus s + const from s =
                // straight_stretch on (Weiss, Maker & Govindjee 1996); without dispersion
};

// Fibers that only pull (exponential: Holzapfel, Gasser & Ogden 2000, with dispersion Gasser, Ogden &
// Holzapfel 2006).
struct FiberFamily {
  Vec3 direction{1, 0, 0};  // at rest; any length
  double k1 = 0;            // [Pa] > 0
  double k2 = 0;            // [-] >= 0, how soon they stiffen
  double dispersion = 0;    // 0: all parallel; 1/3: no direction at all
  // One a cell of the body's mesh, in place of `direction`.
  std::vector<Vec3> directions = {};
  FiberLaw law = FiberLaw::exponential;
  double exponent = 2;          // [-] > 1, of the exponential law; below 2 the tangent has no bound at rest
  bool isochoric = false;       // strains of J^(-1/3) F
  double straight_modulus = 0;  // [Pa] >= 0, of the toe law
  double straight_stretch = 0;  // [-] > 1, of the toe law
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
