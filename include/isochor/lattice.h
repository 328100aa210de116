// Hexahedral lattices around a triangle surface: the body is computed on cubes, the surface moves with them.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "isochor/export.h"
#include "isochor/mesh.h"

namespace isochor {

// A closed surface; its triangles may run either way around, but all the same way.
struct LatticeDef {
  std::vector<Vec3> points;      // [m]
  std::vector<Index> triangles;  // three points each
  double spacing = 0;            // edge of a cube [m]
  // Each cube is looked at in samples^3 parts: those inside or on the surface make it a cell. Gaps narrower
  // than a part are bridged, sheets thinner than a part stay whole.
  int samples = 4;
  // Parts of the body that pass through one cube without hanging together there get a cell each, in the same
  // place: the lips of a mouth stay apart whatever the spacing. The lattice is then no manifold.
  bool keep_apart = true;
};

// Where a point of the surface lies: weighted nodes of one cell.
struct EmbeddedPoint {
  Index cell = -1;
  std::array<Index, 8> nodes{};
  std::array<double, 8> weights{};
};

struct Lattice {
  Mesh mesh;  // hexahedra, one region "body"; cells are full cubes, also where the surface cuts them
  std::vector<EmbeddedPoint> embedding;  // one a surface point
};

ISOCHOR_API Result<Lattice> lattice_mesh(const LatticeDef& def);

// Where the surface is when the nodes of the lattice are at `positions`.
ISOCHOR_API std::vector<Vec3> embedded_surface(const Lattice& lattice, std::span<const Vec3> positions);

}  // namespace isochor
