#include "engine/mesh/read/vtk_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace isochor::mesh_files {

namespace {

enum class Role { tetrahedron, hexahedron, triangle, quadrangle, foreign_face, flat, foreign_cell };

struct VtkType {
  int number;
  Role role;
  const char* name;
};

constexpr std::array vtk_types{
    VtkType{1, Role::flat, "vertices"},
    VtkType{2, Role::flat, "vertices"},
    VtkType{3, Role::flat, "lines"},
    VtkType{4, Role::flat, "lines"},
    VtkType{5, Role::triangle, "triangles"},
    VtkType{6, Role::foreign_face, "triangle strips"},
    VtkType{7, Role::foreign_face, "polygons"},
    VtkType{8, Role::quadrangle, "pixels"},
    VtkType{9, Role::quadrangle, "quadrangles"},
    VtkType{10, Role::tetrahedron, "tetrahedra"},
    VtkType{11, Role::hexahedron, "voxels"},
    VtkType{12, Role::hexahedron, "hexahedra"},
    VtkType{13, Role::foreign_cell, "wedges"},
    VtkType{14, Role::foreign_cell, "pyramids"},
    VtkType{21, Role::flat, "lines"},
    VtkType{22, Role::triangle, "6-node triangles"},
    VtkType{23, Role::foreign_face, "8-node quadrangles"},
    VtkType{24, Role::tetrahedron, "10-node tetrahedra"},
    VtkType{25, Role::foreign_cell, "20-node hexahedra"},
    VtkType{26, Role::foreign_cell, "15-node wedges"},
    VtkType{27, Role::foreign_cell, "13-node pyramids"},
    VtkType{28, Role::foreign_face, "9-node quadrangles"},
    VtkType{29, Role::foreign_cell, "27-node hexahedra"},
    VtkType{42, Role::foreign_cell, "polyhedra"},
    VtkType{68, Role::flat, "Lagrange curves"},
    VtkType{69, Role::triangle, "Lagrange triangles"},
    VtkType{70, Role::foreign_face, "Lagrange quadrangles"},
    VtkType{71, Role::tetrahedron, "Lagrange tetrahedra of another order"},
};

VtkType type_of(std::int64_t number) {
  const auto found =
      std::find_if(vtk_types.begin(), vtk_types.end(), [&](const VtkType& t) { return t.number == number; });
  return found != vtk_types.end() ? *found : VtkType{-1, Role::foreign_cell, ""};
}

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = (c >= 'A' && c <= 'Z') ? static_cast<char>(c - 'A' + 'a') : c;
  return result;
}

// Values are compared with floor, since writers (ours too) may keep whole numbers as doubles.
bool all_whole(const std::vector<double>& values) {
  constexpr double largest = 9007199254740992.0;
  return std::all_of(values.begin(), values.end(),
                     [&](double v) { return v == std::floor(v) && std::abs(v) <= largest; });
}

const VtkArray* region_array(const std::vector<VtkArray>& arrays, std::size_t cells) {
  // In order of preference: a group that the author chose goes before numbers that a mesher counted.
  static constexpr std::array<std::string_view, 14> names{
      "region",    "regions",   "gmsh:physical", "medit:ref", "materialids",      "materialid", "material",
      "cell_tags", "attribute", "cellentityids", "groupids",  "gmsh:geometrical", "partid",     "part"};
  for (const std::string_view name : names) {
    for (const VtkArray& array : arrays) {
      if (lower(array.name) == name && array.components == 1 && array.values.size() == cells &&
          all_whole(array.values)) {
        return &array;
      }
    }
  }
  return nullptr;
}

// Hexahedra and quadrangles. Voxels and pixels count their corners by rows, not around.
void add_block(const Cursor& at, std::int64_t label, const VtkType& type, std::int64_t tag,
               std::span<const Index> nodes, RawMesh& raw) {
  const bool cell = type.role == Role::hexahedron;
  const std::size_t expected = cell ? 8 : 4;
  if (nodes.size() != expected) {
    at.fail(join("cell ", label, " of type ", type.number, " has ", nodes.size(), " points instead of ",
                 expected),
            rewrite_file);
  }
  std::array<Index, 8> corners{};
  std::copy(nodes.begin(), nodes.end(), corners.begin());
  if (type.number == 11 || type.number == 8) {
    std::swap(corners[2], corners[3]);
    std::swap(corners[6], corners[7]);
  }
  if (cell) {
    raw.add_cell(at, label, tag, corners, vtk_tet10);
  } else {
    ++raw.flat_cells;
    if (tag != no_tag) raw.add_face(at, tag, std::span<const Index>(corners).first(4));
  }
}

