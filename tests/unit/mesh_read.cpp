// What each format's reader makes of well-formed files.
#include <bit>

#include "mesh_support.h"

using namespace mesh_test;

namespace {

// The mesh that all small files describe; `named` if the format knows names.
void check_two_tets(const Mesh& mesh, bool named) {
  CHECK(mesh.cell_type == CellType::tet4);
  CHECK(mesh.nodes == two_tets().nodes);
  CHECK(mesh.cells == std::vector<Index>{0, 1, 2, 3, 1, 2, 3, 4});
  CHECK(mesh.regions == std::vector<std::string>{named ? "lower part" : "3", "7"});
  CHECK(mesh.cell_region == std::vector<Index>{0, 1});
  REQUIRE(mesh.surfaces.size() == 1);
  CHECK(mesh.surfaces[0].name == (named ? "top" : "5"));
  CHECK(mesh.surfaces[0].faces == std::vector<Index>{1, 2, 3});
}

template <class T>
std::string big_endian(std::initializer_list<T> values) {
  std::string bytes;
  for (T value : values) {
    char piece[sizeof(T)];
    std::memcpy(piece, &value, sizeof(T));
    if constexpr (std::endian::native == std::endian::little) std::reverse(piece, piece + sizeof(T));
    bytes.append(piece, sizeof(T));
  }
  return bytes;
}

}  // namespace

TEST_CASE("mesh: Gmsh 2.2 text gives regions, surfaces, node sets and fields", "[mesh]") {
  const TempDir dir;
  const Mesh mesh = read(dir.write("a.msh", gmsh22_text()));
  check_two_tets(mesh, true);
  REQUIRE(mesh.node_sets.size() == 1);
  CHECK(mesh.node_sets[0].name == "9");
  CHECK(mesh.node_sets[0].nodes == std::vector<Index>{0});
  REQUIRE(mesh.fields.size() == 1);
  CHECK(mesh.fields[0].name == "weight");
  CHECK(mesh.fields[0].values == std::vector<double>{0, 0.25, 0, 0, 4});
  CHECK(mesh.cell_label == std::vector<std::int64_t>{3, 4});
  CHECK(mesh.node_label.empty());
}

TEST_CASE("mesh: Gmsh 4.1 text with gaps in the node numbers", "[mesh]") {
  const TempDir dir;
  const Mesh mesh = read(dir.write("a.msh", gmsh41_text()));
  check_two_tets(mesh, true);
  CHECK(mesh.node_label == std::vector<std::int64_t>{10, 20, 30, 40, 50});
  // Numbers too far apart for a table.
  const std::string far =
      replaced(replaced(gmsh41_text(), "\n50\n", "\n5000000000000\n"), "30 40 50\n", "30 40 5000000000000\n");
  CHECK(read(dir.write("far.msh", far)).node_label.back() == 5000000000000);
}

TEST_CASE("mesh: a Gmsh cell in two groups keeps the first, one in none is unassigned", "[mesh]") {
  const TempDir dir;
  const Mesh both = read(dir.write("a.msh", replaced(gmsh41_text(), "1 1 1 1 3 0", "1 1 1 2 3 8 0")));
  CHECK(both.cell_region[0] == 0);
  CHECK(find(check_mesh(both), "cell-in-several-regions")->examples == std::vector<std::int64_t>{3});
  const Mesh none = read(dir.write("b.msh", replaced(gmsh41_text(), "1 1 1 1 7 0", "1 1 1 0 0")));
  CHECK(none.regions == std::vector<std::string>{"lower part", "unassigned"});
  CHECK(none.cell_region == std::vector<Index>{0, 1});
  CHECK(find(check_mesh(none), "unassigned-cell")->count == 1);
  // Format 2 says it by writing the cell twice.
  const std::string twice = replaced(replaced(gmsh22_text(), "$Elements\n4\n", "$Elements\n5\n"),
                                     "\n4 4 2 7 2", "\n9 4 2 8 1 1 2 3 4\n4 4 2 7 2");
  const Mesh merged = read(dir.write("c.msh", twice));
  CHECK(merged.cell_count() == 2);
  CHECK(find(check_mesh(merged), "cell-in-several-regions")->count == 1);
}

