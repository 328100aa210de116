// Where the locking of soft robots was shown first (Francu et al. 2021, table 2 and figures 2, 10 and 11), on
// meshes and with formulations of ours.
#pragma once

#include "studies/study.h"

namespace isochor::studies {

void add_robot_locking(std::vector<Cell>& out, bool quick);
Section spine_section(std::span<const Measured> all);
Section tube_section(std::span<const Measured> all);

}  // namespace isochor::studies