void add_cell(const Cursor& at, std::int64_t label, std::int64_t type_number, std::int64_t tag,
              std::span<const Index> nodes, RawMesh& raw) {
  const VtkType type = type_of(type_number);
  const std::size_t width = nodes.size();
  if (type.role == Role::hexahedron || type.role == Role::quadrangle)
    return add_block(at, label, type, tag, nodes, raw);
  const bool linear = type_number == 10 || type_number == 5,
             quadratic = type_number == 24 || type_number == 22;
  const std::size_t low = type.role == Role::tetrahedron ? 4 : 3,
                    high = type.role == Role::tetrahedron ? 10 : 6;
  const bool simplex = type.role == Role::tetrahedron || type.role == Role::triangle;
  if (simplex && ((linear && width != low) || (quadratic && width != high))) {
    at.fail(join("cell ", label, " of type ", type_number, " has ", width, " points instead of ",
                 linear ? low : high),
            rewrite_file);
  }
  const bool fits = width == low || width == high;
  if (type.role == Role::tetrahedron && fits) {
    raw.add_cell(at, label, tag, nodes, vtk_tet10);
  } else if (type.role == Role::triangle && fits) {
    ++raw.flat_cells;
    if (tag != no_tag)
      raw.add_face(at, tag, nodes);
    else
      raw.loose_triangles.insert(raw.loose_triangles.end(), nodes.begin(), nodes.begin() + 3);
  } else if (type.role == Role::tetrahedron || type.role == Role::foreign_cell) {
    ++raw.foreign_cells[type.number < 0 ? join("cells of VTK type ", type_number) : std::string(type.name)];
  } else {
    ++raw.flat_cells;
    if (type.role != Role::flat) ++raw.foreign_faces;
  }
}

}  // namespace

void add_vtk_cells(const Cursor& at, const VtkCells& cells, const std::vector<VtkArray>& cell_arrays,
                   Index first_node, RawMesh& raw) {
  const VtkArray* region = region_array(cell_arrays, cells.count());
  const auto first_label = static_cast<std::int64_t>(raw.cell_label.size());
  const std::int64_t points = static_cast<std::int64_t>(raw.nodes.size()) - first_node;
  // Arrays of vectors become fields of the volume cells.
  std::vector<std::pair<const VtkArray*, MeshField*>> vectors;
  const std::size_t before = raw.cells.size();
  for (const VtkArray& array : cell_arrays) {
    if (array.components != 3 || array.values.size() != 3 * cells.count()) continue;
    const auto same = std::find_if(raw.cell_fields.begin(), raw.cell_fields.end(),
                                   [&](const MeshField& old) { return old.name == array.name; });
    if (same == raw.cell_fields.end() && before == 0) raw.cell_fields.push_back({array.name, 3, {}});
  }
  for (const VtkArray& array : cell_arrays) {
    if (array.components != 3 || array.values.size() != 3 * cells.count()) continue;
    for (MeshField& field : raw.cell_fields) {
      if (field.name == array.name) vectors.emplace_back(&array, &field);
    }
  }
  std::vector<Index> nodes;
  for (std::size_t c = 0; c < cells.count(); ++c) {
    const std::int64_t label = first_label + static_cast<std::int64_t>(c);
    const std::int64_t begin = cells.offsets[c], end = cells.offsets[c + 1];
    if (begin > end || end > static_cast<std::int64_t>(cells.connectivity.size())) {
      at.fail(
          join("cell ", label, " ends at entry ", end, " of a connectivity of ", cells.connectivity.size()),
          rewrite_file);
    }
    nodes.clear();
    for (std::int64_t i = begin; i < end; ++i) {
      const std::int64_t n = cells.connectivity[static_cast<std::size_t>(i)];
      if (n < 0 || n >= points) {
        at.fail(join("cell ", label, " uses point ", n, " but points are numbered 0 to ", points - 1),
                rewrite_file);
      }
      nodes.push_back(first_node + static_cast<Index>(n));
    }
    const std::int64_t tag = region ? static_cast<std::int64_t>(region->values[c]) : no_tag;
    const std::size_t filled = raw.cells.size();
    add_cell(at, label, cells.types[c], tag, nodes, raw);
    if (raw.cells.size() == filled) continue;
    for (const auto& [array, field] : vectors) {
      const auto from = array->values.begin() + static_cast<std::ptrdiff_t>(3 * c);
      field->values.insert(field->values.end(), from, from + 3);
    }
  }
}

void add_vtk_point_array(const Cursor& at, VtkArray array, std::size_t points, RawMesh& raw) {
  if (array.values.size() != points * static_cast<std::size_t>(array.components)) {
    at.fail(join("point array '", array.name, "' has ", array.values.size(), " values instead of ",
                 array.components, " a point for ", points, " points"),
            rewrite_file);
  }
  raw.fields.push_back({std::move(array.name), array.components, std::move(array.values)});
}

void add_vtk_points(const Cursor& at, const std::vector<double>& coordinates, RawMesh& raw) {
  raw.nodes.reserve(raw.nodes.size() + coordinates.size() / 3);
  for (std::size_t i = 0; i + 2 < coordinates.size(); i += 3) {
    const Vec3 x{coordinates[i], coordinates[i + 1], coordinates[i + 2]};
    const auto label = static_cast<std::int64_t>(raw.nodes.size());
    for (int k = 0; k < 3; ++k) {
      if (!std::isfinite(x[k])) {
        at.fail(join("point ", label, " has the coordinate ", x[k]),
                "coordinates must be finite: repair the file");
      }
    }
    raw.node_label.push_back(label);
    raw.nodes.push_back(x);
  }
}

}  // namespace isochor::mesh_files
