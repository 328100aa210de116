// Files and meshes that the mesh tests share.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "catch.h"
#include "isochor/mesh_io.h"

namespace mesh_test {

using isochor::CellType;
using isochor::Index;
using isochor::Mesh;
using isochor::MeshFinding;
using isochor::MeshReport;
using isochor::Severity;
using isochor::Vec3;

// A directory of its own for each test, removed at the end.
class TempDir {
 public:
  TempDir() {
    path_ =
        std::filesystem::temp_directory_path() / ("isochor-mesh-" + std::to_string(std::random_device{}()));
    std::filesystem::create_directories(path_);
  }
  ~TempDir() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TempDir(const TempDir&) = delete;
  TempDir& operator=(const TempDir&) = delete;

  std::string file(const std::string& name) const { return (path_ / name).string(); }
  std::string write(const std::string& name, const std::string& content) const {
    std::ofstream(file(name), std::ios::binary) << content;
    return file(name);
  }
  std::size_t entries() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(path_), {}));
  }

 private:
  std::filesystem::path path_;
};

inline std::string load(const std::string& file) {
  std::ostringstream content;
  content << std::ifstream(file, std::ios::binary).rdbuf();
  return content.str();
}

inline std::filesystem::path data_directory() {
#ifdef ISOCHOR_TEST_DATA
  return std::filesystem::path(ISOCHOR_TEST_DATA) / "mesh";
#else
  return std::filesystem::path(__FILE__).parent_path().parent_path() / "data" / "mesh";
#endif
}

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  REQUIRE(at != text.npos);
  return text.replace(at, from.size(), to);
}

// Reads, expecting success; the message of a failure shows in the report.
inline Mesh read(const std::string& file, double scale = 1) {
  auto result = isochor::read_mesh(file, {scale});
  INFO((result ? std::string() : result.error()));
  REQUIRE(result.ok());
  return std::move(result).value();
}

// The error for a content, which must name the file; "" if the content is read after all.
inline std::string refusal(const TempDir& dir, const std::string& name, const std::string& content) {
  const std::string file = dir.write(name, content);
  const auto result = isochor::read_mesh(file);
  if (result) return "";
  CHECK(result.error().find(std::filesystem::path(file).stem().string()) != std::string::npos);
  return result.error();
}

inline bool mentions(const std::string& message, const std::vector<std::string>& parts) {
  for (const std::string& part : parts) {
    if (message.find(part) == message.npos) {
      UNSCOPED_INFO("'" << message << "' does not mention '" << part << "'");
      return false;
    }
  }
  return true;
}

inline double cell_volume(const Mesh& mesh, Index cell) {
  const auto width = static_cast<std::size_t>(nodes_per_cell(mesh.cell_type));
  std::array<Vec3, 4> x;
  for (std::size_t k = 0; k < 4; ++k) {
    x[k] = mesh.nodes[static_cast<std::size_t>(mesh.cells[width * static_cast<std::size_t>(cell) + k])];
  }
  return dot(cross(x[1] - x[0], x[2] - x[0]), x[3] - x[0]) / 6;
}

