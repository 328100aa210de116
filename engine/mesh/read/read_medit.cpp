// Medit files (.mesh), ASCII. References of cells number the regions, those of faces the surfaces.
#include <array>

#include "engine/mesh/read/readers.h"

namespace isochor::mesh_files {

namespace {

struct MeditFile {
  Cursor at;
  RawMesh raw;
};

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

std::string_view next_word(MeditFile& f) {
  f.at.skip_space_and_comments();
  return f.at.peek_word();
}

std::int64_t next_integer(MeditFile& f, const char* what) {
  f.at.skip_space_and_comments();
  return f.at.integer(what);
}

void read_vertices(MeditFile& f) {
  if (!f.raw.nodes.empty()) f.at.fail("Vertices occurs twice", rewrite_file);
  const std::int64_t promised = next_integer(f, "the number of vertices");
  const std::size_t count = f.at.checked_count(promised, 8, "the number of vertices");
  f.raw.nodes.reserve(count);
  f.raw.node_label.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    f.at.skip_space_and_comments();
    Vec3 x;
    for (int k = 0; k < 3; ++k) x[k] = f.at.real("a coordinate");
    // The reference of a vertex is the number of a CAD entity, nothing that an author chose.
    next_integer(f, "the reference of a vertex");
    f.raw.nodes.push_back(x);
    f.raw.node_label.push_back(static_cast<std::int64_t>(i) + 1);
  }
}

void read_elements(MeditFile& f, std::size_t width, bool cells) {
  const std::int64_t promised = next_integer(f, "the number of elements");
  const std::size_t count = f.at.checked_count(promised, 2 * width + 2, "the number of elements");
  const auto nodes = static_cast<std::int64_t>(f.raw.nodes.size());
  std::array<Index, 10> element{};
  for (std::size_t e = 0; e < count; ++e) {
    f.at.skip_space_and_comments();
    for (std::size_t k = 0; k < width; ++k) {
      const std::int64_t n = f.at.integer("a vertex number");
      if (n < 1 || n > nodes) f.at.fail(join("vertex ", n, " where the file has 1 to ", nodes), rewrite_file);
      element[k] = static_cast<Index>(n - 1);
    }
    const std::int64_t reference = f.at.integer("a reference");
    if (cells) {
      const auto label = static_cast<std::int64_t>(f.raw.cell_label.size()) + 1;
      f.raw.add_cell(f.at, label, reference, {element.data(), width}, vtk_tet10);
    } else {
      ++f.raw.flat_cells;
      f.raw.add_face(f.at, reference, {element.data(), width});
    }
  }
}

// Anything up to the next keyword. `known` counts what is lost.
std::int64_t skip(MeditFile& f) {
  const std::string_view first = next_word(f);
  if (first.empty() || is_letter(first[0])) return 0;
  const std::int64_t count = f.at.integer("a count");
  for (std::string_view w = next_word(f); !w.empty() && !is_letter(w[0]); w = next_word(f))
    f.at.word("a number");
  return count;
}

void read_dimension(MeditFile& f) {
  const std::int64_t dimension = next_integer(f, "the dimension");
  if (dimension != 3) f.at.fail(join("the dimension is ", dimension, ", not 3"), "export a volume mesh");
}

void read_part(MeditFile& f, const std::string& keyword) {
  f.at.set_section(keyword);
  if (keyword == "Dimension") return read_dimension(f);
  if (keyword == "Vertices") return read_vertices(f);
  if (keyword == "Tetrahedra") return read_elements(f, 4, true);
  if (keyword == "TetrahedraP2") return read_elements(f, 10, true);
  if (keyword == "Hexahedra") return read_elements(f, 8, true);
  if (keyword == "Triangles") return read_elements(f, 3, false);
  if (keyword == "TrianglesP2") return read_elements(f, 6, false);
  if (keyword == "Quadrilaterals") return read_elements(f, 4, false);
  const std::int64_t count = skip(f);
  if (count <= 0) return;
  if (keyword.starts_with("Hexahedra") || keyword.starts_with("Prisms") || keyword.starts_with("Pyramids")) {
    f.raw.foreign_cells[keyword] += count;
  } else if (keyword.starts_with("Quadrilaterals")) {
    f.raw.foreign_faces += count;
  }
}

}  // namespace

RawMesh read_medit(std::string_view content, const std::string& file) {
  MeditFile f{Cursor(content, file), {}};
  f.raw.file = file;
  if (next_word(f) != "MeshVersionFormatted") {
    f.at.fail("the file begins with " + quoted(next_word(f)) + " instead of MeshVersionFormatted",
              "only the ASCII form of Medit files is read");
  }
  f.at.word("MeshVersionFormatted");
  const std::int64_t version = next_integer(f, "the version");
  if (version < 0 || version > 4)
    f.at.fail(join("the version is ", version, ", not 1 to 4"), "export with version 2");
  bool ended = false;
  while (!ended && !next_word(f).empty()) {
    const std::string keyword(f.at.word("a keyword"));
    ended = keyword == "End";
    if (!ended && !is_letter(keyword[0])) {
      f.at.fail("a keyword was expected, not " + quoted(keyword), "correct the counts of the section before");
    }
    if (!ended) read_part(f, keyword);
  }
  // Without its last word a truncated file would pass for a smaller mesh.
  if (!ended) f.at.fail("the file does not close with 'End'", rewrite_file);
  return std::move(f.raw);
}

}  // namespace isochor::mesh_files
