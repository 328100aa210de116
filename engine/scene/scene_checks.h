// What makes a scene unsolvable before the first step, each with its name and remedy.
#pragma once

#include <map>

#include "engine/scene/builder.h"
#include "engine/scene/supports.h"

namespace isochor {

struct SceneFacts {
  const std::vector<BodyData>& bodies;
  const SystemParts& parts;
  const SupportPrescriber& supports;
  std::map<std::string, std::vector<Index>> held_by;  // nodes that each support holds, in any direction
};

// Connected parts of all bodies: a part number for every node. Stencils of any pool connect, so bodies that
// are tied together count as one.
std::vector<Index> connected_parts(const SceneFacts& facts, Index& count);

// Thin bodies have no mass and no stiffness but that of shells.
Result<void> check_thin_bodies(const SceneFacts& facts);

// Statics: every connected part must be held against its six rigid motions.
Result<void> check_anchored(const SceneFacts& facts);

// Hard rows that repeat each other, outnumber the displacements, or enclose a body whose boundary cannot
// move.
Result<void> check_hard_rows(const SceneFacts& facts);

}  // namespace isochor
