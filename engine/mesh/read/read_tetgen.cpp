// TetGen: .node with the points, .ele with the tetrahedra and .face, if it is there, with the surfaces.
#include <array>
#include <cmath>
#include <filesystem>

#include "engine/mesh/read/readers.h"

namespace isochor::mesh_files {

namespace {

std::string beside(const std::string& file, const char* extension) {
  return std::filesystem::path(file).replace_extension(extension).string();
}

std::int64_t next_integer(Cursor& at, const char* what) {
  at.skip_space_and_comments();
  return at.integer(what);
}

double next_real(Cursor& at, const char* what) {
  at.skip_space_and_comments();
  return at.real(what);
}

// 0 or 1; some writers leave the last number of a header out.
bool header_mark(Cursor& at) {
  const std::size_t start = at.offset();
  std::string_view rest = at.line("a mark");
  at.move_to(start);
  rest = rest.substr(0, rest.find('#'));
  if (rest.find_first_not_of(" \t") == rest.npos) return false;
  const std::int64_t mark = at.integer("a mark");
  if (mark != 0 && mark != 1) at.fail(join("the mark is ", mark, ", neither 0 nor 1"), rewrite_file);
  return mark == 1;
}

void read_nodes(Cursor& at, RawMesh& raw) {
  at.set_section("the .node file");
  const std::int64_t promised = next_integer(at, "the number of points");
  const std::size_t count = at.checked_count(promised, 8, "the number of points");
  const std::int64_t dim = next_integer(at, "the dimension");
  if (dim != 3) at.fail(join("the dimension is ", dim, ", not 3"), "export a volume mesh");
  const std::int64_t attributes = next_integer(at, "the number of attributes");
  if (attributes < 0 || attributes > 1000) at.fail(join(attributes, " attributes"), rewrite_file);
  const bool marked = header_mark(at);
  MeshField field{"attributes", static_cast<int>(attributes), {}};
  for (std::size_t i = 0; i < count; ++i) {
    raw.node_label.push_back(next_integer(at, "a point number"));
    Vec3 x;
    for (int k = 0; k < 3; ++k) x[k] = next_real(at, "a coordinate");
    raw.nodes.push_back(x);
    for (std::int64_t k = 0; k < attributes; ++k) field.values.push_back(next_real(at, "an attribute"));
    if (!marked) continue;
    const std::int64_t mark = next_integer(at, "a boundary mark");
    if (mark != 0) raw.node_sets[{0, mark}].nodes.push_back(static_cast<Index>(i));
  }
  if (attributes > 0) raw.fields.push_back(std::move(field));
  // Points count from 0 or from 1, all in sequence; anything else is a line too many or too few.
  if (count > 0 && raw.node_label[0] != 0 && raw.node_label[0] != 1) {
    at.fail(join("the first point has number ", raw.node_label[0], ", neither 0 nor 1"), rewrite_file);
  }
}

Index node(Cursor& at, const LabelMap& index, const RawMesh& raw) {
  const std::int64_t label = next_integer(at, "a point number");
  const Index found = index.find(label);
  if (found < 0) {
    at.fail(join("point ", label, " is not among the ", raw.nodes.size(), " points of the .node file"),
            rewrite_file);
  }
  return found;
}

// Attributes of regions are real numbers in TetGen, though nearly always whole. Those that are not get a
// number below all others and their value as the name.
class RegionTags {
 public:
  std::int64_t tag(double attribute, RawMesh& raw) {
    constexpr double largest = 9007199254740992.0;
    if (attribute == std::floor(attribute) && std::abs(attribute) <= largest) {
      return static_cast<std::int64_t>(attribute);
    }
    const auto [entry, added] =
        other_.emplace(attribute, no_tag + 1 + static_cast<std::int64_t>(other_.size()));
    if (added) raw.region_name[entry->second] = shown(attribute);
    return entry->second;
  }

