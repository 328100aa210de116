// Hexahedra through readers, writer and checker.
#include "isochor/generate.h"
#include "mesh_support.h"

using namespace mesh_test;
using isochor::check_mesh;

namespace {

Mesh hexahedra(std::array<int, 3> divisions) {
  auto mesh = isochor::box_mesh({{0, 0, 0}, {1, 1, 1}, divisions, CellType::hex8});
  REQUIRE(mesh.ok());
  return std::move(mesh).value();
}

// Two unit cubes side by side along x; the second is given upside down. Two quadrangles bound them at z = 0,
// and a triangle lies on one of these.
const char* const gmsh22 =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n2 7 \"floor\"\n3 1 \"left\"\n3 2 \"right\"\n"
    "$EndPhysicalNames\n$Nodes\n12\n1 0 0 0\n2 1 0 0\n3 2 0 0\n4 0 1 0\n5 1 1 0\n6 2 1 0\n7 0 0 1\n8 1 0 1\n"
    "9 2 0 1\n10 0 1 1\n11 1 1 1\n12 2 1 1\n$EndNodes\n$Elements\n5\n1 3 2 7 1 1 2 5 4\n2 3 2 7 1 2 3 6 5\n"
    "3 2 2 7 1 1 2 5\n4 5 2 1 1 1 2 5 4 7 8 11 10\n5 5 2 2 1 8 9 12 11 2 3 6 5\n$EndElements\n";

const char* const medit =
    "MeshVersionFormatted 2\nDimension 3\nVertices\n8\n0 0 0 0\n1 0 0 0\n1 1 0 0\n0 1 0 0\n0 0 1 0\n1 0 1 0\n"
    "1 1 1 0\n0 1 1 0\nQuadrilaterals\n1\n1 2 3 4 5\nHexahedra\n1\n1 2 3 4 5 6 7 8 3\nEnd\n";

// A voxel counts its corners by rows; so does the pixel on it.
const char* const voxel =
    "# vtk DataFile Version 3.0\nvoxel\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 8 double\n0 0 0  1 0 0  0 1 "
    "0\n"
    "1 1 0  0 0 1  1 0 1  0 1 1  1 1 1\nCELLS 2 14\n8 0 1 2 3 4 5 6 7\n4 0 1 2 3\nCELL_TYPES 2\n11\n8\n"
    "CELL_DATA 2\nSCALARS region int 1\nLOOKUP_TABLE default\n4 9\n";

}  // namespace

TEST_CASE("mesh hexahedra: read from Gmsh, with quadrangles as surfaces", "[mesh]") {
  const TempDir dir;
  const Mesh mesh = read(dir.write("a.msh", gmsh22));
  CHECK(mesh.cell_type == CellType::hex8);
  CHECK(mesh.cell_count() == 2);
  CHECK(mesh.regions == std::vector<std::string>{"left", "right"});
  REQUIRE(mesh.surfaces.size() == 1);
  CHECK(mesh.surfaces[0].faces == std::vector<Index>{0, 1, 4, 3, 1, 2, 5, 4});
  const MeshReport report = check_mesh(mesh);
  CHECK(report.usable());
  CHECK(report.volume == Approx(2));
  CHECK(report.worst_quality == Approx(1));
  CHECK(report.smallest_dihedral_deg == Approx(90));
  CHECK(find(report, "turned-cell")->count == 1);
  CHECK(find(report, "foreign-face")->count == 1);
  CHECK(find(report, "surface-off-mesh") == nullptr);
  CHECK(find(report, "open-surface")->count == 1);
}

TEST_CASE("mesh hexahedra: read from Medit and VTK", "[mesh]") {
  const TempDir dir;
  const Mesh from_medit = read(dir.write("a.mesh", medit));
  CHECK(from_medit.cell_type == CellType::hex8);
  CHECK(from_medit.surfaces.at(0).name == "5");
  CHECK(from_medit.surfaces.at(0).faces.size() == 4);
  CHECK(check_mesh(from_medit).volume == Approx(1));
  const Mesh from_vtk = read(dir.write("a.vtk", voxel));
  CHECK(from_vtk.cell_type == CellType::hex8);
  CHECK(from_vtk.cells == std::vector<Index>{0, 1, 3, 2, 4, 5, 7, 6});
  CHECK(from_vtk.surfaces.at(0).faces == std::vector<Index>{0, 1, 3, 2});
  CHECK(check_mesh(from_vtk).volume == Approx(1));
  CHECK(
      mentions(refusal(dir, "b.vtk", replaced(voxel, "\n11\n8\n", "\n12\n12\n")), {"4 points instead of 8"}));
}

