// Where a body is best cut open to see what is inside.
#pragma once

#include <span>

#include "results_page.h"

namespace isochor {

// The plane across each axis that shows most of what the triangles enclose, and the axis of the three whose
// plane shows the most. Planes through the middle of the whole and through that of every connected piece are
// tried; of axes that show as much (to a fiftieth) the first of `order` is taken. The triangles of a piece
// need not close it.
PageSection section_through(std::span<const Vec3> points, std::span<const Index> triangles,
                            std::array<int, 3> order);

}  // namespace isochor
