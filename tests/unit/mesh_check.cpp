// check_mesh: every finding on a mesh made for it, and silence on a good one.
#include <limits>

#include "mesh_support.h"

using namespace mesh_test;
using isochor::check_mesh;

namespace {

bool found(const Mesh& mesh, const std::string& code, Severity severity, std::int64_t count) {
  const MeshReport report = check_mesh(mesh);
  const MeshFinding* finding = find(report, code);
  if (!finding) return false;
  INFO(finding->message);
  CHECK(finding->severity == severity);
  CHECK(finding->count == count);
  return true;
}

// The cube without its small cube number `hole`.
Mesh without_small_cube(Index n, Index hole) {
  Mesh mesh = cube_mesh(n);
  const auto begin = mesh.cells.begin() + 24 * hole;
  mesh.cells.erase(begin, begin + 24);
  return mesh;
}

std::vector<Index> face_of_cube(const Mesh& mesh) {
  std::vector<Index> faces;
  for (std::size_t c = 0; c < mesh.cells.size(); c += 4) {
    for (const auto& f : {std::array<std::size_t, 3>{0, 1, 2}, {0, 1, 3}, {0, 2, 3}, {1, 2, 3}}) {
      const bool flat = std::all_of(f.begin(), f.end(), [&](std::size_t k) {
        return mesh.nodes[static_cast<std::size_t>(mesh.cells[c + k])].z == 0;
      });
      for (std::size_t k = 0; flat && k < 3; ++k) faces.push_back(mesh.cells[c + f[k]]);
    }
  }
  return faces;
}

}  // namespace

TEST_CASE("mesh check: a good mesh has no finding", "[mesh]") {
  for (const Mesh& mesh : {cube_mesh(3), quadratic(cube_mesh(2))}) {
    const MeshReport report = check_mesh(mesh);
    for (const MeshFinding& finding : report.findings) CHECK(finding.message.empty());
    CHECK(report.usable());
    CHECK(report.volume == Approx(1));
    CHECK(report.parts == 1);
    CHECK(report.box[1] == Vec3{1, 1, 1});
    CHECK(report.smallest_dihedral_deg == Approx(45));
  }
}

TEST_CASE("mesh check: quality of the regular tetrahedron is one", "[mesh]") {
  Mesh mesh;
  mesh.nodes = {{1, 1, 1}, {-1, 1, -1}, {1, -1, -1}, {-1, -1, 1}};
  mesh.cells = {0, 1, 2, 3};
  if (cell_volume(mesh, 0) < 0) std::swap(mesh.cells[0], mesh.cells[1]);
  const MeshReport report = check_mesh(mesh);
  CHECK(report.worst_quality == Approx(1));
  CHECK(report.smallest_dihedral_deg == Approx(70.528779));
  CHECK(report.volume == Approx(8.0 / 3));
}

TEST_CASE("mesh check: bad cells", "[mesh]") {
  Mesh flat = two_tets();
  flat.nodes[4] = {0.5, 0.5, 0};
  flat.cell_label = {11, 12};
  CHECK(found(flat, "degenerate-cell", Severity::error, 1));
  CHECK(find(check_mesh(flat), "degenerate-cell")->examples == std::vector<std::int64_t>{12});
  Mesh repeated = two_tets();
  repeated.cells[7] = 1;
  CHECK(found(repeated, "degenerate-cell", Severity::error, 1));
  Mesh inverted = two_tets();
  std::swap(inverted.cells[0], inverted.cells[1]);
  CHECK(found(inverted, "inverted-cell", Severity::error, 1));
  Mesh sliver = two_tets();
  sliver.nodes[4] = {0.34, 0.34, 0.34};
  CHECK(found(sliver, "sliver", Severity::warning, 1));
  Mesh doubled = two_tets();
  doubled.cells.insert(doubled.cells.end(), {2, 1, 4, 3});
  CHECK(found(doubled, "duplicate-cell", Severity::error, 1));
}

TEST_CASE("mesh check: cells that overlap", "[mesh]") {
  Mesh three = two_tets();
  three.nodes.push_back({2, 2, 2});
  three.cells.insert(three.cells.end(), {1, 2, 3, 5});
  CHECK(found(three, "non-manifold-face", Severity::error, 1));
  Mesh folded = two_tets();
  folded.nodes[4] = {-0.1, -0.2, -0.3};
  std::swap(folded.cells[4], folded.cells[5]);
  CHECK(found(folded, "overlapping-cells", Severity::error, 1));
}

TEST_CASE("mesh check: nodes", "[mesh]") {
  Mesh loose = two_tets();
  loose.nodes.push_back({0.2, 0.2, 0.2});
  CHECK(found(loose, "unreferenced-node", Severity::error, 1));
  // Two tetrahedra that touch without sharing nodes.
  Mesh apart = two_tets();
  apart.nodes.insert(apart.nodes.end(), {apart.nodes[1], apart.nodes[2], apart.nodes[3]});
  for (std::size_t k = 4; k < 7; ++k) apart.cells[k] += 4;
  CHECK(found(apart, "duplicate-node", Severity::warning, 3));
  CHECK(found(apart, "disconnected", Severity::warning, 2));
  CHECK(check_mesh(apart).parts == 2);
  CHECK(check_mesh(apart).usable());
}