TEST_CASE("mesh: VTK legacy text", "[mesh]") {
  const TempDir dir;
  const Mesh mesh = read(dir.write("a.vtk", vtk_text()));
  check_two_tets(mesh, false);
  REQUIRE(mesh.fields.size() == 2);
  CHECK(mesh.fields[0].name == "weight a");
  CHECK(mesh.fields[1].components == 3);
  CHECK(mesh.fields[1].values[5] == 3);
  CHECK(mesh.node_label == std::vector<std::int64_t>{0, 1, 2, 3, 4});
}

TEST_CASE("mesh: VTK legacy 5.1 binary with offsets", "[mesh]") {
  const TempDir dir;
  std::string text = "# vtk DataFile Version 5.1\ntwo\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 float\n";
  text += big_endian<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1});
  text += "\nCELLS 4 11\nOFFSETS vtktypeint64\n" + big_endian<std::int64_t>({0, 3, 7, 11});
  text += "\nCONNECTIVITY vtktypeint64\n" + big_endian<std::int64_t>({1, 2, 3, 0, 1, 2, 3, 1, 2, 3, 4});
  text += "\nCELL_TYPES 3\n" + big_endian<std::int32_t>({5, 10, 10});
  text += "\nMETADATA\nINFORMATION 0\n\nCELL_DATA 3\nFIELD FieldData 1\nMaterialIds 1 3 unsigned_char\n";
  text += std::string("\x05\x03\x07", 3) + "\n";
  check_two_tets(read(dir.write("a.vtk", text)), false);
}

TEST_CASE("mesh: VTU text and inline base64", "[mesh]") {
  const TempDir dir;
  const Mesh mesh = read(dir.write("a.vtu", vtu_text()));
  check_two_tets(mesh, false);
  CHECK(mesh.fields.at(0).values == std::vector<double>{0, 0.25, 0, 0, 4});
  // Header (12 bytes, UInt32) and three Int32 in one base64 stream.
  const std::string packed = replaced(vtu_text(), "Name=\"region\" format=\"ascii\">5 3 7<",
                                      "Name=\"region\" format=\"binary\">\nDAAAAAUAAAADAAAABwAAAA==\n<");
  check_two_tets(read(dir.write("b.vtu", packed)), false);
  // The same with the header encoded on its own, as some writers do.
  const std::string apart = replaced(vtu_text(), "Name=\"region\" format=\"ascii\">5 3 7<",
                                     "Name=\"region\" format=\"binary\">DAAAAA==BQAAAAMAAAAHAAAA<");
  check_two_tets(read(dir.write("c.vtu", apart)), false);
}

TEST_CASE("mesh: VTU with appended base64", "[mesh]") {
  const TempDir dir;
  std::string text = replaced(vtu_text(), "Name=\"region\" format=\"ascii\">5 3 7</DataArray>",
                              "Name=\"region\" format=\"appended\" offset=\"2\"/>");
  text = replaced(text, "</VTKFile>",
                  "<AppendedData encoding=\"base64\">\n_AADAAAAAUAAAADAAAABwAAAA==</AppendedData></VTKFile>");
  check_two_tets(read(dir.write("a.vtu", text)), false);
}

TEST_CASE("mesh: Medit text", "[mesh]") {
  const TempDir dir;
  check_two_tets(read(dir.write("a.mesh", medit_text())), false);
}

