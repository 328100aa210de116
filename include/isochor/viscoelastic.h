// Solids whose stress fades: a Prony series beside a hyperelastic material.
#pragma once

#include <vector>

#include "isochor/materials.h"

namespace isochor {

// One term of G(t) = G0 (1 - sum_i ratio_i (1 - exp(-t / time_i))), the shear relaxation modulus.
struct PronyTerm {
  double ratio = 0;  // share of the instantaneous shear modulus [-], positive; all together below 1
  double time = 0;   // of relaxation [s] > 0
};

// What the time of a statics is. Dynamics are in seconds.
enum class StaticTime : std::uint8_t {
  long_term,  // a load factor: everything has relaxed, the shear modulus is G0 (1 - sum_i ratio_i)
  seconds,    // seconds that pass, slowly enough for inertia not to matter
};

// `base`, a material whose energy without the volume part is isochoric (a name with that prefix), becomes the
// instantaneous law: (1 - sum_i ratio_i) of it stays, and each term is a Maxwell element at finite strain
// beside it, F = F_e F_v, whose spring has the shear modulus ratio_i G0 and is quadratic in the logarithmic
// strain (docs/materials/viscoelastic.md). The volume part does not relax. The memory is part of the state.
// Fields of stiffness apply to springs as well; put them, and fibers, around this material. Refused with the
// reason: no term, ratios or times that are not positive, ratios that sum to 1 or more, a base that is not
// isochoric or has a memory already. In worlds: implicit_midpoint(), and continuation() in seconds.
ISOCHOR_API Result<MaterialPtr> with_prony_series(MaterialPtr base, const std::vector<PronyTerm>& terms,
                                                  StaticTime statics = StaticTime::long_term);

}  // namespace isochor
