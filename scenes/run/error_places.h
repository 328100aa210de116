// Where on a mesh the errors of answers come from, and which cells are worth refining.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scenes/run/accuracy.h"
#include "scenes/run/run.h"

namespace isochor {

// Of metrics and probes, in the order of answers_of(), at the state of the world. What has no derivative gets
// the error of the strain alone, with a note that says why.
std::vector<AnswerOrigin> origins_of_answers(const SceneDef& scene, BuiltScene& built,
                                             const RunResult& result);

// What the cells of a body have in the error of any answer at most; empty without origins.
std::vector<double> largest_shares(const std::vector<AnswerOrigin>& origins, std::size_t body);

// The fewest cells that hold the share `most` of the error of every answer, each body's in ascending order
// (Doerfler 1996).
std::vector<std::vector<Index>> cells_to_refine(const std::vector<AnswerOrigin>& origins, double most);

// "tip: three quarters of its error come from 12 % of the cells, around (0.1, 0, 0.02) m of "finger", region
// "wall""; empty where no cell has any.
std::string describe_origin(const AnswerOrigin& origin, const BuiltScene& built);

// Puts it in words beside what the errors are worth.
void add_places(const std::vector<AnswerOrigin>& origins, std::vector<AccuracyEntry>& entries);

}  // namespace isochor
