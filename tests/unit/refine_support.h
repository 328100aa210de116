// What meshes are asked before and after they are refined.
#pragma once

#include <map>
#include <set>

#include "isochor/generate.h"
#include "mesh_support.h"
#include "support/meshes.h"

namespace refine_test {

using namespace mesh_test;
using isochor::check_mesh;

inline std::string library_mesh(const std::string& name) {
  return std::string(ISOCHOR_SCENES) + "/meshes/" + name + ".msh";
}

inline const Vec3& node(const Mesh& mesh, Index i) {
  return mesh.nodes[static_cast<std::size_t>(i)];
}

// Half the integral of x cross dx along an edge, straight or through a middle node: summed around a face its
// area as a vector, whatever the surface inside.
inline Vec3 swept(const Vec3& a, const Vec3& b) {
  return 0.5 * cross(a, b);
}
inline Vec3 swept(const Vec3& a, const Vec3& m, const Vec3& b) {
  Vec3 sum{};
  for (const double t : {0.5 - std::sqrt(1.0 / 12), 0.5 + std::sqrt(1.0 / 12)}) {
    const Vec3 x = (1 - t) * (1 - 2 * t) * a + 4 * t * (1 - t) * m + t * (2 * t - 1) * b;
    const Vec3 dx = (4 * t - 3) * a + (4 - 8 * t) * m + (4 * t - 1) * b;
    sum += 0.25 * cross(x, dx);
  }
  return sum;
}

struct Area {
  Vec3 vector{};
  double flat = 0;  // of the triangles
};

inline Area area_of(const Mesh& mesh, const isochor::MeshSurface& s) {
  Area sum;
  const auto width = static_cast<std::size_t>(nodes_per_face(mesh.cell_type));
  const std::size_t corners = width == 4 ? 4 : 3;
  for (std::size_t f = 0; f < s.faces.size(); f += width) {
    Vec3 one{};
    for (std::size_t k = 0; k < corners; ++k) {
      const Vec3 &a = node(mesh, s.faces[f + k]), &b = node(mesh, s.faces[f + (k + 1) % corners]);
      one += width == 6 ? swept(a, node(mesh, s.faces[f + 3 + k]), b) : swept(a, b);
    }
    sum.vector += one;
    sum.flat += std::sqrt(dot(one, one));
  }
  return sum;
}

inline double distance(const Vec3& a, const Vec3& b) {
  return std::sqrt(dot(a - b, a - b));
}

// The integral of the Jacobian over curved tets: Gauss points on a cube, whose one side is drawn together to
// an edge and this to a corner.
inline double curved_volume(const Mesh& mesh) {
  const double g = std::sqrt(1.2), at[4] = {-std::sqrt((3 + 2 * g) / 7), -std::sqrt((3 - 2 * g) / 7),
                                            std::sqrt((3 - 2 * g) / 7), std::sqrt((3 + 2 * g) / 7)};
  const double outer = (18 - std::sqrt(30)) / 36, inner = (18 + std::sqrt(30)) / 36,
               weight[4] = {outer, inner, inner, outer};
  constexpr std::size_t edge[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
  double sum = 0;
  for (std::size_t c = 0; c < mesh.cells.size(); c += 10) {
    for (int p = 0; p < 64; ++p) {
      const double u = 0.5 + 0.5 * at[p % 4], v = 0.5 + 0.5 * at[p / 4 % 4], w = 0.5 + 0.5 * at[p / 16];
      const double l[4] = {(1 - u) * (1 - v) * (1 - w), u * (1 - v) * (1 - w), v * (1 - w), w};
      // Derivatives by the barycentric coordinates, as if these were free.
      std::array<Vec3, 4> d{};
      for (std::size_t a = 0; a < 4; ++a) d[a] += (4 * l[a] - 1) * node(mesh, mesh.cells[c + a]);
      for (std::size_t e = 0; e < 6; ++e) {
        const Vec3& m = node(mesh, mesh.cells[c + 4 + e]);
        d[edge[e][0]] += 4 * l[edge[e][1]] * m;
        d[edge[e][1]] += 4 * l[edge[e][0]] * m;
      }
      const double jacobian = dot(cross(d[1] - d[0], d[2] - d[0]), d[3] - d[0]);
      sum +=
          0.125 * weight[p % 4] * weight[p / 4 % 4] * weight[p / 16] * (1 - v) * (1 - w) * (1 - w) * jacobian;
    }
  }
  return sum;
}

// Cells as the sets of their nodes' places, on a grid that rounding does not reach.
inline std::multiset<std::vector<std::array<long, 3>>> places_of_cells(const Mesh& mesh) {
  std::multiset<std::vector<std::array<long, 3>>> all;
  const auto per = static_cast<std::size_t>(nodes_per_cell(mesh.cell_type));
  for (std::size_t c = 0; c < mesh.cells.size(); c += per) {
    std::vector<std::array<long, 3>> places;
    for (std::size_t k = 0; k < per; ++k) {
      const Vec3& x = node(mesh, mesh.cells[c + k]);
      places.push_back({std::lround(1e6 * x.x), std::lround(1e6 * x.y), std::lround(1e6 * x.z)});
    }
    std::sort(places.begin(), places.end());
    all.insert(places);
  }
  return all;
}

inline std::set<Index> set_of(const Mesh& mesh, std::size_t s) {
  return {mesh.node_sets.at(s).nodes.begin(), mesh.node_sets.at(s).nodes.end()};
}

// What refining must keep of any mesh, whatever the number of pieces.
inline void check_kept(const Mesh& before, const Mesh& after) {
  const MeshReport was = check_mesh(before), is = check_mesh(after);
  CHECK(is.usable());
  // The checker's volumes of curved cells and of what they enclose are near the exact ones alone.
  const bool curved = before.cell_type == CellType::tet10;
  const double volume_error = curved ? 1e-3 : 1e-12;
  CHECK(is.volume == Approx(was.volume).epsilon(volume_error));
  if (curved) CHECK(curved_volume(after) == Approx(curved_volume(before)).epsilon(1e-12));
  CHECK(is.parts == was.parts);
  REQUIRE(is.boundary.size() == was.boundary.size());
  for (std::size_t k = 0; k < was.boundary.size(); ++k) {
    CHECK(is.boundary[k].surface.name == was.boundary[k].surface.name);
    CHECK(is.boundary[k].volume == Approx(was.boundary[k].volume).epsilon(volume_error));
  }
  for (const MeshFinding& f : is.findings) {
    INFO(f.code << ": " << f.message);
    CHECK((find(was, f.code) != nullptr || f.code == "sliver" || f.severity == Severity::note));
  }
  REQUIRE(after.surfaces.size() == before.surfaces.size());
  for (std::size_t s = 0; s < before.surfaces.size(); ++s) {
    const Area a = area_of(before, before.surfaces[s]), b = area_of(after, after.surfaces[s]);
    CHECK(after.surfaces[s].name == before.surfaces[s].name);
    CHECK(distance(a.vector, b.vector) <= 1e-12 * (a.flat + 1e-30) * 100);
    if (before.cell_type == CellType::tet4) CHECK(b.flat == Approx(a.flat).epsilon(1e-12));
  }
}

}  // namespace refine_test
