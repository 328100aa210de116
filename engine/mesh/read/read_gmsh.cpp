// Gmsh files: header, names, node data and the order of sections; nodes and elements are in read_gmsh2/4.cpp.
#include <algorithm>
#include <cstdlib>
#include <set>

#include "engine/mesh/read/gmsh_parts.h"
#include "engine/mesh/read/readers.h"

namespace isochor::mesh_files {

GmshType gmsh_type(std::int64_t number) {
  static constexpr std::array<GmshType, 32> types{{
      {0, 0, ""},
      {1, 2, "2-node lines"},
      {2, 3, "3-node triangles"},
      {2, 4, "4-node quadrangles"},
      {3, 4, "4-node tetrahedra"},
      {3, 8, "8-node hexahedra"},
      {3, 6, "6-node prisms"},
      {3, 5, "5-node pyramids"},
      {1, 3, "3-node lines"},
      {2, 6, "6-node triangles"},
      {2, 9, "9-node quadrangles"},
      {3, 10, "10-node tetrahedra"},
      {3, 27, "27-node hexahedra"},
      {3, 18, "18-node prisms"},
      {3, 14, "14-node pyramids"},
      {0, 1, "points"},
      {2, 8, "8-node quadrangles"},
      {3, 20, "20-node hexahedra"},
      {3, 15, "15-node prisms"},
      {3, 13, "13-node pyramids"},
      {2, 9, "9-node triangles"},
      {2, 10, "10-node triangles"},
      {2, 12, "12-node triangles"},
      {2, 15, "15-node triangles"},
      {2, 15, "15-node triangles"},
      {2, 21, "21-node triangles"},
      {1, 4, "4-node lines"},
      {1, 5, "5-node lines"},
      {1, 6, "6-node lines"},
      {3, 20, "20-node tetrahedra"},
      {3, 35, "35-node tetrahedra"},
      {3, 56, "56-node tetrahedra"},
  }};
  if (number == 92) return {3, 64, "64-node hexahedra"};
  if (number == 93) return {3, 125, "125-node hexahedra"};
  if (number < 1 || number >= static_cast<std::int64_t>(types.size())) return {};
  return types[static_cast<std::size_t>(number)];
}

Index GmshFile::node(std::int64_t label) const {
  const Index found = node_index.find(label);
  if (found < 0) at.fail(join("node ", label, " is used but not defined in $Nodes"), rewrite_file);
  return found;
}

namespace {

// Entities and physical groups are numbered apart; surfaces of entities come behind all groups.
constexpr std::int64_t kEntities = std::int64_t{1} << 48;

}  // namespace

void GmshFile::add_element(const GmshType& type, std::int64_t label, std::span<const std::int64_t> groups,
                           std::int64_t entity, std::span<const Index> nodes) {
  if (type.dim == 3 && (type.nodes == 10 || type.nodes == 4 || type.nodes == 8)) {
    raw.add_cell(at, label, groups.empty() ? no_tag : groups[0], nodes, gmsh_tet10);
    if (groups.size() > 1) {
      ++raw.shared_cells;
      if (raw.shared_examples.size() < 8) raw.shared_examples.push_back(label);
    }
  } else if (type.dim == 3) {
    ++raw.foreign_cells[type.name];
  } else if (type.dim == 2) {
    ++raw.flat_cells;
    const bool fits = type.nodes == 3 || type.nodes == 6 || type.nodes == 4;
    if (!fits) ++raw.foreign_faces;
    for (std::size_t g = 0; fits && g < groups.size(); ++g) raw.add_face(at, groups[g], nodes);
    const bool numbered = entity > 0 && entity < kEntities;
    if (fits && groups.empty() && numbered) raw.add_face(at, kEntities + entity, nodes);
  } else {
    ++raw.flat_cells;
    for (const std::int64_t g : groups) {
      std::vector<Index>& set = raw.node_sets[{type.dim, g}].nodes;
      set.insert(set.end(), nodes.begin(), nodes.end());
    }
  }
}

void GmshFile::name_entities() {
  std::set<std::string> taken;
  std::vector<std::int64_t> entities;
  for (const auto* list : {&raw.surfaces, &raw.quadrangles}) {
    for (const auto& [tag, surface] : *list) {
      if (tag >= kEntities)
        entities.push_back(tag);
      else
        taken.insert(std::to_string(tag));
    }
  }
  for (const auto& [tag, name] : raw.surface_name) taken.insert(name);
  for (const std::int64_t tag : entities) {
    const std::string number = std::to_string(tag - kEntities);
    raw.surface_name[tag] = taken.count(number) > 0 ? "entity " + number : number;
  }
}

void GmshFile::add_node(std::int64_t label, const Vec3& position) {
  raw.node_label.push_back(label);
  raw.nodes.push_back(position);
}

void GmshFile::finish_nodes() {
  const auto [unique, label] = node_index.build(raw.node_label);
  if (!unique) at.fail(join("node ", label, " is defined twice"), rewrite_file);
  has_nodes = true;
}

void GmshFile::require_nodes() const {
  if (!has_nodes) at.fail("the section comes before $Nodes", "put $Nodes first");
}

namespace {

// The version and, in binary files, the byte order.
int read_header(GmshFile& f) {
  Cursor& at = f.at;
  at.set_section("$MeshFormat");
  const double version = at.real("the format version");
  const std::int64_t binary = at.integer("the file type (0 for ASCII, 1 for binary)");
  const std::int64_t data_size = at.integer("the data size");
  const bool known = (version >= 2.0 && version < 3.0) || (version > 4.05 && version < 4.2);
  if (!known) {
    at.fail(join("Gmsh format ", version, " is not read, only 2.2 and 4.1"),
            "save with 'gmsh -format msh41' or 'Mesh.MshFileVersion = 4.1'");
  }
  if (binary != 0 && binary != 1)
    at.fail(join("the file type is ", binary, ", neither 0 nor 1"), rewrite_file);
  const int major = version < 3.0 ? 2 : 4;
  const bool fits = data_size == 8 || (major == 4 && data_size == 4);
  if (binary == 1 && !fits)
    at.fail(join("the data size is ", data_size, ", not 8"), "export with 64-bit data");
  f.size_bytes = static_cast<int>(data_size);
  at.line("the end of the line");
  if (binary == 1) {
    at.set_binary(true);
    const auto mark = at.raw<std::int32_t>("the byte order mark");
    if (mark == 0x01000000) {
      at.set_swapped(true);
    } else if (mark != 1) {
      at.fail(join("the byte order mark is ", mark, ", not 1 in either byte order"), rewrite_file);
    }
  }
  return major;
}

void read_physical_names(GmshFile& f) {
  Cursor& at = f.at;
  const std::size_t count = at.checked_count(at.integer("the number of names"), 6, "the number of names");
  for (std::size_t i = 0; i < count; ++i) {
    const std::int64_t dim = at.integer("a dimension");
    if (dim < 0 || dim > 3) at.fail(join("the dimension is ", dim, ", not 0 to 3"), rewrite_file);
    const std::int64_t tag = at.integer("a physical number");
    const std::string name(at.quoted_text("a physical name"));
    if (dim == 3) f.raw.region_name[tag] = name;
    if (dim == 2) f.raw.surface_name[tag] = name;
    if (dim < 2) f.raw.node_sets[{static_cast<int>(dim), tag}].name = name;
  }
}

// Values at nodes; nodes that the section leaves out get 0. A later time step replaces an earlier one.
void read_node_data(GmshFile& f) {
  Cursor& at = f.at;
  f.require_nodes();
  MeshField field;
  const std::size_t strings = at.checked_count(at.integer("the number of texts"), 2, "the number of texts");
  for (std::size_t i = 0; i < strings; ++i) {
    const std::string_view text = at.quoted_text("a text");
    if (i == 0) field.name = text;
  }
  const std::size_t reals = at.checked_count(at.integer("the number of reals"), 2, "the number of reals");
  for (std::size_t i = 0; i < reals; ++i) at.any_real("a real");
  const std::size_t integers =
      at.checked_count(at.integer("the number of integers"), 2, "the number of integers");
  if (integers < 3) at.fail(join(integers, " integers instead of at least 3"), rewrite_file);
  std::array<std::int64_t, 3> header{};
  for (std::size_t i = 0; i < integers; ++i) {
    const std::int64_t n = at.integer("an integer");
    if (i < 3) header[i] = n;
  }
  const std::size_t count = at.checked_count(header[2], at.binary() ? 12 : 4, "the number of values");
  if (header[1] < 1 || header[1] > 9) at.fail(join(header[1], " components, not 1 to 9"), rewrite_file);
  field.components = static_cast<int>(header[1]);
  const auto width = static_cast<std::size_t>(field.components);
  field.values.assign(width * f.raw.nodes.size(), 0.0);
  if (at.binary()) at.line("the end of the line");
  for (std::size_t i = 0; i < count; ++i) {
    const std::int64_t label =
        at.binary() ? at.raw<std::int32_t>("a node number") : at.integer("a node number");
    double* values = &field.values[width * static_cast<std::size_t>(f.node(label))];
    for (std::size_t k = 0; k < width; ++k) {
      values[k] = at.binary() ? at.raw<double>("a value") : at.any_real("a value");
    }
  }
  std::erase_if(f.raw.fields, [&](const MeshField& old) { return old.name == field.name; });
  f.raw.fields.push_back(std::move(field));
}

// False for a section that says nothing a Mesh holds ($Periodic, $GhostElements, comments, data on elements).
bool read_section(GmshFile& f, std::string_view name, int major) {
  if (name == "$PhysicalNames") {
    read_physical_names(f);
  } else if (name == "$NodeData") {
    read_node_data(f);
  } else if (name == "$Nodes") {
    if (f.has_nodes) f.at.fail("the section occurs twice", "keep one $Nodes section");
    major == 2 ? read_nodes2(f) : read_nodes4(f);
    f.finish_nodes();
  } else if (name == "$Elements") {
    f.require_nodes();
    major == 2 ? read_elements2(f) : read_elements4(f);
  } else if (major == 4 && (name == "$Entities" || name == "$PartitionedEntities")) {
    read_entities4(f, name == "$PartitionedEntities");
  } else {
    return false;
  }
  return true;
}

// Vectors in elements become a field of the volume cells; cells that the section leaves out get 0, which no
// fiber takes. Whatever makes no sense is left out, as other data on elements are.
void read_element_data(GmshFile& f) {
  Cursor at = f.at;
  try {
    MeshField field;
    const std::size_t texts = at.checked_count(at.integer("the number of texts"), 2, "the number of texts");
    for (std::size_t i = 0; i < texts; ++i) {
      const std::string_view text = at.quoted_text("a text");
      if (i == 0) field.name = text;
    }
    const std::size_t reals = at.checked_count(at.integer("the number of reals"), 2, "the number of reals");
    for (std::size_t i = 0; i < reals; ++i) at.any_real("a real");
    const std::int64_t integers = at.integer("the number of integers");
    std::array<std::int64_t, 3> header{};
    for (std::int64_t i = 0; i < integers; ++i) {
      const std::int64_t n = at.integer("an integer");
      if (i < 3) header[static_cast<std::size_t>(i)] = n;
    }
    if (header[1] != 3 || f.raw.cell_label.empty()) return;
    const std::size_t count = at.checked_count(header[2], 4, "the number of values");
    field.components = 3;
    field.values.assign(3 * f.raw.cell_label.size(), 0);
    std::map<std::int64_t, std::size_t> cell_of;
    for (std::size_t c = 0; c < f.raw.cell_label.size(); ++c) cell_of[f.raw.cell_label[c]] = c;
    if (at.binary()) at.line("the end of the line");
    for (std::size_t i = 0; i < count; ++i) {
      const std::int64_t label =
          at.binary() ? at.raw<std::int32_t>("an element number") : at.integer("an element number");
      const auto cell = cell_of.find(label);
      for (std::size_t k = 0; k < 3; ++k) {
        const double v = at.binary() ? at.raw<double>("a value") : at.any_real("a value");
        if (cell != cell_of.end()) field.values[3 * cell->second + k] = v;
      }
    }
    std::erase_if(f.raw.cell_fields, [&](const MeshField& old) { return old.name == field.name; });
    f.raw.cell_fields.push_back(std::move(field));
  } catch (const ReadFailure&) {
    return;
  }
}

// Moves behind $ElementData or $ElementNodeData of a binary file by its counts: a binary number may look like
// the end of the section, and some writers put that behind the last number without a line of its own. False,
// and nothing moved, where the counts make no sense.
bool skip_element_data(GmshFile& f, bool by_node) {
  Cursor at = f.at;
  try {
    const std::size_t texts = at.checked_count(at.integer("the number of texts"), 2, "the number of texts");
    for (std::size_t i = 0; i < texts; ++i) at.quoted_text("a text");
    const std::size_t reals = at.checked_count(at.integer("the number of reals"), 2, "the number of reals");
    for (std::size_t i = 0; i < reals; ++i) at.any_real("a real");
    const std::int64_t integers = at.integer("the number of integers");
    std::array<std::int64_t, 3> header{};
    for (std::int64_t i = 0; i < integers; ++i) {
      const std::int64_t n = at.integer("an integer");
      if (i < 3) header[static_cast<std::size_t>(i)] = n;
    }
    const std::size_t count = at.checked_count(header[2], 4, "the number of values");
    const std::size_t width = 8 * at.checked_count(header[1], 8, "the number of components");
    at.line("the end of the line");
    for (std::size_t i = 0; i < count; ++i) {
      at.raw<std::int32_t>("an element number");
      const std::int64_t nodes = by_node ? at.raw<std::int32_t>("a number of nodes") : 1;
      at.bytes(width * at.checked_count(nodes, 1, "a number of nodes"), "values");
    }
  } catch (const ReadFailure&) {
    return false;
  }
  if (!at.peek_word().starts_with("$End")) return false;
  f.at.move_to(at.offset());
  return true;
}

// Moves behind a section that says nothing a Mesh holds; `end` closes it.
void skip_section(GmshFile& f, const std::string& name, const std::string& end) {
  Cursor& at = f.at;
  if (name == "$ElementData") read_element_data(f);
  if (at.binary() && (name == "$ElementData" || name == "$ElementNodeData"))
    skip_element_data(f, name == "$ElementNodeData");
  const std::size_t start = at.offset();
  // On a line of its own; else, behind binary data, wherever it is.
  if (at.peek_word() == end) {
    at.word("the end of the section");
  } else if (!at.skip_past("\n" + end) && !(at.move_to(start), at.skip_past(end))) {
    at.fail(join("the section has no ", end), rewrite_file);
  }
}

// Skips lines that begin no section, as Gmsh does: its window appends commands to the file that is open. The
// next section, "" at the end of the file.
std::string next_section(GmshFile& f) {
  Cursor& at = f.at;
  for (;;) {
    at.skip_space();
    if (at.at_end()) return {};
    if (at.peek_word().starts_with("$")) {
      const std::string name(at.word("a section"));
      if (name.size() < 2) at.fail("a section has no name", rewrite_file);
      return name;
    }
    at.line("a line");
    ++f.raw.stray_lines;
  }
}

// Sections whose body is numbers in a text also in a binary file.
bool counts_in_text(std::string_view name, int major) {
  return name == "$PhysicalNames" || name == "$NodeData" ||
         (major == 2 && (name == "$Nodes" || name == "$Elements"));
}

}  // namespace

RawMesh read_gmsh(std::string_view content, const std::string& file) {
  GmshFile f{Cursor(content, file), {}, {}, 8, false, {}};
  f.raw.file = file;
  Cursor& at = f.at;
  // Comments may come before it.
  const std::string_view first = at.peek_word();
  std::string opening = next_section(f);
  while (!opening.empty() && opening != "$MeshFormat" && opening != "$NOD" &&
         at.rest().find("$MeshFormat") != std::string_view::npos) {
    skip_section(f, opening, "$End" + opening.substr(1));
    opening = next_section(f);
  }
  if (opening != "$MeshFormat") {
    at.move_to(0);
    at.word("$MeshFormat");
    at.fail(join("the file begins with ", quoted(first), " instead of $MeshFormat"),
            "Gmsh format 1 is not read: save with 'gmsh -format msh41'");
  }
  const int major = read_header(f);
  bool has_elements = false, known = true;
  std::string name = "$MeshFormat";
  for (;;) {
    const std::string end = "$End" + name.substr(1);
    if (known && at.peek_word() != end)
      at.fail(join(end, " was expected, not ", quoted(at.peek_word())), "correct the counts of the section");
    skip_section(f, name, end);
    name = next_section(f);
    if (name.empty()) break;
    at.set_section(name);
    if (!counts_in_text(name, major) || at.binary()) at.line("the section");
    known = read_section(f, name, major);
    has_elements = has_elements || name == "$Elements";
  }
  at.set_section("");
  at.forget_place();
  if (!f.has_nodes || !has_elements) {
    at.fail(join("the file has no section ", f.has_nodes ? "$Elements" : "$Nodes"), rewrite_file);
  }
  f.name_entities();
  return std::move(f.raw);
}

}  // namespace isochor::mesh_files
