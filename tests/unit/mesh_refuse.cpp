// Malformed files: a message that helps, and never a crash.
#include "mesh_support.h"

using namespace mesh_test;

namespace {

constexpr const char* huge = "99999999999";

}  // namespace

TEST_CASE("mesh: paths that are no file", "[mesh]") {
  const TempDir dir;
  CHECK(mentions(isochor::read_mesh(dir.file("none.msh")).error(), {"none.msh", "no such file"}));
  CHECK(mentions(isochor::read_mesh(dir.file("")).error(), {"directory"}));
  CHECK(mentions(refusal(dir, "empty.msh", ""), {"empty"}));
  CHECK(mentions(refusal(dir, "blank.vtk", " \n\n"), {"empty"}));
  CHECK(mentions(refusal(dir, "odd.xyz", "hello world"), {"hello", "no known mesh format"}));
  CHECK(mentions(refusal(dir, "lone.ele", "1 4 0\n1 1 2 3 4\n"), {"lone.node", "no such file"}));
  CHECK_FALSE(isochor::read_mesh("").ok());
  CHECK_FALSE(isochor::read_mesh("/dev/null").ok());
}

TEST_CASE("mesh: Gmsh refusals name line, value and remedy", "[mesh]") {
  const TempDir dir;
  const std::string two = gmsh22_text(), four = gmsh41_text();
  const auto with = [&](const std::string& text, const char* from, const std::string& to) {
    return refusal(dir, "a.msh", replaced(text, from, to));
  };
  CHECK(mentions(with(two, "2.2 0 8", "4.0 0 8"), {"line 2", "Gmsh format 4", "msh41"}));
  CHECK(mentions(with(two, "2.2 0 8", "2.2 7 8"), {"line 2", "7"}));
  CHECK(mentions(with(two, "$Nodes\n5", std::string("$Nodes\n") + huge), {"line 10", "$Nodes", huge}));
  CHECK(mentions(with(two, "$Nodes\n5", "$Nodes\n1000000000"), {"line 10", "1000000000", "bytes follow"}));
  CHECK(mentions(with(two, "$Nodes\n5", "$Nodes\n-5"), {"-5", "negative"}));
  CHECK(mentions(with(two, "$Nodes\n5", "$Nodes\n4"), {"$EndNodes was expected"}));
  CHECK(mentions(with(two, "2 1 0 0", "2 nan 0 0"), {"line 12", "nan", "finite"}));
  CHECK(mentions(with(two, "2 1 0 0", "2 1e999 0 0"), {"line 12", "1e999"}));
  CHECK(mentions(with(two, "2 1 0 0", "1 1 0 0"), {"node 1 is defined twice"}));
  CHECK(mentions(with(two, "2 3 4 5\n", "2 3 4 99\n"), {"line 22", "node 99"}));
  CHECK(mentions(with(two, "4 4 2 7 2 2 3 4 5", "4 777 2 7 2 2 3 4 5"), {"line 22", "777"}));
  CHECK(mentions(with(two, "$Elements\n4", std::string("$Elements\n") + huge), {huge}));
  CHECK(mentions(with(four, "1 5 10 50", std::string("1 ") + huge + " 1 5"), {huge, "$Nodes"}));
  CHECK(mentions(with(four, "3 1 0 5", "3 1 0 6"), {"a block of 6 nodes where 5 are left"}));
  CHECK(mentions(with(four, "$Entities\n1 0 1 2", std::string("$Entities\n") + huge + " 0 1 2"), {huge}));
  CHECK(mentions(with(four, "4 4 1 4", "4 9 1 4"), {"4 elements but 9"}));
  CHECK(mentions(with(four, "$EndElements", "$Elephants"), {"$EndElements"}));
  CHECK(mentions(refusal(dir, "b.msh", "$NOD\n1\n1 0 0 0\n$ENDNOD\n"), {"$NOD", "format 1"}));
}

TEST_CASE("mesh: Gmsh binary byte order", "[mesh]") {
  const TempDir dir;
  const std::string good = load((data_directory() / "block_msh41_binary_order1.msh").string());
  const std::string mark("\x01\x00\x00\x00", 4);
  CHECK(mentions(refusal(dir, "a.msh", replaced(good, mark, "abcd")), {"byte 20", "byte order mark"}));
  // The other byte order is honored, so the little-endian counts that follow read as nonsense and are
  // refused.
  CHECK_FALSE(refusal(dir, "b.msh", replaced(good, mark, std::string("\x00\x00\x00\x01", 4))).empty());
}

