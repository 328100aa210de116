// How far apart the methods of one scene end.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "studies/study.h"

namespace isochor::studies {

struct SameEnd {
  std::string_view name;
  Method method;
  Solver solver = Solver::automatic;
};

// One for each way: runs the scene (its first `steps` steps; 0: all) with `saddle_point` and MUMPS (or what
// the build has) and with the method and solver of the way. "distance": largest difference of a node at the
// end over the length of its body; "iterations", "reference iterations"; "refused" 1 where the method does
// not take the scene, with nothing else.
std::vector<Probe> agreement_probes(const SceneDef& scene, std::span<const SameEnd> ways, int steps);

}  // namespace isochor::studies
