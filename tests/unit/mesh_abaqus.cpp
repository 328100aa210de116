// Decks of Abaqus and CalculiX: cells of all kinds, sets, surfaces by sides of elements.
#include <set>

#include "isochor/generate.h"
#include "isochor/mesh_select.h"
#include "mesh_support.h"

using namespace mesh_test;

namespace {

// Sides as Abaqus' manual lists them, by corners from 1.
const std::vector<std::vector<int>> kTet = {{1, 2, 3}, {1, 4, 2}, {2, 4, 3}, {3, 4, 1}};
const std::vector<std::vector<int>> kHex = {{1, 2, 3, 4}, {5, 8, 7, 6}, {1, 5, 6, 2},
                                            {2, 6, 7, 3}, {3, 7, 8, 4}, {4, 8, 5, 1}};

const char* type_of(CellType type) {
  return type == CellType::tet4 ? "C3D4H" : type == CellType::tet10 ? "C3D10M" : "C3D8R";
}

// A deck with gaps in its numbers, in the style of Abaqus/CAE or flat, its surface z1 by sides.
std::string deck(const Mesh& mesh, bool parts, std::mt19937& random) {
  std::string text = "*Heading\n** made by a test\n";
  if (parts) text += "*Part, name=block\n";
  text += "*Node\n";
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    const Vec3& x = mesh.nodes[i];
    char line[120];
    std::snprintf(line, sizeof line, "%zu, %.17g,%.17g , %.17g\n", 3 * i + 7, x.x, x.y, x.z);
    text += line;
  }
  const auto width = static_cast<std::size_t>(nodes_per_cell(mesh.cell_type));
  const std::size_t cells = mesh.cells.size() / width;
  text += std::string("*ELEMENT, type=") + type_of(mesh.cell_type) + ",\n elset=Body\n";
  for (std::size_t c = 0; c < cells; ++c) {
    text += std::to_string(c + 1);
    for (std::size_t k = 0; k < width; ++k) {
      text += random() % 6 == 0 ? ",\n  " : ", ";
      text += std::to_string(3 * mesh.cells[width * c + k] + 7);
    }
    text += "\n";
  }
  text += "*Elset, elset=lower, generate\n1, " + std::to_string(cells / 2) + ", 1\n";
  text += "*Nset, nset=\"ends\"\n7, 10, 13,\n 16\n*Nset, nset=more\nends, 19\n";
  text += "*Solid Section, elset=lower, material=soft\n,\n";
  if (parts)
    text +=
        "*End Part\n*Assembly, name=a\n*Instance, name=b, part=block\n*End Instance\n*Node\n7, 0., 0., 9.\n";
  std::set<std::vector<Index>> top;
  const auto per = static_cast<std::size_t>(nodes_per_face(mesh.cell_type));
  for (const auto& s : mesh.surfaces) {
    for (std::size_t f = 0; s.name == "z1" && f < s.faces.size(); f += per) {
      std::vector<Index> key(&s.faces[f], &s.faces[f] + (per == 4 ? 4 : 3));
      std::sort(key.begin(), key.end());
      top.insert(key);
    }
  }
  const auto& sides = mesh.cell_type == CellType::hex8 ? kHex : kTet;
  text += "*Surface, type=ELEMENT, name=lid\n";
  for (std::size_t c = 0; c < cells; ++c) {
    for (std::size_t s = 0; s < sides.size(); ++s) {
      std::vector<Index> key;
      for (const int k : sides[s]) key.push_back(mesh.cells[width * c + std::size_t(k - 1)]);
      std::sort(key.begin(), key.end());
      if (top.count(key) > 0)
        text += std::string(parts ? "b." : "") + std::to_string(c + 1) + ", S" + std::to_string(s + 1) + "\n";
    }
  }
  if (parts) text += "*End Assembly\n";
  return text + "*Material, name=soft\n*Elastic\n1e5, 0.45\n*Step\n*Static\n0.1, 1\n*End Step\n";
}

}  // namespace

TEST_CASE("mesh: Abaqus decks have cells, regions, surfaces and node sets", "[mesh]") {
  const TempDir dir;
  std::mt19937 random(4);
  for (const CellType type : {CellType::tet4, CellType::tet10, CellType::hex8}) {
    isochor::BoxMeshDef def;
    def.divisions = {2, 3, 2};
    def.cell_type = type;
    const Mesh plain = std::move(isochor::box_mesh(def)).value();
    for (const bool parts : {false, true}) {
      const Mesh mesh = read(dir.write("a.inp", deck(plain, parts, random)));
      CHECK(mesh.cells == plain.cells);
      CHECK(mesh.nodes == plain.nodes);
      CHECK(mesh.node_label[0] == 7);
      CHECK(mesh.regions == std::vector<std::string>{"lower", "unassigned"});
      const auto set = std::find_if(mesh.node_sets.begin(), mesh.node_sets.end(),
                                    [](const auto& s) { return s.name == "more"; });
      REQUIRE(set != mesh.node_sets.end());
      CHECK(set->nodes == std::vector<Index>{0, 1, 2, 3, 4});
      REQUIRE(mesh.surfaces.size() == 1);
      CHECK(mesh.surfaces[0].name == "lid");
      isochor::MeshSelection top;
      top.of = {"lid"};
      isochor::MeshSelection z1;
      z1.plane = {{{0, 0, 1}, {0, 0, 1}}};
      CHECK(isochor::select_faces(mesh, top).value() == isochor::select_faces(mesh, z1).value());
    }
  }
}

TEST_CASE("mesh: decks that cannot be read say why", "[mesh]") {
  const TempDir dir;
  const std::string nodes = "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n4, 0, 0, 1\n";
  const auto said = [&](const std::string& more) { return refusal(dir, "a.inp", nodes + more); };
  CHECK(mentions(said(""), {"no tetrahedra"}));
  CHECK(mentions(said("*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 9\n"), {"element 1", "node 9"}));
  CHECK(mentions(said("*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, x\n"), {"line 7", "'x'"}));
  CHECK(mentions(said("*ELEMENT, TYPE=C3D4\n1, 1, 2\n"), {"ends early"}));
  CHECK(mentions(said("*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4, 4\n"), {"5 nodes", "C3D4"}));
  CHECK(mentions(said("*ELEMENT, TYPE=C3D6\n1, 1, 2, 3, 4, 1, 2\n"), {"1 C3D6"}));
  CHECK(mentions(said("*INCLUDE, INPUT=b.inp\n"), {"*INCLUDE", "one file"}));
  CHECK(mentions(said("*NSET, NSET=a, GENERATE\n1, 900000000, 1\n"), {"900000000"}));
  CHECK(mentions(said(nodes), {"node 1", "twice"}));
}