TEST_CASE("mesh: cells other than tetrahedra of one order", "[mesh]") {
  const TempDir dir;
  const std::string hexahedron = replaced(gmsh22_text(), "4 4 2 7 2 2 3 4 5", "4 5 2 7 2 1 2 3 4 5 1 2 3");
  CHECK(mentions(refusal(dir, "a.msh", hexahedron), {"8 nodes", "4", "one kind"}));
  const std::string mixed = replaced(gmsh22_text(), "4 4 2 7 2 2 3 4 5", "4 11 2 7 2 1 2 3 4 5 1 2 3 4 5");
  CHECK(mentions(refusal(dir, "b.msh", mixed), {"line 22", "10 nodes", "one kind and one order"}));
  const std::string cubic =
      replaced(gmsh22_text(), "4 4 2 7 2 2 3 4 5", "4 29 2 7 2 1 2 3 4 5 1 2 3 4 5 1 2 3 4 5 1 2 3 4 5");
  CHECK(mentions(refusal(dir, "c.msh", cubic), {"1 20-node tetrahedra"}));
  const std::string surface =
      replaced(gmsh22_text(), "4\n1 15 2 9 1 1\n2 2 2 5 1 2 3 4\n3 4 2 3 1 1 2 3 4\n4 4 2 7 2 2 3 4 5",
               "1\n2 2 2 5 1 2 3 4");
  CHECK(mentions(refusal(dir, "d.msh", surface), {"no tetrahedra or hexahedra, only 1 faces", "3D"}));
  CHECK(mentions(refusal(dir, "e.vtk", replaced(vtk_text(), "5\n10\n10\nCELL_DATA", "5\n10\n14\nCELL_DATA")),
                 {"1 pyramids"}));
  CHECK(mentions(refusal(dir, "f.vtk", replaced(vtk_text(), "5\n10\n10\nCELL_DATA", "5\n10\n24\nCELL_DATA")),
                 {"4 points instead of 10"}));
  CHECK(
      mentions(refusal(dir, "g.mesh", replaced(medit_text(), "End", "Hexahedra\n1\n1 2 3 4 5 1 2 3 0\nEnd")),
               {"8 nodes", "one kind"}));
}

TEST_CASE("mesh: VTK legacy refusals", "[mesh]") {
  const TempDir dir;
  const auto with = [&](const char* from, const std::string& to) {
    return refusal(dir, "a.vtk", replaced(vtk_text(), from, to));
  };
  CHECK(mentions(with("Version 3.0", "Version 9.0"), {"line 1", "9.0"}));
  CHECK(mentions(with("UNSTRUCTURED_GRID", "POLYDATA"), {"POLYDATA", "UNSTRUCTURED_GRID"}));
  CHECK(mentions(with("POINTS 5", std::string("POINTS ") + huge), {"line 5", huge}));
  CHECK(mentions(with("CELLS 3 14", std::string("CELLS 3 ") + huge), {huge}));
  CHECK(mentions(with("CELLS 3 14", "CELLS 4 14"), {"cell 3"}));
  CHECK(mentions(with("4 1 2 3 4", "4 1 2 3 5"), {"cell 2", "point 5", "0 to 4"}));
  CHECK(mentions(with("4 1 2 3 4", "4 1 2 3 -1"), {"point -1"}));
  CHECK(mentions(with("0 0 0 1 0", "0 0 0 nan 0"), {"point 1", "nan"}));
  CHECK(mentions(with("0 0 0 1 0", "0 0 0 x 0"), {"line 6", "'x'"}));
  CHECK(mentions(with("CELL_TYPES 3\n5\n10\n10", "CELL_TYPES 2\n5\n10"), {"2 types for 3 cells"}));
  CHECK(mentions(with("CELL_DATA 3", "CELL_DATA 5"), {"5", "3 cells"}));
  CHECK(mentions(with("VECTORS", "VICTORS"), {"VICTORS"}));
}

