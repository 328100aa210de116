// Gmsh files with more than their mesh: sections that are skipped, binary data of any bytes, lines that
// belong to no section, faces in no group; and files of other programs.
#include "mesh_support.h"

using namespace mesh_test;

namespace {

template <class T>
void append(std::string& out, const T& value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

// $ElementData or $ElementNodeData as a binary file has it, with numbers of random bytes; some hold the text
// that ends the section.
std::string data_section(std::mt19937& random, bool by_node, bool line_before_end) {
  const std::string name = by_node ? "ElementNodeData" : "ElementData", end = "\n$End" + name + "\n";
  const int count = static_cast<int>(random() % 40), width = std::array{1, 3, 9}[random() % 3];
  std::string text = "$" + name + "\n2\n\"a \"\n\"b\"\n1\n0.5\n4\n0\n" + std::to_string(width) + "\n" +
                     std::to_string(count) + "\n0\n";
  for (int i = 0; i < count; ++i) {
    append(text, std::int32_t(i + 1));
    const int nodes = by_node ? 4 : 1;
    if (by_node) append(text, std::int32_t(nodes));
    std::string bytes;
    while (bytes.size() < std::size_t(8 * width * nodes)) {
      if (random() % 7 == 0)
        bytes += end;
      else
        bytes += static_cast<char>(random() % 256);
    }
    text += bytes.substr(0, std::size_t(8 * width * nodes));
  }
  return text + (line_before_end ? "\n" : "") + "$End" + name + "\n";
}

// Where a section of the file begins that stands on a line of its own.
std::vector<std::size_t> gaps(const std::string& content) {
  std::vector<std::size_t> places;
  for (const char* name : {"$Entities", "$Nodes", "$Elements"}) {
    const std::size_t at = content.find(std::string("\n") + name + "\n");
    if (at != content.npos) places.push_back(at + 1);
  }
  places.push_back(content.size());
  return places;
}

void same_mesh(const Mesh& a, const Mesh& b) {
  CHECK(a.cells == b.cells);
  CHECK(a.nodes == b.nodes);
  CHECK(a.surfaces.size() == b.surfaces.size());
}

const char* const kFiles[] = {"block_msh22_order1.msh", "block_msh22_binary_order2.msh",
                              "block_msh41_order2.msh", "block_msh41_binary_order1.msh"};

}  // namespace

TEST_CASE("mesh: data on elements is skipped by its own counts", "[mesh]") {
  const TempDir dir;
  std::mt19937 random(20);
  for (const char* name : {"block_msh22_binary_order1.msh", "block_msh41_binary_order2.msh"}) {
    const std::string content = load((data_directory() / name).string());
    const Mesh plain = read((data_directory() / name).string());
    for (int round = 0; round < 40; ++round) {
      std::string more = content;
      for (int k = 0; k < 2; ++k) more += data_section(random, random() % 2 == 0, random() % 2 == 0);
      CAPTURE(name, round);
      same_mesh(read(dir.write("a.msh", more)), plain);
    }
  }
}

TEST_CASE("mesh: lines outside of sections are skipped with a note", "[mesh]") {
  const TempDir dir;
  std::mt19937 random(3);
  const std::vector<std::string> lines = {"//+\n", "Show \"*\";\n", "Physical Volume(\"x\") = {1};\n",
                                          "\n",    "12 0.5\n",      "//+ no end $\n"};
  for (const char* name : kFiles) {
    const std::string content = load((data_directory() / name).string());
    const Mesh plain = read((data_directory() / name).string());
    for (int round = 0; round < 15; ++round) {
      std::string more = content;
      const auto places = gaps(content);
      int added = 0;
      for (std::size_t p = places.size(); p-- > 0;) {
        for (auto k = random() % 3; k > 0; --k) {
          const std::string& line = lines[random() % lines.size()];
          more.insert(places[p], line);
          added += line != "\n";
        }
      }
      CAPTURE(name, round);
      const Mesh mesh = read(dir.write("a.msh", more));
      same_mesh(mesh, plain);
      const auto note = std::find_if(mesh.notes.begin(), mesh.notes.end(),
                                     [](const auto& n) { return n.code == "stray-line"; });
      if (added == 0) {
        CHECK(note == mesh.notes.end());
      } else {
        REQUIRE(note != mesh.notes.end());
        CHECK(note->count == added);
      }
    }
  }
}

TEST_CASE("mesh: faces in no group have the number of their entity", "[mesh]") {
  const TempDir dir;
  const auto surfaces = [](const Mesh& mesh) {
    std::vector<std::string> names;
    for (const auto& s : mesh.surfaces) names.push_back(s.name + ":" + std::to_string(s.faces.size() / 3));
    std::sort(names.begin(), names.end());
    return names;
  };
  using Names = std::vector<std::string>;
  const std::string two = gmsh22_text(), four = gmsh41_text();
  CHECK(surfaces(read(dir.write("a.msh", two))) == Names{"top:1"});
  // Physical number 0: none.
  const std::string loose2 = replaced(two, "2 2 2 5 1 2 3 4", "2 2 2 0 8 2 3 4");
  CHECK(surfaces(read(dir.write("b.msh", replaced(loose2, "2\n3 3 \"lower part\"\n2 5 \"top\"",
                                                  "1\n3 3 \"lower part\"")))) == Names{"8:1"});
  CHECK(surfaces(read(dir.write("c.msh", replaced(loose2, "2 5 \"top\"", "2 5 \"8\"")))) ==
        Names{"8:0", "entity 8:1"});
  const std::string loose4 = replaced(four, "1 0 0 0 1 1 1 1 5 0\n", "1 0 0 0 1 1 1 0 0\n");
  CHECK(surfaces(read(dir.write("d.msh", replaced(loose4, "2\n3 3 \"lower part\"\n2 5 \"top\"",
                                                  "1\n3 3 \"lower part\"")))) == Names{"1:1"});
}

TEST_CASE("mesh: files of other programs are named with a remedy", "[mesh]") {
  const TempDir dir;
  std::string stl(80, 'x');
  append(stl, std::uint32_t{2});
  stl += std::string(100, '\0');
  const struct {
    const char* file;
    std::string content;
    std::vector<std::string> says;
  } cases[] = {
      {"a.feb", "<?xml version=\"1.0\"?>\n<febio_spec version=\"3.0\">\n</febio_spec>\n", {"FEBio", "VTK"}},
      {"b.xdmf", "<?xml version=\"1.0\"?>\n<!DOCTYPE Xdmf>\n<Xdmf Version=\"3.0\"/>\n", {"XDMF", "meshio"}},
      {"c.bdf", "$ a comment\nSOL 101\nCEND\nBEGIN BULK\nGRID,1,,0.,0.,0.\nENDDATA\n", {"Nastran", "gmsh"}},
      {"d.nas", "$ pid\nGRID    1               0.      0.      0.\n", {"Nastran"}},
      {"e.msh", "(0 \"fluent\")\n(2 3)\n", {"Fluent", "meshio"}},
      {"f.msh", "(1 \"generated\")\n", {"Fluent"}},
      {"g.stl", "solid a\nfacet normal 0 0 1\n", {"STL", "surface", "lattice"}},
      {"h.stl", stl, {"STL", "surface"}},
      {"i.obj", "# made by x\nv 0 0 0\nv 1 0 0\nf 1 2 3\n", {"OBJ", "surface"}},
      {"j.ply", "ply\nformat ascii 1.0\n", {"PLY", "surface"}},
      {"k.off", "OFF\n3 1 0\n", {"OFF", "surface"}},
      {"l.inp", "8 1 0 0 0\n1 0 0 0\n", {"AVS UCD", "meshio"}},
      {"n.med", "\x89HDF\r\n\x1a\n", {"MED", "gmsh"}},
      {"o.h5", "\x89HDF\r\n\x1a\n", {"HDF5", "meshio"}},
      {"p.step", "ISO-10303-21;\nHEADER;\n", {"STEP", "gmsh"}},
      {"q.STP", "ISO-10303-21;\nHEADER;\n", {"STEP", "gmsh"}},
      {"r.xml", "<?xml version=\"1.0\"?>\n<dolfin><mesh/></dolfin>\n", {"DOLFIN", "meshio"}},
      {"s.vtp",
       "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\">\n</VTKFile>\n",
       {"VTK", "UnstructuredGrid"}},
      {"t.e", std::string("CDF\x01") + std::string(20, '\0'), {"Exodus", "meshio"}},
      {"u.k", "*KEYWORD\n*NODE\n", {"LS-DYNA"}},
      {"v.cdb", "/PREP7\nNBLOCK,6,SOLID\n", {"Ansys"}},
      {"w.vol", "mesh3d\ndimension\n3\n", {"Netgen"}},
      {"x.su2", "NDIME= 3\nNELEM= 1\n", {"SU2"}},
      {"y.unv", "    -1\n  2411\n", {"UNV", "gmsh"}},
      {"z.json", "{\"bodies\": []}\n", {"JSON", "isochor run"}},
      {"za.meshb", std::string("\x01\0\0\0\x02\0\0\0", 8), {"Medit", "meshio"}},
      {"zb.geo", "Box(1) = {0, 0, 0, 1, 1, 1};\n", {"Gmsh geometry", "-3"}},
  };
  for (const auto& c : cases) {
    CAPTURE(c.file);
    const std::string message = refusal(dir, c.file, c.content);
    CHECK(mentions(message, c.says));
    CHECK(message.find("damaged") == message.npos);
  }
}