TEST_CASE("mesh check: boundaries that pinch", "[mesh]") {
  // Two small cubes of a 2-cube that share an edge only, then a corner only.
  for (const auto& [second, code] :
       {std::pair<Index, std::string>{3, "non-manifold-edge"}, {7, "non-manifold-node"}}) {
    const Mesh full = cube_mesh(2);
    Mesh mesh;
    mesh.nodes = full.nodes;
    for (const Index cube : {Index{0}, second}) {
      mesh.cells.insert(mesh.cells.end(), full.cells.begin() + 24 * cube,
                        full.cells.begin() + 24 * (cube + 1));
    }
    CHECK(found(mesh, code, Severity::warning, 1));
  }
}

TEST_CASE("mesh check: a cavity is noted with its volume", "[mesh]") {
  const Mesh mesh = without_small_cube(3, 13);
  CHECK(found(mesh, "cavity", Severity::note, 1));
  const MeshReport report = check_mesh(mesh);
  CHECK(report.usable());
  CHECK(report.volume == Approx(26.0 / 27));
  CHECK(mentions(find(report, "cavity")->message, {"0.03703"}));
  CHECK(find(check_mesh(without_small_cube(3, 4)), "cavity") == nullptr);
}

TEST_CASE("mesh check: surfaces", "[mesh]") {
  Mesh mesh = cube_mesh(2);
  mesh.surfaces = {{"floor", face_of_cube(mesh)}, {"void", {}}, {"stray", {0, 1, 26}}};
  mesh.node_sets = {{"none", {}}};
  const MeshReport report = check_mesh(mesh);
  CHECK(report.usable());
  CHECK(mentions(find(report, "open-surface")->message, {"'floor'", "1 boundary loop"}));
  CHECK(mentions(find(report, "empty-surface")->message, {"'void'"}));
  CHECK(mentions(find(report, "surface-off-mesh")->message, {"'stray'", "1 face"}));
  CHECK(find(report, "empty-node-set") != nullptr);
  const std::vector<Index> again = face_of_cube(mesh);
  mesh.surfaces[0].faces.insert(mesh.surfaces[0].faces.end(), again.begin(), again.begin() + 3);
  CHECK(find(check_mesh(mesh), "repeated-face")->count == 1);
}

TEST_CASE("mesh check: a closed surface is not called open", "[mesh]") {
  Mesh mesh = two_tets();
  mesh.surfaces = {{"skin", {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 4, 2, 3, 4, 3, 1, 4}}};
  CHECK(check_mesh(mesh).findings.empty());
}

TEST_CASE("mesh check: folded Tet10 and split edges", "[mesh]") {
  Mesh mesh = quadratic(cube_mesh(1));
  mesh.nodes[static_cast<std::size_t>(mesh.cells[4])] =
      mesh.nodes[static_cast<std::size_t>(mesh.cells[0])] - Vec3{0.4, 0.3, 0.2};
  CHECK(find(check_mesh(mesh), "tangled-cell") != nullptr);
  Mesh split = quadratic(cube_mesh(1));
  split.nodes.push_back(split.nodes[static_cast<std::size_t>(split.cells[4])]);
  split.cells[4] = split.node_count() - 1;
  CHECK(find(check_mesh(split), "split-mid-edge") != nullptr);
}

TEST_CASE("mesh check: units and regions", "[mesh]") {
  CHECK(found(cube_mesh(1, 100), "units", Severity::warning, 1));
  CHECK(found(cube_mesh(1, 1e-4), "units", Severity::warning, 1));
  CHECK(mentions(find(check_mesh(cube_mesh(1, 100)), "units")->message, {"100 x 100 x 100", "0.001"}));
  Mesh mesh = two_tets();
  mesh.regions = {"a", "b"};
  CHECK(found(mesh, "empty-region", Severity::warning, 1));
}

TEST_CASE("mesh check: arrays that contradict each other stop the check", "[mesh]") {
  Mesh mesh = two_tets();
  mesh.cells[3] = 5;
  CHECK(found(mesh, "index-out-of-range", Severity::error, 1));
  mesh = two_tets();
  mesh.cells.pop_back();
  CHECK(found(mesh, "array-length", Severity::error, 1));
  mesh = two_tets();
  mesh.cell_region = {0};
  CHECK(found(mesh, "array-length", Severity::error, 1));
  mesh = two_tets();
  mesh.cell_region = {0, 1};
  CHECK(found(mesh, "index-out-of-range", Severity::error, 1));
  mesh = two_tets();
  mesh.nodes[1].y = std::numeric_limits<double>::quiet_NaN();
  CHECK(found(mesh, "not-finite", Severity::error, 1));
  mesh = two_tets();
  mesh.fields = {{"w", 1, {0, 1, std::numeric_limits<double>::infinity(), 3, 4}}};
  CHECK(found(mesh, "field-not-finite", Severity::warning, 1));
  CHECK(found(Mesh{}, "no-cells", Severity::error, 1));
}

TEST_CASE("mesh check: enormous coordinates do no harm", "[mesh]") {
  Mesh mesh = two_tets();
  for (Vec3& x : mesh.nodes) x = 1e200 * x;
  CHECK_FALSE(check_mesh(mesh).findings.empty());
  mesh.nodes[4] = {1e308, 1e308, -1e308};
  mesh.nodes[0] = {-1e308, -1e308, 1e308};
  CHECK_FALSE(check_mesh(mesh).findings.empty());
}