 private:
  std::map<double, std::int64_t> other_;
};

void read_cells(Cursor& at, const LabelMap& index, RawMesh& raw) {
  at.set_section("the .ele file");
  const std::int64_t promised = next_integer(at, "the number of tetrahedra");
  const std::size_t count = at.checked_count(promised, 10, "the number of tetrahedra");
  const std::int64_t width = next_integer(at, "the number of nodes a tetrahedron");
  if (width != 4 && width != 10) {
    at.fail(join(width, " nodes a tetrahedron, neither 4 nor 10"), "mesh with order 1 or 2 (-o2)");
  }
  const bool has_region = header_mark(at);
  std::array<Index, 10> nodes{};
  RegionTags regions;
  for (std::size_t c = 0; c < count; ++c) {
    const std::int64_t label = next_integer(at, "a tetrahedron number");
    for (std::int64_t k = 0; k < width; ++k) nodes[static_cast<std::size_t>(k)] = node(at, index, raw);
    const std::int64_t tag = has_region ? regions.tag(next_real(at, "a region attribute"), raw) : no_tag;
    raw.add_cell(at, label, tag, {nodes.data(), static_cast<std::size_t>(width)}, tetgen_tet10);
  }
}

std::size_t words_in(std::string_view line) {
  std::size_t words = 0;
  bool inside = false;
  for (const char c : line.substr(0, line.find('#'))) {
    const bool space = c == ' ' || c == '\t' || c == '\r';
    words += !space && !inside ? 1 : 0;
    inside = !space;
  }
  return words;
}

// Only marked faces make surfaces. Depending on TetGen's switches a line also has three mid-edge nodes and
// two neighbors; assemble() knows the mid-edge nodes from the cells, so both are passed over.
void read_faces(Cursor& at, const LabelMap& index, RawMesh& raw) {
  at.set_section("the .face file");
  const std::int64_t promised = next_integer(at, "the number of faces");
  const std::size_t count = at.checked_count(promised, 8, "the number of faces");
  const bool marked = header_mark(at);
  for (std::size_t i = 0; i < count; ++i) {
    at.skip_space_and_comments();
    const std::size_t start = at.offset();
    const std::size_t words = words_in(at.line("a face"));
    const std::size_t end = at.offset();
    at.move_to(start);
    // Number, 3 or 6 nodes, the mark, and 0 or 2 neighbors.
    const std::size_t plain = marked ? 5 : 4;
    const bool straight = words == plain || words == plain + 2;
    if (!straight && words != plain + 3 && words != plain + 5) {
      at.fail(join("a face of ", words, " numbers"), "write the .face file with 3 or 6 nodes a face");
    }
    next_integer(at, "a face number");
    std::array<Index, 3> corners{};
    for (Index& n : corners) n = node(at, index, raw);
    for (int k = 0; k < 3 && !straight; ++k) node(at, index, raw);
    const std::int64_t mark = marked ? next_integer(at, "a boundary mark") : 0;
    if (mark != 0) raw.add_face(at, mark, corners);
    at.move_to(end);
  }
}

}  // namespace

RawMesh read_tetgen(const std::string& file) {
  RawMesh raw;
  raw.file = file;
  const std::string node_file = beside(file, ".node"), ele_file = beside(file, ".ele"),
                    face_file = beside(file, ".face");
  const std::string points = load_file(node_file);
  Cursor at(points, node_file);
  read_nodes(at, raw);
  LabelMap index;
  const auto [unique, label] = index.build(raw.node_label);
  if (!unique) at.fail(join("point ", label, " is defined twice"), rewrite_file);
  const std::string cells = load_file(ele_file);
  at = Cursor(cells, ele_file);
  read_cells(at, index, raw);
  std::error_code ignored;
  if (std::filesystem::exists(face_file, ignored)) {
    const std::string faces = load_file(face_file);
    at = Cursor(faces, face_file);
    read_faces(at, index, raw);
  }
  return raw;
}

}  // namespace isochor::mesh_files
