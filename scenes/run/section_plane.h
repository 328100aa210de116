// Where a body is best cut open to see what is inside.
#pragma once

#include <span>

#include "results_page.h"

namespace isochor {

// The plane across each axis that shows most of what the triangles enclose, and the axis of the three whose
// plane shows the most. Planes through the middle of the whole and through that of every connected piece are
// tried. `up` is the upright axis ('y' or 'z'): a level plane, which takes the lid off, is taken where it
// shows two and a half times as much as upright ones; of these the one that faces the first camera where both
// show as much (to a fiftieth). The triangles of a piece need not close it.
PageSection section_through(std::span<const Vec3> points, std::span<const Index> triangles, char up);

}  // namespace isochor
