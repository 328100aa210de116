// Rigid motions of parts that nothing holds, and words for them.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "engine/base/base.h"

namespace isochor {

std::string point_text(const Vec3& v);

// Motions, orthonormal and six numbers each: the translation at some point, then the rotation times some
// size. Those that next to nothing resists by `gram`, a symmetric matrix over the six.
std::vector<double> free_motions(const std::array<double, 36>& gram);

// Words for them; the point is `around`, the size is `size`.
std::string describe_motions(std::span<const double> motions, const Vec3& around, double size);

}  // namespace isochor