TEST_CASE("mesh: TetGen with numbers from 0 or from 1", "[mesh]") {
  const TempDir dir;
  dir.write("a.node",
            "# points\n5 3 1 1\n0 0 0 0 0.5 0\n1 1 0 0 0 2\n2 0 1 0 0 2\n3 0 0 1 0 0\n4 1 1 1 9 0\n");
  const std::string cells = dir.write("a.ele", "2 4 1\n0 0 1 2 3 3\n1 1 2 3 4 7 # last\n");
  dir.write("a.face", "2 1\n0 1 2 3 5\n1 0 1 2 0\n");
  const Mesh zero = read(cells);
  check_two_tets(zero, false);
  CHECK(zero.node_sets.at(0).nodes == std::vector<Index>{1, 2});
  CHECK(zero.fields.at(0).values == std::vector<double>{0.5, 0, 0, 0, 9});
  const std::string nodes = dir.write("b.node", "5 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1\n");
  dir.write("b.ele", "2 4 0\n1 1 2 3 4\n2 2 3 4 5\n");
  const Mesh one = read(nodes);
  CHECK(one.cells == zero.cells);
  CHECK(one.regions == std::vector<std::string>{"unassigned"});
  CHECK(one.cell_region.empty());
}

TEST_CASE("mesh: TetGen's own order of mid-edge nodes", "[mesh]") {
  const TempDir dir;
  dir.write("a.node",
            "10 3 0 0\n1 0 0 0\n2 2 0 0\n3 0 2 0\n4 0 0 2\n5 0 1 1\n6 0 0 1\n7 1 0 0\n8 1 1 0\n9 1 0 1\n10 0 "
            "1 0\n");
  dir.write("a.face", "1 1\n1 1 2 3 8 10 7 4\n");
  const Mesh mesh = read(dir.write("a.ele", "1 10 0\n1 1 2 3 4 5 6 7 8 9 10\n"));
  CHECK(mid_edge_error(mesh) == 0);
  CHECK(mesh.notes.empty());
  CHECK(mesh.surfaces.at(0).faces == std::vector<Index>{0, 1, 2, 6, 7, 9});
}

TEST_CASE("mesh: mid-edge nodes in a foreign order are put where they lie", "[mesh]") {
  const TempDir dir;
  // The last two exchanged: Gmsh's order in a VTK file.
  const std::string text =
      "# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 10 double\n"
      "0 0 0 2 0 0 0 2 0 0 0 2 1 0 0 1 1 0 0 1 0 0 0 1 0 1 1 1 0 1\nCELLS 1 11\n10 0 1 2 3 4 5 6 7 8 "
      "9\nCELL_TYPES 1\n24\n";
  const Mesh mesh = read(dir.write("a.vtk", text));
  CHECK(mid_edge_error(mesh) == 0);
  CHECK(find(check_mesh(mesh), "mid-edges-reordered") != nullptr);
}

TEST_CASE("mesh: inverted cells are turned over with their mid-edge nodes", "[mesh]") {
  const TempDir dir;
  const Mesh linear = read(dir.write("a.msh", replaced(gmsh22_text(), "1 1 2 3 4", "1 2 1 3 4")));
  CHECK(cell_volume(linear, 0) > 0);
  const MeshReport report = check_mesh(linear);
  CHECK(report.usable());
  REQUIRE(find(report, "turned-cell") != nullptr);
  CHECK(find(report, "turned-cell")->examples == std::vector<std::int64_t>{3});
  const std::string text =
      "# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 10 double\n"
      "0 0 0 2 0 0 0 2 0 0 0 -2 1 0 0 1 1 0 0 1 0 0 0 -1 1 0 -1 0 1 -1\n"
      "CELLS 1 11\n10 0 1 2 3 4 5 6 7 8 9\nCELL_TYPES 1\n24\n";
  const Mesh curved = read(dir.write("a.vtk", text));
  CHECK(cell_volume(curved, 0) > 0);
  CHECK(mid_edge_error(curved) == 0);
  CHECK(check_mesh(curved).volume == Approx(8.0 / 6));
}

