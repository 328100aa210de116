// How far apart the methods of one scene end.
#pragma once

#include <string>

#include "studies/study.h"

namespace isochor::studies {

// Runs the scene twice, with `saddle_point` and MUMPS (or what the build has) and with the method and solver
// asked for. "distance": largest difference of a node at the end over the length of its body; "iterations",
// "reference iterations"; "refused" 1 where the method does not take the scene, with nothing else.
Probe agreement_probe(const SceneDef& scene, Method method, Solver solver);

}  // namespace isochor::studies
