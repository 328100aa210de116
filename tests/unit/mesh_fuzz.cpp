// Damaged files of every format: each must be read or refused with a message, whatever the bytes. Meant to be
// run with the address and undefined-behavior sanitizers too.
#include "mesh_support.h"

using namespace mesh_test;

namespace {

void must_survive(const std::string& file) {
  const auto result = isochor::read_mesh(file);
  if (!result) {
    CHECK(result.error().size() > 20);
    return;
  }
  // What was read must be sound enough for the checker.
  const MeshReport report = isochor::check_mesh(result.value());
  CHECK(report.nodes > 0);
  CHECK(find(report, "index-out-of-range") == nullptr);
  CHECK(find(report, "array-length") == nullptr);
  CHECK(find(report, "not-finite") == nullptr);
}

void truncate_everywhere(const TempDir& dir, const std::string& name, const std::string& content,
                         std::size_t step) {
  for (std::size_t size = 0; size < content.size(); size += step) {
    CAPTURE(name, size);
    must_survive(dir.write(name, content.substr(0, size)));
  }
}

void flip_bytes(const TempDir& dir, const std::string& name, const std::string& content, int rounds) {
  std::mt19937 random(12345);
  for (int round = 0; round < rounds; ++round) {
    std::string damaged = content;
    const unsigned flips = 1 + random() % 4;
    for (unsigned i = 0; i < flips; ++i) {
      const std::size_t at = random() % damaged.size();
      // Half of the time a digit, which keeps text parsable and so reaches deeper.
      damaged[at] =
          random() % 2 == 0 ? static_cast<char>('0' + random() % 10) : static_cast<char>(random() % 256);
    }
    CAPTURE(name, round);
    must_survive(dir.write(name, damaged));
  }
}

void fuzz(const TempDir& dir, const std::string& name, const std::string& content) {
  truncate_everywhere(dir, name, content, std::max<std::size_t>(1, content.size() / 400));
  flip_bytes(dir, name, content, 400);
}

std::string packed_vtu(const TempDir& dir) {
  const Mesh mesh = quadratic(cube_mesh(1));
  const std::vector<double> region(static_cast<std::size_t>(mesh.cell_count()), 4);
  isochor::VtkGrid grid{mesh.cell_type, mesh.nodes, mesh.cells, {}, {{"region", 1, region}}};
  REQUIRE(isochor::write_vtu(dir.file("packed.vtu"), grid).ok());
  return load(dir.file("packed.vtu"));
}

}  // namespace

TEST_CASE("mesh: damaged small files", "[mesh][fuzz]") {
  const TempDir dir;
  fuzz(dir, "a.msh", gmsh22_text());
  fuzz(dir, "b.msh", gmsh41_text());
  fuzz(dir, "c.vtk", vtk_text());
  fuzz(dir, "d.vtu", vtu_text());
  fuzz(dir, "e.mesh", medit_text());
  fuzz(dir, "f.vtu", packed_vtu(dir));
}

// More than a mesh: data on elements, lines of no section, faces of no group.
TEST_CASE("mesh: damaged files with other sections", "[mesh][fuzz]") {
  const TempDir dir;
  std::string data = "$ElementNodeData\n1\n\"strain\"\n1\n0\n3\n0\n1\n3\n";
  for (std::int32_t i = 0; i < 3; ++i) {
    for (const std::int32_t n : {i + 1, 2}) data.append(reinterpret_cast<const char*>(&n), 4);
    data += "0123456789abcdef";
  }
  for (const char* name : {"block_msh22_binary_order1.msh", "block_msh41_binary_order1.msh"}) {
    const std::string content =
        load((data_directory() / name).string()) + data + "$EndElementNodeData\n//+\n";
    truncate_everywhere(dir, name, content, 97 + content.size() / 100);
    flip_bytes(dir, name, content, 100);
    // Damage in the section alone.
    for (std::size_t at = content.size() - data.size() - 26; at < content.size(); ++at) {
      std::string damaged = content;
      damaged[at] = static_cast<char>('0' + at % 10);
      CAPTURE(name, at);
      must_survive(dir.write(name, damaged));
    }
  }
  const std::string two =
      "//+\n" + replaced(gmsh22_text(), "2 2 2 5 1 2 3 4", "2 2 2 0 8 2 3 4") + "Show \"*\";\n";
  fuzz(dir, "a.msh", two);
  fuzz(dir, "b.inp",
       "*HEADING\n*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n4, 0, 0, 1\n*ELEMENT, TYPE=C3D4, ELSET=e\n1, 1, "
       "2, 3, 4\n"
       "*NSET, NSET=a\n1, 2, a\n*ELSET, ELSET=f, GENERATE\n1, 1, 1\n*SURFACE, NAME=s\nf, S1\n*SOLID SECTION, "
       "ELSET=f\n");
  fuzz(dir, "c.feb", "<?xml version=\"1.0\"?>\n<febio_spec version=\"3.0\">\n<Mesh/></febio_spec>\n");
}

TEST_CASE("mesh: damaged TetGen files", "[mesh][fuzz]") {
  const TempDir dir;
  const std::string nodes = "4 3 1 1\n1 0 0 0 5 1\n2 1 0 0 5 1\n3 0 1 0 5 1\n4 0 0 1 5 0\n";
  const std::string cells = "1 4 1\n1 1 2 3 4 7\n", faces = "1 1\n1 1 2 3 5\n";
  dir.write("a.ele", cells);
  dir.write("a.face", faces);
  fuzz(dir, "a.node", nodes);
  dir.write("a.node", nodes);
  fuzz(dir, "a.ele", cells);
  dir.write("a.ele", cells);
  // Read by way of the points, as damage in .face alone must not pass for another format.
  for (std::size_t size = 0; size < faces.size(); ++size) {
    dir.write("a.face", faces.substr(0, size));
    must_survive(dir.file("a.node"));
  }
}

TEST_CASE("mesh: damaged files as Gmsh writes them", "[mesh][fuzz]") {
  const TempDir dir;
  for (const char* name :
       {"block_msh22_order1.msh", "block_msh22_binary_order1.msh", "block_msh22_binary_order2.msh",
        "block_msh41_order2.msh", "block_msh41_binary_order1.msh", "block_order1.vtk",
        "block_binary_order1.vtk", "block_order1.mesh"}) {
    const std::string content = load((data_directory() / name).string());
    REQUIRE_FALSE(content.empty());
    truncate_everywhere(dir, name, content, 97 + content.size() / 200);
    flip_bytes(dir, name, content, 150);
  }
}
