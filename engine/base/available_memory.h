// What a mesh will need and what this machine has left, so that one that is too large is refused in a
// sentence before it is taken apart.
#pragma once

#include <cstdint>
#include <string>

#include "isochor/mesh.h"

namespace isochor {

// Bytes that this process can still take: free memory of the machine, within the limits of its control group
// and of its address space. Infinite where nothing tells.
double available_memory();

enum class MeshUse : std::uint8_t { check, simulate };
// Why so many cells cannot be held, with size and remedy; empty when they can.
std::string too_large_for_memory(double cells, CellType type, MeshUse use);

}  // namespace isochor
