// VTK legacy files: unstructured grids, ASCII and binary, up to version 5.1.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "engine/base/chars.h"
#include "engine/mesh/read/readers.h"
#include "engine/mesh/read/vtk_parts.h"

namespace isochor::mesh_files {

namespace {

enum class Target { none, points, cells };

struct VtkFile {
  Cursor at;
  bool has_points = false;
  std::vector<double> coordinates;
  VtkCells cells;
  std::vector<VtkArray> point_arrays, cell_arrays;
  Target target = Target::none;  // whom the arrays that follow belong to
  std::size_t target_count = 0;
};

std::string upper(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = (c >= 'a' && c <= 'z') ? static_cast<char>(c - 'a' + 'A') : c;
  return result;
}

// Names carry spaces and other marks as %20 and alike.
std::string decoded(std::string_view name) {
  std::string text;
  for (std::size_t i = 0; i < name.size(); ++i) {
    int code = 0;
    const char* digits = name.data() + i + 1;
    if (name[i] == '%' && i + 2 < name.size() &&
        std::from_chars(digits, digits + 2, code, 16).ptr == digits + 2) {
      text += static_cast<char>(code);
      i += 2;
    } else {
      text += name[i];
    }
  }
  return text;
}

template <class Stored, class Out>
void read_raw(Cursor& at, std::size_t count, std::vector<Out>& out) {
  for (std::size_t i = 0; i < count; ++i) out.push_back(static_cast<Out>(at.raw<Stored>("a value")));
}

std::size_t stored_bytes(std::string_view type) {
  static constexpr std::array<std::pair<std::string_view, std::size_t>, 16> types{{{"UNSIGNED_CHAR", 1},
                                                                                   {"CHAR", 1},
                                                                                   {"SIGNED_CHAR", 1},
                                                                                   {"UNSIGNED_SHORT", 2},
                                                                                   {"SHORT", 2},
                                                                                   {"UNSIGNED_INT", 4},
                                                                                   {"INT", 4},
                                                                                   {"VTKIDTYPE", 4},
                                                                                   {"UNSIGNED_LONG", 8},
                                                                                   {"LONG", 8},
                                                                                   {"VTKTYPEINT64", 8},
                                                                                   {"VTKTYPEUINT64", 8},
                                                                                   {"UNSIGNED_LONG_LONG", 8},
                                                                                   {"LONG_LONG", 8},
                                                                                   {"FLOAT", 4},
                                                                                   {"DOUBLE", 8}}};
  for (const auto& [name, bytes] : types) {
    if (name == type) return bytes;
  }
  return 0;
}

// The next `count` values of a file type, appended. Binary data starts behind the current line.
template <class Out>
void read_values(Cursor& at, const std::string& type, std::size_t count, std::vector<Out>& out) {
  const std::size_t size = stored_bytes(type);
  if (size == 0)
    at.fail("arrays of type " + quoted(type) + " are not read", "leave the array out when exporting");
  if (at.binary()) at.line("the values");
  if (count > (at.left() + 1) / (at.binary() ? size : 2)) {
    at.fail(join(count, " values are announced but only ", at.left(), " bytes follow"), rewrite_file);
  }
  out.reserve(out.size() + count);
  if (!at.binary()) {
    for (std::size_t i = 0; i < count; ++i) {
      if constexpr (std::is_floating_point_v<Out>) {
        out.push_back(at.any_real("a value"));
      } else {
        out.push_back(at.integer("a value"));
      }
    }
    return;
  }
  const bool is_unsigned = type.starts_with("UNSIGNED") || type == "VTKTYPEUINT64";
  if (type == "FLOAT") return read_raw<float>(at, count, out);
  if (type == "DOUBLE") return read_raw<double>(at, count, out);
  if (size == 1)
    return is_unsigned ? read_raw<std::uint8_t>(at, count, out) : read_raw<std::int8_t>(at, count, out);
  if (size == 2)
    return is_unsigned ? read_raw<std::uint16_t>(at, count, out) : read_raw<std::int16_t>(at, count, out);
  if (size == 4)
    return is_unsigned ? read_raw<std::uint32_t>(at, count, out) : read_raw<std::int32_t>(at, count, out);
  return is_unsigned ? read_raw<std::uint64_t>(at, count, out) : read_raw<std::int64_t>(at, count, out);
}

// Whole numbers for connectivity: a float type here would be nonsense.
void read_whole(Cursor& at, const std::string& type, std::size_t count, std::vector<std::int64_t>& out) {
  if (type == "FLOAT" || type == "DOUBLE") at.fail("indices of type " + quoted(type), rewrite_file);
  read_values(at, type, count, out);
}

void read_points(VtkFile& f) {
  const std::size_t count =
      f.at.checked_count(f.at.integer("the number of points"), 3, "the number of points");
  if (f.has_points) f.at.fail("POINTS occurs twice", rewrite_file);
  f.has_points = true;
  const std::string type = upper(f.at.word("a type"));
  read_values(f.at, type, 3 * count, f.coordinates);
}

// Version 5: offsets and connectivity apart, the first number being cells + 1.
void read_cells5(VtkFile& f, std::size_t offsets, std::size_t entries) {
  Cursor& at = f.at;
  at.word("OFFSETS");
  f.cells.offsets.clear();
  read_whole(at, upper(at.word("a type")), offsets, f.cells.offsets);
  if (f.cells.offsets.empty()) f.cells.offsets.push_back(0);
  if (f.cells.offsets[0] != 0)
    at.fail(join("the first offset is ", f.cells.offsets[0], ", not 0"), rewrite_file);
  if (upper(at.word("CONNECTIVITY")) != "CONNECTIVITY")
    at.fail("CONNECTIVITY does not follow OFFSETS", rewrite_file);
  read_whole(at, upper(at.word("a type")), entries, f.cells.connectivity);
}

void read_cells(VtkFile& f) {
  Cursor& at = f.at;
  const std::size_t count = at.checked_count(at.integer("the number of cells"), 1, "the number of cells");
  const std::size_t size =
      at.checked_count(at.integer("the size of the cell list"), 1, "the size of the cell list");
  if (f.cells.count() > 0) at.fail("CELLS occurs twice", rewrite_file);
  if (upper(at.peek_word()) == "OFFSETS") return read_cells5(f, count, size);
  std::vector<std::int64_t> list;
  read_whole(at, "INT", size, list);
  f.cells.connectivity.reserve(size);
  std::size_t next = 0;
  for (std::size_t c = 0; c < count; ++c) {
    const std::int64_t points = next < size ? list[next] : -1;
    if (points < 0 || static_cast<std::size_t>(points) > size - next - 1) {
      at.fail(join("cell ", c, " does not fit into the cell list of ", size, " numbers"), rewrite_file);
    }
    const auto begin = list.begin() + static_cast<std::ptrdiff_t>(next) + 1;
    f.cells.connectivity.insert(f.cells.connectivity.end(), begin,
                                begin + static_cast<std::ptrdiff_t>(points));
    f.cells.offsets.push_back(static_cast<std::int64_t>(f.cells.connectivity.size()));
    next += static_cast<std::size_t>(points) + 1;
  }
}

void read_cell_types(VtkFile& f) {
  const std::size_t count = f.at.checked_count(f.at.integer("the number of types"), 1, "the number of types");
  read_whole(f.at, "INT", count, f.cells.types);
}

void keep(VtkFile& f, VtkArray array) {
  if (f.target == Target::points) f.point_arrays.push_back(std::move(array));
  if (f.target == Target::cells) f.cell_arrays.push_back(std::move(array));
}

int read_components(Cursor& at) {
  const std::int64_t components = at.integer("the number of components");
  if (components < 1 || components > 10000) at.fail(join(components, " components"), rewrite_file);
  return static_cast<int>(components);
}

void read_field(VtkFile& f) {
  Cursor& at = f.at;
  at.word("a field name");
  const std::int64_t arrays = at.integer("the number of arrays");
  const std::size_t count = at.checked_count(arrays, 8, "the number of arrays");
  for (std::size_t i = 0; i < count; ++i) {
    if (at.peek_word() == "METADATA") at.skip_past("\n\n");
    VtkArray array;
    array.name = decoded(at.word("an array name"));
    array.components = read_components(at);
    const std::size_t tuples =
        at.checked_count(at.integer("the number of tuples"), 1, "the number of tuples");
    const std::string type = upper(at.word("a type"));
    read_values(at, type, tuples * static_cast<std::size_t>(array.components), array.values);
    keep(f, std::move(array));
  }
}

void read_scalars(VtkFile& f) {
  Cursor& at = f.at;
  VtkArray array;
  array.name = decoded(at.word("an array name"));
  const std::string type = upper(at.word("a type"));
  std::string_view next = at.peek_word();
  if (upper(next) != "LOOKUP_TABLE") {
    if (next.size() == 1 && next[0] >= '1' && next[0] <= '4') array.components = read_components(at);
    next = at.peek_word();
  }
  if (upper(next) == "LOOKUP_TABLE") {
    at.word("LOOKUP_TABLE");
    at.word("a table name");
  }
  read_values(at, type, f.target_count * static_cast<std::size_t>(array.components), array.values);
  keep(f, std::move(array));
}

void read_fixed(VtkFile& f, int components, bool count_in_file) {
  VtkArray array;
  array.name = decoded(f.at.word("an array name"));
  array.components = count_in_file ? read_components(f.at) : components;
  const std::string type = upper(f.at.word("a type"));
  read_values(f.at, type, f.target_count * static_cast<std::size_t>(array.components), array.values);
  keep(f, std::move(array));
}

// Colors: bytes in binary files, numbers from 0 to 1 in text; nothing that a Mesh holds.
void skip_colors(VtkFile& f, bool table) {
  f.at.word("a name");
  const std::int64_t number = f.at.integer("a number");
  const std::size_t n = f.at.checked_count(number, 1, "the number of colors");
  std::vector<double> ignored;
  read_values(f.at, f.at.binary() ? "UNSIGNED_CHAR" : "FLOAT", table ? 4 * n : n * f.target_count, ignored);
}

void start_data(VtkFile& f, Target target) {
  f.target = target;
  const std::size_t expected = target == Target::points ? f.coordinates.size() / 3 : f.cells.count();
  const std::int64_t count = f.at.integer("the number of values");
  if (count < 0 || static_cast<std::size_t>(count) != expected) {
    f.at.fail(join("data for ", count, " of ", expected, target == Target::points ? " points" : " cells"),
              rewrite_file);
  }
  f.target_count = expected;
}

void read_part(VtkFile& f, const std::string& keyword) {
  f.at.set_section(keyword);
  if (keyword == "POINTS") return read_points(f);
  if (keyword == "CELLS") return read_cells(f);
  if (keyword == "CELL_TYPES") return read_cell_types(f);
  if (keyword == "POINT_DATA") return start_data(f, Target::points);
  if (keyword == "CELL_DATA") return start_data(f, Target::cells);
  if (keyword == "SCALARS") return read_scalars(f);
  if (keyword == "VECTORS" || keyword == "NORMALS") return read_fixed(f, 3, false);
  if (keyword == "TENSORS") return read_fixed(f, 9, false);
  if (keyword == "TENSORS6") return read_fixed(f, 6, false);
  if (keyword == "GLOBAL_IDS" || keyword == "PEDIGREE_IDS") return read_fixed(f, 1, false);
  if (keyword == "TEXTURE_COORDINATES") return read_fixed(f, 2, true);
  if (keyword == "FIELD") return read_field(f);
  if (keyword == "COLOR_SCALARS") return skip_colors(f, false);
  if (keyword == "LOOKUP_TABLE") return skip_colors(f, true);
  if (keyword == "METADATA") {
    // Ends at an empty line, or with the file.
    if (!f.at.skip_past("\n\n")) f.at.move_to(f.at.offset() + f.at.left());
    return;
  }
  f.at.fail("unknown keyword " + quoted(keyword), rewrite_file);
}

void read_header(VtkFile& f) {
  Cursor& at = f.at;
  const std::string_view first = at.line("the header");
  constexpr std::string_view start = "# vtk DataFile Version ";
  double version = 0;
  if (first.size() > start.size()) {
    isochor::from_chars(first.data() + start.size(), first.data() + first.size(), version);
  }
  if (!(version >= 1.0 && version < 6.0)) {
    at.fail("the header reads " + quoted(first), "versions 1.0 to 5.1 of the legacy format are read");
  }
  at.line("the title");
  const std::string mode = upper(at.word("ASCII or BINARY"));
  if (mode != "ASCII" && mode != "BINARY")
    at.fail("ASCII or BINARY was expected, not " + quoted(mode), rewrite_file);
  at.word("DATASET");
  const std::string kind = upper(at.word("a dataset type"));
  if (kind != "UNSTRUCTURED_GRID") {
    at.fail("the dataset is " + quoted(kind),
            "only UNSTRUCTURED_GRID holds tetrahedra: export the volume mesh");
  }
  at.set_binary(mode == "BINARY");
  // The format is big-endian whatever machine wrote it.
  at.set_swapped(std::endian::native == std::endian::little);
}

}  // namespace

RawMesh read_vtk_legacy(std::string_view content, const std::string& file) {
  VtkFile f{Cursor(content, file), false, {}, {}, {}, {}, Target::none, 0};
  read_header(f);
  while (!f.at.peek_word().empty()) read_part(f, upper(f.at.word("a keyword")));
  f.at.forget_place();
  f.at.set_section("CELL_TYPES");
  if (f.cells.types.size() != f.cells.count()) {
    f.at.fail(join(f.cells.types.size(), " types for ", f.cells.count(), " cells"), rewrite_file);
  }
  RawMesh raw;
  raw.file = file;
  f.at.set_section("POINTS");
  add_vtk_points(f.at, f.coordinates, raw);
  f.at.set_section("CELLS");
  add_vtk_cells(f.at, f.cells, f.cell_arrays, 0, raw);
  f.at.set_section("POINT_DATA");
  for (VtkArray& array : f.point_arrays) add_vtk_point_array(f.at, std::move(array), raw.nodes.size(), raw);
  return raw;
}

}  // namespace isochor::mesh_files