TEST_CASE("mesh hexahedra: written and read back", "[mesh]") {
  const TempDir dir;
  const Mesh mesh = hexahedra({3, 2, 1});
  REQUIRE(isochor::write_vtu(dir.file("a.vtu"), {mesh.cell_type, mesh.nodes, mesh.cells, {}, {}}).ok());
  const Mesh back = read(dir.file("a.vtu"));
  CHECK(back.cell_type == CellType::hex8);
  CHECK(back.nodes == mesh.nodes);
  CHECK(back.cells == mesh.cells);
}

TEST_CASE("mesh hexahedra: a box is a good mesh with outward sides", "[mesh]") {
  const Mesh mesh = hexahedra({3, 4, 5});
  const MeshReport report = check_mesh(mesh);
  for (const MeshFinding& f : report.findings) CHECK(f.code == "open-surface");
  CHECK(report.volume == Approx(1));
  CHECK(report.parts == 1);
  const auto node = [&](const std::vector<Index>& faces, std::size_t i) {
    return mesh.nodes[static_cast<std::size_t>(faces[i])];
  };
  double volume = 0;
  for (const auto& surface : mesh.surfaces) {
    for (std::size_t f = 0; f < surface.faces.size(); f += 4) {
      const Vec3 a = node(surface.faces, f), c = node(surface.faces, f + 2);
      const Vec3 b = node(surface.faces, f + 1), d = node(surface.faces, f + 3);
      volume += dot(0.5 * (a + c), cross(c - a, d - b)) / 6;
    }
  }
  CHECK(volume == Approx(1));
}

TEST_CASE("mesh hexahedra: what the checker finds", "[mesh]") {
  const auto severity = [](const Mesh& mesh, const char* code) {
    const MeshReport report = check_mesh(mesh);
    const MeshFinding* f = find(report, code);
    return f ? static_cast<int>(f->severity) : -1;
  };
  constexpr int error = static_cast<int>(Severity::error);
  Mesh inverted = hexahedra({1, 1, 1});
  std::rotate(inverted.cells.begin(), inverted.cells.begin() + 4, inverted.cells.end());
  CHECK(severity(inverted, "inverted-cell") == error);
  // One corner pushed through the opposite one: positive volume, negative Jacobian there.
  Mesh tangled = hexahedra({1, 1, 1});
  tangled.nodes[7] = {0.2, 0.2, 0.2};
  CHECK(check_mesh(tangled).volume > 0);
  CHECK(severity(tangled, "tangled-cell") == error);
  Mesh doubled = hexahedra({2, 1, 1});
  std::copy_n(doubled.cells.begin(), 8, doubled.cells.begin() + 8);
  CHECK(severity(doubled, "duplicate-cell") == error);
  Mesh flat = hexahedra({1, 1, 1});
  for (Vec3& x : flat.nodes) x.z = 0;
  CHECK(severity(flat, "degenerate-cell") == error);
  // Cells that meet in an edge, or in a point.
  for (const bool point : {false, true}) {
    Mesh hinge = hexahedra({2, 2, 2});
    const std::vector<Index> cells = hinge.cells;
    hinge.cells.assign(cells.begin(), cells.begin() + 8);
    const auto other = cells.begin() + 8 * (point ? 7 : 3);
    hinge.cells.insert(hinge.cells.end(), other, other + 8);
    constexpr int warning = static_cast<int>(Severity::warning);
    CHECK(severity(hinge, "non-manifold-node") == (point ? warning : -1));
    CHECK(severity(hinge, "non-manifold-edge") == (point ? -1 : warning));
  }
  // A hollow box.
  Mesh hollow = hexahedra({3, 3, 3});
  hollow.cells.erase(hollow.cells.begin() + 8 * 13, hollow.cells.begin() + 8 * 14);
  const MeshReport report = check_mesh(hollow);
  REQUIRE(find(report, "cavity") != nullptr);
  CHECK(mentions(find(report, "cavity")->message, {"0.037"}));
  CHECK(report.usable());
}
