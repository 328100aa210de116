// Shares a system out over ranks while it is compiled.
#pragma once

#include "engine/system/system.h"

namespace isochor {

// Owners of nodes: the parts of a mesh that the stencils are cut into.
std::unique_ptr<Shares> share_nodes(const SystemParts& parts);

// What this rank evaluates of a pool: of a large one what touches nodes of its own; small ones, and those
// whose stencils change their minds in the course of a solve (bounds, lags, barriers), are evaluated by all.
std::vector<StencilRun> shared_runs(const SystemParts& parts, const StencilPool& pool, const Shares& shares);

// With the gather lists of all rows and their treatment: owners of rows and unknowns, and only those Jacobian
// vectors that have their slots here. Fails with a message where rows are treated as no rank alone can.
Result<void> share_rows(const System& system, SystemTables& tables);

void find_row_begins(Gathers& gathers, Index rows);

}  // namespace isochor
