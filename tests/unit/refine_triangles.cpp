// Meshes of triangles cut finer: uniformly and where it counts.
#include <map>
#include <random>

#include "engine/base/base.h"
#include "isochor/generate.h"
#include "support/sheets.h"

using namespace isochor;
using test::value;

namespace {

double area(const Mesh& mesh) {
  double sum = 0;
  for (std::size_t c = 0; c < mesh.cells.size(); c += 3) {
    const Vec3 &a = mesh.nodes[at(mesh.cells[c])], &b = mesh.nodes[at(mesh.cells[c + 1])],
               &d = mesh.nodes[at(mesh.cells[c + 2])];
    sum += 0.5 * norm(cross(b - a, d - a));
  }
  return sum;
}

// Edges go to two triangles, once each way, and to one at the rim; no node lies in the middle of an edge.
void check_conforming(const Mesh& mesh, double rim_length) {
  std::map<std::pair<Index, Index>, int> edges;
  for (std::size_t c = 0; c < mesh.cells.size(); c += 3) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto edge = std::pair(mesh.cells[c + k], mesh.cells[c + (k + 1) % 3]);
      CHECK(++edges[edge] == 1);
    }
  }
  double rim = 0;
  for (const auto& [edge, count] : edges) {
    if (!edges.contains({edge.second, edge.first}))
      rim += norm(mesh.nodes[at(edge.second)] - mesh.nodes[at(edge.first)]);
  }
  CHECK(rim == Approx(rim_length).epsilon(1e-12));
}

Mesh sheet(unsigned seed) {
  Mesh mesh = test::unit_sheet(3 + static_cast<int>(seed % 3), 4, 0.3, seed);
  MeshField field;
  field.name = "linear";
  for (const Vec3& p : mesh.nodes) field.values.push_back(1 + 2 * p.x - 3 * p.y);
  mesh.fields = {field};
  MeshField cells;
  cells.name = "cell";
  for (Index c = 0; c < mesh.cell_count(); ++c) cells.values.push_back(c);
  mesh.cell_fields = {cells};
  mesh.surfaces = {{"some", {mesh.cells[0], mesh.cells[1], mesh.cells[2]}}};
  return mesh;
}

// What is kept whichever way triangles are cut.
void check_kept(const Mesh& before, const Mesh& after) {
  CHECK(area(after) == Approx(area(before)).epsilon(1e-12));
  check_conforming(after, 4);
  for (std::size_t i = 0; i < after.nodes.size(); ++i) {
    const Vec3& p = after.nodes[i];
    CHECK(after.fields[0].values[i] == Approx(1 + 2 * p.x - 3 * p.y).margin(1e-12));
  }
  // Node sets of the rim are nodes on that line, all of them.
  for (const MeshNodeSet& set : after.node_sets) {
    std::vector<bool> in(after.nodes.size(), false);
    for (const Index n : set.nodes) in[at(n)] = true;
    const int axis = set.name[0] - 'x';
    if (axis > 1) continue;
    for (std::size_t i = 0; i < after.nodes.size(); ++i) {
      const bool on = std::abs(after.nodes[i][axis] - (set.name[1] - '0')) < 1e-12;
      CHECK(in[i] == on);
    }
  }
}

}  // namespace

TEST_CASE("refined sheets keep area, rim, sets, surfaces and fields", "[mesh]") {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const Mesh before = sheet(seed);
    for (const int levels : {1, 2}) {
      const Mesh after = value(refine_mesh(before, levels));
      CHECK(after.cell_count() == before.cell_count() << (2 * levels));
      check_kept(before, after);
      CHECK(after.surfaces[0].faces.size() == 3u << (2 * levels));
      for (std::size_t c = 0; c < after.cell_fields[0].values.size(); ++c)
        CHECK(after.cell_fields[0].values[c] == static_cast<double>(c >> (2 * levels)));
    }
  }
}

TEST_CASE("a set of two corners does not reach across the triangle between them", "[mesh]") {
  // Both ends of an inner edge lie on the rim of one triangle pair: its middle does not.
  Mesh mesh;
  mesh.cell_type = CellType::tri3;
  mesh.nodes = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.cells = {0, 1, 2, 0, 2, 3};
  mesh.node_sets = {{"corner", {0, 1, 2}}};
  const Mesh after = value(refine_mesh(mesh, 1));
  for (const Index n : after.node_sets[0].nodes) CHECK(norm(after.nodes[at(n)] - Vec3{0.5, 0.5, 0}) > 0.1);
  CHECK(after.node_sets[0].nodes.size() == 5);
}

TEST_CASE("triangles are cut where it is asked, neighbors as far as they must", "[mesh]") {
  std::mt19937 random(5);
  for (unsigned seed = 1; seed <= 10; ++seed) {
    Mesh mesh = sheet(seed);
    for (int round = 0; round < 4; ++round) {
      std::vector<Index> some;
      for (Index c = 0; c < mesh.cell_count(); ++c) {
        if (random() % 7 == 0) some.push_back(c);
      }
      const RefinedMesh finer = value(refine_cells(mesh, some));
      check_kept(mesh, finer.mesh);
      REQUIRE(finer.parent.size() == static_cast<std::size_t>(finer.mesh.cell_count()));
      std::vector<int> children(static_cast<std::size_t>(mesh.cell_count()), 0);
      for (const Index p : finer.parent) ++children[at(p)];
      for (const Index c : some) CHECK(children[at(c)] == 4);
      mesh = finer.mesh;
    }
    CHECK(value(refine_cells(mesh, {})).mesh.cell_count() == mesh.cell_count());
  }
}