// How far the mid-edge nodes are from the middles of the edges that they should lie on, at worst.
inline double mid_edge_error(const Mesh& mesh) {
  constexpr std::array<std::array<std::size_t, 2>, 6> edges{{{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};
  double worst = 0;
  for (std::size_t c = 0; c < mesh.cells.size(); c += 10) {
    const auto node = [&](std::size_t k) { return mesh.nodes[static_cast<std::size_t>(mesh.cells[c + k])]; };
    for (std::size_t e = 0; e < 6; ++e) {
      const Vec3 d = node(4 + e) - 0.5 * (node(edges[e][0]) + node(edges[e][1]));
      worst = std::max(worst, std::sqrt(dot(d, d)));
    }
  }
  return worst;
}

// Two tetrahedra on the face (1 2 3), nodes 0 to 4; the second is the first one's mirror image.
inline Mesh two_tets() {
  Mesh mesh;
  mesh.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  mesh.cells = {0, 1, 2, 3, 1, 2, 3, 4};
  mesh.source = "two tetrahedra";
  return mesh;
}

// A cube of n^3 small cubes of six tetrahedra each around their diagonal.
inline Mesh cube_mesh(Index n, double size = 1) {
  Mesh mesh;
  const auto node = [&](Index i, Index j, Index k) { return i + (n + 1) * (j + (n + 1) * k); };
  for (Index k = 0; k <= n; ++k) {
    for (Index j = 0; j <= n; ++j) {
      for (Index i = 0; i <= n; ++i) mesh.nodes.push_back(size / n * Vec3{double(i), double(j), double(k)});
    }
  }
  constexpr std::array<std::array<int, 3>, 6> paths{
      {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};
  for (Index c = 0; c < n * n * n; ++c) {
    for (std::size_t p = 0; p < 6; ++p) {
      std::array<Index, 3> at{c % n, c / n % n, c / (n * n)};
      std::array<Index, 4> cell{};
      for (std::size_t s = 0; s < 4; ++s) {
        cell[s] = node(at[0], at[1], at[2]);
        if (s < 3) ++at[static_cast<std::size_t>(paths[p][s])];
      }
      if (p >= 3) std::swap(cell[1], cell[2]);
      mesh.cells.insert(mesh.cells.end(), cell.begin(), cell.end());
    }
  }
  return mesh;
}

// The same mesh with mid-edge nodes.
inline Mesh quadratic(const Mesh& linear) {
  constexpr std::array<std::array<std::size_t, 2>, 6> edges{{{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};
  Mesh mesh;
  mesh.cell_type = CellType::tet10;
  mesh.nodes = linear.nodes;
  std::vector<std::array<Index, 3>> known;
  for (std::size_t c = 0; c < linear.cells.size(); c += 4) {
    const Index* n = &linear.cells[c];
    mesh.cells.insert(mesh.cells.end(), n, n + 4);
    for (const auto& e : edges) {
      const auto [a, b] = std::minmax(n[e[0]], n[e[1]]);
      Index middle = -1;
      for (const auto& k : known) middle = k[0] == a && k[1] == b ? k[2] : middle;
      if (middle < 0) {
        middle = mesh.node_count();
        mesh.nodes.push_back(
            0.5 * (mesh.nodes[static_cast<std::size_t>(a)] + mesh.nodes[static_cast<std::size_t>(b)]));
        known.push_back({a, b, middle});
      }
      mesh.cells.push_back(middle);
    }
  }
  return mesh;
}

inline const MeshFinding* find(const MeshReport& report, const std::string& code) {
  for (const MeshFinding& finding : report.findings) {
    if (finding.code == code) return &finding;
  }
  return nullptr;
}

// Small files of each text format: the two tetrahedra as regions 3 and 7 and a face in surface 5.
inline std::string gmsh22_text() {
  return "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"
         "$PhysicalNames\n2\n3 3 \"lower part\"\n2 5 \"top\"\n$EndPhysicalNames\n"
         "$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1\n$EndNodes\n"
         "$Elements\n4\n1 15 2 9 1 1\n2 2 2 5 1 2 3 4\n3 4 2 3 1 1 2 3 4\n4 4 2 7 2 2 3 4 5\n$EndElements\n"
         "$NodeData\n1\n\"weight\"\n1\n0.5\n3\n0\n1\n2\n2 0.25\n5 4\n$EndNodeData\n";
}

inline std::string gmsh41_text() {
  return "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"
         "$PhysicalNames\n2\n3 3 \"lower part\"\n2 5 \"top\"\n$EndPhysicalNames\n"
         "$Entities\n1 0 1 2\n1 0 0 0 1 9\n1 0 0 0 1 1 1 1 5 0\n1 0 0 0 1 1 1 1 3 0\n2 0 0 0 1 1 1 1 7 "
         "0\n$EndEntities\n"
         "$Nodes\n1 5 10 50\n3 1 0 5\n10\n20\n30\n40\n50\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 1\n$EndNodes\n"
         "$Elements\n4 4 1 4\n0 1 15 1\n1 10\n2 1 2 1\n2 20 30 40\n3 1 4 1\n3 10 20 30 40\n3 2 4 1\n4 20 30 "
         "40 50\n"
         "$EndElements\n$Periodic\n0\n$EndPeriodic\n";
}

inline std::string vtk_text() {
  return "# vtk DataFile Version 3.0\ntwo\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n"
         "0 0 0 1 0 0 0 1 0 0 0 1 1 1 1\nCELLS 3 14\n3 1 2 3\n4 0 1 2 3\n4 1 2 3 4\nCELL_TYPES 3\n5\n10\n10\n"
         "CELL_DATA 3\nSCALARS region int 1\nLOOKUP_TABLE default\n5\n3\n7\n"
         "POINT_DATA 5\nSCALARS weight%20a float\nLOOKUP_TABLE default\n0 0.25 0 0 4\nVECTORS push double\n"
         "0 0 0 1 2 3 0 0 0 0 0 0 0 0 0\n";
}

inline std::string vtu_text() {
  return "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" "
         "byte_order=\"LittleEndian\">\n"
         "<UnstructuredGrid><Piece NumberOfPoints=\"5\" NumberOfCells=\"3\">\n"
         "<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">\n"
         "0 0 0 1 0 0 0 1 0 0 0 1 1 1 1</DataArray></Points>\n<Cells>\n"
         "<DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">1 2 3 0 1 2 3 1 2 3 "
         "4</DataArray>\n"
         "<DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">3 7 11</DataArray>\n"
         "<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">5 10 10</DataArray>\n</Cells>\n"
         "<CellData><DataArray type=\"Int32\" Name=\"region\" format=\"ascii\">5 3 7</DataArray></CellData>\n"
         "<PointData><DataArray type=\"Float32\" Name=\"weight\" format=\"ascii\">0 0.25 0 0 "
         "4</DataArray></PointData>\n"
         "</Piece></UnstructuredGrid></VTKFile>\n";
}

inline std::string medit_text() {
  return "MeshVersionFormatted 2\n# a comment\nDimension 3\nVertices\n5\n0 0 0 1\n1 0 0 1\n0 1 0 1\n0 0 1 "
         "1\n1 1 1 1\n"
         "Corners\n2\n1\n2\nTriangles\n1\n2 3 4 5\nTetrahedra\n2\n1 2 3 4 3\n2 3 4 5 7\nEnd\n";
}

}  // namespace mesh_test
