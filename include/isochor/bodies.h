// What a body is: its mesh, its element and its materials.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "isochor/materials.h"
#include "isochor/mesh.h"

namespace isochor {

// How the distortion of a body is sampled.
enum class Element : std::uint8_t {
  tet4,                // one energy a tet: cheapest, stiff in bending
  tet4_edge_smoothed,  // energy on patches around edges: the default for accuracy per second
  tet10,               // quadratic displacements; the mesh is raised to Tet10 where it is Tet4
  hex8,                // trilinear hexahedra with eight points; needs a Hex8 mesh
  tri3,                // a thin body of triangles; stiffness and mass are those of shells on it (ShellDef)
};

struct RegionMaterial {
  std::string region;  // empty: every region not named elsewhere
  MaterialPtr material;
  double density = 1000;  // [kg/m^3]
};

struct BodyDef {
  std::string name = "body";
  Mesh mesh;
  Element element = Element::tet4_edge_smoothed;
  std::vector<RegionMaterial> materials;  // none on a thin body, whose shells have their own
  // Barrier against single tets turning over, edge-smoothed bodies only: energy -stiffness mu V
  // log^3(J/threshold) for J < threshold. 0 switches it off. By default 1, with a threshold of at most 0.1
  // where nu < 0.49, whose true compression it would falsify.
  std::optional<double> guard_stiffness;
  double guard_threshold = 0.5;
};

}  // namespace isochor
