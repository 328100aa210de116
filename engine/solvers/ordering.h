// Fill-reducing pivot sequence, computed on the quotient graph of a pattern's groups.
#pragma once

#include <mutex>
#include <span>
#include <string_view>
#include <vector>

#include "engine/solvers/linear_solver.h"

namespace isochor {

enum class OrderingMethod : std::uint8_t {
  best,      // METIS where it is built in, else minimum degree
  metis,     // nested dissection
  pord,      // nested dissection with minimum fill at the ends (part of MUMPS), of unknowns, not groups
  amf,       // approximate minimum fill (part of MUMPS)
  amd,       // approximate minimum degree
  as_given,  // by group, as the caller numbered them
};

struct Ordering {
  std::vector<Index> position;  // of an unknown in the pivot sequence
  std::vector<Index> unknown;   // the inverse: which unknown is eliminated at a position
  Index dense = 0;              // how many unknowns at the end were taken out of the graph as dense
  OrderingMethod method = OrderingMethod::as_given;  // the one that was used
};

// Groups absent: every unknown is a group of its own. An unknown that touches a large part of all groups is
// taken out of the graph, which it would only blur, and goes last; a group of multiplier rows alone is moved
// behind the first group with an unknown that it constrains, for a zero diagonal is no pivot before that.
Ordering order_unknowns(const SymmetricPattern& pattern, OrderingMethod method = OrderingMethod::best);
// One for each of the methods, all on groups unless pord is among them.
std::vector<Ordering> order_unknowns(const SymmetricPattern& pattern,
                                     std::span<const OrderingMethod> methods);

// The pattern that a scene starts with, whose pivot sequence serves what comes of it as long as that costs
// little more (best_ordering() in front_tree.h). It is found when it is first asked for and depends on
// nothing else, so that a run does not depend on where it was started.
struct OrderingBase {
  SymmetricPattern pattern;
  Ordering ordering;
  double operations = 0;  // multiplications of the factorization; 0: not found yet
  std::mutex mutex;       // systems of several worlds may share it
};

bool have_metis();
std::string_view metis_version();  // empty when not built in

}  // namespace isochor