TEST_CASE("mesh: VTU refusals", "[mesh]") {
  const TempDir dir;
  const auto with = [&](const char* from, const std::string& to) {
    return refusal(dir, "a.vtu", replaced(vtu_text(), from, to));
  };
  CHECK(mentions(with("type=\"UnstructuredGrid\"", "type=\"PolyData\""), {"PolyData", "UnstructuredGrid"}));
  CHECK(mentions(with("</Cells>", "</Cell>"), {"line 10", "XML"}));
  CHECK(mentions(with("NumberOfPoints=\"5\"", std::string("NumberOfPoints=\"") + huge + "\""),
                 {huge, "15 coordinates"}));
  CHECK(mentions(with("NumberOfCells=\"3\"", "NumberOfCells=\"-3\""), {"-3"}));
  CHECK(mentions(with("version=\"0.1\"", "compressor=\"vtkLZ4DataCompressor\""), {"LZ4", "zlib"}));
  CHECK(mentions(with("\"offsets\"", "\"offset\""), {"offsets", "missing"}));
  CHECK(mentions(with("3 7 11", "3 7 12"), {"cell 2", "12"}));
  CHECK(mentions(with("3 7 11", "3 -7 11"), {"cell 1"}));
  CHECK(mentions(with("1 2 3 4</Data", "1 2 3 5</Data"), {"cell 2", "point 5"}));
  CHECK(mentions(with("1 1 1</Data", "1 1 inf</Data"), {"point 4", "inf"}));
  CHECK(mentions(with("format=\"ascii\">5 3 7<", "format=\"binary\">////fwAA<"), {"region", "bytes"}));
  CHECK(mentions(with("format=\"ascii\">5 3 7<", "format=\"appended\" offset=\"7\"><"), {"offset '7'"}));
  CHECK(mentions(with("type=\"Int32\"", "type=\"Int33\""), {"Int33"}));
}

TEST_CASE("mesh: Medit and TetGen refusals", "[mesh]") {
  const TempDir dir;
  const auto medit = [&](const char* from, const std::string& to) {
    return refusal(dir, "a.mesh", replaced(medit_text(), from, to));
  };
  CHECK(mentions(medit("Formatted 2", "Formatted 9"), {"9"}));
  CHECK(mentions(medit("Dimension 3", "Dimension 2"), {"line 3", "2, not 3"}));
  CHECK(mentions(medit("Vertices\n5", std::string("Vertices\n") + huge), {"line 5", huge}));
  CHECK(mentions(medit("2 3 4 5 7", "2 3 4 6 7"), {"vertex 6", "1 to 5"}));
  CHECK(mentions(medit("2 3 4 5 7", "2 3 4 0 7"), {"vertex 0"}));
  CHECK(mentions(medit("Tetrahedra\n2", "Tetrahedra\n1"), {"keyword", "'2'"}));
  CHECK(mentions(medit("End\n", ""), {"End"}));
  CHECK(
      mentions(refusal(dir, "b.meshb", std::string("\x01\0\0\0\x03\0\0\0", 8)), {"binary Medit", "meshio"}));
  const auto tetgen = [&](const std::string& nodes, const std::string& cells) {
    dir.write("t.node", nodes);
    return refusal(dir, "t.ele", cells);
  };
  const std::string nodes = "4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n", cells = "1 4 0\n1 1 2 3 4\n";
  CHECK(tetgen(nodes, cells).empty());
  CHECK(
      mentions(tetgen(replaced(nodes, "4 3", std::string(huge) + " 3"), cells), {"t.node", "line 1", huge}));
  CHECK(mentions(tetgen(replaced(nodes, "3 0 1", "3 0 inf"), cells), {"t.node", "line 4", "inf"}));
  CHECK(mentions(tetgen(nodes, "1 4 0\n1 0 1 2 3\n"), {"t.ele", "line 2", "point 0"}));
  CHECK(mentions(tetgen(nodes, "1 7 0\n1 1 2 3 4\n"), {"7 nodes"}));
  CHECK(mentions(tetgen(replaced(nodes, "\n1 0", "\n5 0"), cells), {"number 5", "neither 0 nor 1"}));
  dir.write("t.face", "1 1\n1 1 2\n");
  CHECK(mentions(tetgen(nodes, cells), {"t.face", "3 numbers"}));
}
