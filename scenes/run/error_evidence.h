// What runs of one scene with different settings say about the error of the best of them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "scenes/run/accuracy.h"

namespace isochor {

struct Evidence {
  std::vector<AccuracyEntry> entries;  // of the last run
  double largest = 0;                  // relative, of all entries
  std::string held_by;                 // the entry that has it
  std::string how;                     // what was compared, with which safety factor
};

// The largest difference of two runs, relative to what `better` answers.
double largest_difference(std::span<const Answer> worse, std::span<const Answer> better);

// Of one element on a mesh and on the same with every cell cut into eight. The grid convergence index of two
// meshes (Roache 1994): 3 |d| / (2^p - 1) with p = 2, which is the difference itself, and still no less than
// the error where only first order is left.
Evidence from_two_meshes(std::span<const Answer> coarse, std::span<const Answer> fine);
// Where some cells were refined in place of all, what the others leave is in no difference: half as much
// again.
inline constexpr double kLocalSafety = 1.5;
Evidence from_two_local_meshes(std::span<const Answer> coarse, std::span<const Answer> fine);

// Of three such meshes. Where differences shrink in one direction their ratio r = 2^p is the observed order
// (Richardson) and the index is 1.25 |d| / (r - 1); r counts as 4 at most, since more is luck or the coarsest
// mesh. Elsewhere the larger difference.
Evidence from_three_meshes(std::span<const Answer> coarsest, std::span<const Answer> coarse,
                           std::span<const Answer> fine);
// The same where some cells were refined: r counts as 2.5 at most.
Evidence from_three_local_meshes(std::span<const Answer> coarsest, std::span<const Answer> coarse,
                                 std::span<const Answer> fine);

// Errors of two causes that add up, entry by entry of the first.
Evidence together(const Evidence& a, const Evidence& b);

// Of two elements on one mesh: the difference is the error of the worse one, which bounds that of the better,
// with a factor for corners where both gain little.
inline constexpr double kElementSafety = 1.5;
Evidence from_two_elements(std::span<const Answer> worse, std::span<const Answer> better,
                           const std::string& worse_name);

}  // namespace isochor
