// Measurements of a pressure space: the numerical inf-sup test and the roughness of computed pressures.
#pragma once

#include "studies/formulations.h"
#include "studies/study.h"

namespace isochor::studies {

// Smallest singular value "beta" of the volume rows of a formulation on a unit cube of n^3 boxes held at one
// side, and the number of "zero modes" below 1e-6. Dense algebra: n up to about 6.
Probe inf_sup_probe(const Formulation& f, int n);

// What a dual solver meets on a unit cube of n^3 boxes held at one side, nodal rows of plain Tet4 at nu =
// 0.5: the "condition" of S = G K^-1 G^T + C preconditioned with the diagonal of M_p / mu, its smallest and
// largest eigenvalue, and the "iterations" of conjugate gradients to a residual of 1e-9 (at most 1,000) from
// a fixed right-hand side. Dense algebra: n up to about 6.
Probe dual_probe(double stabilization, int n);

// Runs the scene; "roughness" is the root mean square of pressure jumps across the faces of cells, relative.
Result<Numbers> pressure_roughness(const SceneDef& scene, int threads);

}  // namespace isochor::studies
