// Vibrations of small bodies, to find spurious modes: shapes of low energy that the mesh invents.
#pragma once

#include "studies/formulations.h"
#include "studies/study.h"

namespace isochor::studies {

// Natural frequencies of a bar of 2 x 1 x 1 m (mu = 1 Pa, density 1 kg/m^3, nu = 0.49995), about a state that
// is stretched to `stretch` without change of volume, ends held, or free at rest where `stretch` is 0.
// `nodes` boxes an edge for linear elements (even), half of it for Tet10, so that the nodes are the same.
// Dense algebra: nodes <= 4. "f1" .. "f30": the lowest frequencies [rad/s] that are not zero; "zero modes" (6
// of a free body); "unstable": negative eigenvalues; "rough": the largest share of a mode among these that
// differs from the mean of its neighbors (below 1 for waves of several elements, 1 and more for modes from
// node to node).
Probe modes_probe(const Formulation& f, int nodes, double stretch);

}  // namespace isochor::studies
