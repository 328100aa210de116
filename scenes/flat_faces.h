// Round bodies on meshes with flat faces: refinement keeps the faces, so that no comparison of runs sees what
// they cut off.
#pragma once

#include "isochor/mesh.h"

namespace isochor {

struct FlatFaces {
  double deficit = 0;  // relative, of sizes across: turn^2 / 6 of what a tenth of the surface exceeds
  double turn = 0;     // largest angle between neighboring faces of what looks round [rad]
};

// What looks round: faces that turn by some degrees from one to the next. A polygon of chords that each turn
// by a has sin(a)/a of the area of its circle. Edges that turn by more than 40 degrees are taken for what
// they are. Zero for flat sides.
FlatFaces flat_faces(const Mesh& mesh);

}  // namespace isochor
