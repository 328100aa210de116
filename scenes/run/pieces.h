// A frame that several processes write, each its own part of the cells: NAME.pvtu and pieces NAME_RANK.vtu.
#pragma once

#include <string>

#include "isochor/mesh_io.h"
#include "isochor/ranks.h"

namespace isochor {

// Cells of a rank are an even part of all, in their order; ranks that
// get none have no piece. All ranks call it with the same grid and the same
// name; `path` ends in .pvtu, which the root writes once all pieces are there. Fails on all ranks where one
// fails.
Result<void> write_pieces(const std::string& path, const VtkGrid& grid, const Ranks& ranks);

// An error on all ranks where there is one on any.
Result<void> on_all(Result<void> here, const Ranks& ranks);

// NAME_RANK.vtu of NAME.pvtu.
std::string piece_file(const std::string& pvtu, int rank);

}  // namespace isochor
