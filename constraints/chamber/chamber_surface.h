// The surface of a chamber: faces of a body, turned one way, and the openings that they leave.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "engine/scene/builder.h"

namespace isochor {

// Nodes of a face, corners first, turned so that its normal points from the chamber into the solid.
using ChamberFace = std::vector<Index>;

inline std::size_t corners_of(const ChamberFace& f) {
  return f.size() == 4 ? 4 : 3;
}

// Turns faces against the outward normals of the cells that own them; refuses faces that are not on the
// boundary.
Result<void> orient_faces(const BodyData& body, std::vector<ChamberFace>& faces, std::span<const Vec3> rest,
                          const std::string& who);

// Turns the faces of a thin body, which all go round one way, so that they look out of what they enclose.
Result<void> orient_sheet(const BodyData& body, std::vector<ChamberFace>& faces, std::span<const Vec3> rest,
                          const std::string& who);

// Boundary loops of the oriented faces: corner nodes in order, with the mid-edge node after each corner for
// Tet10.
//
// A surface is closed where its oriented edges cancel, however many faces meet in one: the volume is a sum
// over faces, whichever of them are thought to be joined.
Result<std::vector<std::vector<Index>>> boundary_loops(const std::vector<ChamberFace>& faces,
                                                       const std::string& who);

}  // namespace isochor