TEST_CASE("mesh: nodes that no cell uses are left out and counted", "[mesh]") {
  const TempDir dir;
  const std::string text =
      replaced(replaced(gmsh22_text(), "$Nodes\n5\n1 0 0 0", "$Nodes\n6\n77 9 9 9\n1 0 0 0"),
               "2 2 2 5 1 2 3 4", "2 2 2 5 1 2 3 77");
  const Mesh mesh = read(dir.write("a.msh", text));
  CHECK(mesh.node_count() == 5);
  CHECK(mesh.cells[0] == 0);
  CHECK(mesh.fields.at(0).values == std::vector<double>{0, 0.25, 0, 0, 4});
  const MeshReport report = check_mesh(mesh);
  CHECK(find(report, "dropped-node")->examples == std::vector<std::int64_t>{77});
  CHECK(find(report, "surface-without-cells")->count == 1);
  CHECK(find(report, "empty-surface") != nullptr);
}

TEST_CASE("mesh: the scale multiplies coordinates", "[mesh]") {
  const TempDir dir;
  CHECK(read(dir.write("a.mesh", medit_text()), 1e-3).nodes[4] == Vec3{1e-3, 1e-3, 1e-3});
  CHECK_FALSE(isochor::read_mesh(dir.file("a.mesh"), {0.0}).ok());
  CHECK_FALSE(isochor::read_mesh(dir.file("a.mesh"), {std::nan("")}).ok());
}

TEST_CASE("mesh: the content tells the format, not the extension", "[mesh]") {
  const TempDir dir;
  check_two_tets(read(dir.write("a.vtu", gmsh41_text())), true);
  check_two_tets(read(dir.write("b.msh", medit_text())), false);
  check_two_tets(read(dir.write("c.txt", vtu_text())), false);
  check_two_tets(read(dir.write("d", vtk_text())), false);
}

TEST_CASE("mesh: carriage returns do no harm", "[mesh]") {
  const TempDir dir;
  for (const auto& [name, text] : {std::pair<std::string, std::string>{"a.msh", gmsh22_text()},
                                   {"b.msh", gmsh41_text()},
                                   {"c.vtk", vtk_text()},
                                   {"d.mesh", medit_text()}}) {
    std::string windows;
    for (const char c : text) windows += c == '\n' ? std::string("\r\n") : std::string(1, c);
    CHECK(read(dir.write(name, windows)).cell_count() == 2);
  }
}

TEST_CASE("mesh: files written by Gmsh agree in every format", "[mesh]") {
  for (const auto& entry : std::filesystem::directory_iterator(data_directory())) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with("block_")) continue;
    CAPTURE(name);
    const Mesh mesh = read(entry.path().string());
    const bool curved = name.find("order2") != name.npos;
    CHECK(mesh.cell_type == (curved ? CellType::tet10 : CellType::tet4));
    CHECK(mesh.cell_count() == 242);
    CHECK(mesh.node_count() == (curved ? 466 : 78));
    CHECK(mesh.regions.size() == 2);
    CHECK(mid_edge_error(curved ? mesh : Mesh{}) < 1e-12);
    for (Index c = 0; c < mesh.cell_count(); ++c) CHECK(cell_volume(mesh, c) > 0);
    if (name.ends_with(".msh")) {
      CHECK(mesh.regions == std::vector<std::string>{"soft part", "hard"});
      REQUIRE(mesh.surfaces.size() == 2);
      CHECK(mesh.surfaces[0].name == "cavity");
      CHECK(mesh.surfaces[0].faces.size() == 24u * (curved ? 6 : 3));
      CHECK(mesh.node_sets.at(0).name == "corner");
      CHECK(mesh.nodes[static_cast<std::size_t>(mesh.node_sets.at(0).nodes.at(0))] == Vec3{0, 0, 0});
    }
    const MeshReport report = check_mesh(mesh);
    CHECK(report.usable());
    CHECK(report.volume == Approx(1.5 - 0.064));
    CHECK(report.parts == 1);
    CHECK(find(report, "cavity")->count == 1);
    CHECK(find(report, "surface-off-mesh") == nullptr);
    CHECK(find(report, "mid-edges-reordered") == nullptr);
  }
}
