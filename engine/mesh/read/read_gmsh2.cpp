// Nodes and elements of Gmsh format 2, ASCII and binary.
#include <algorithm>
#include <set>

#include "engine/mesh/read/gmsh_parts.h"

namespace isochor::mesh_files {

namespace {

// Elementary and physical number of each cell, to tell a cell in two groups from a true duplicate.
struct CellOrigin {
  std::vector<std::int64_t> entity;
};

// The physical number as a list of groups; 0 means none, and a sign only says how the group is oriented.
std::vector<std::int64_t> groups_of(std::int64_t physical) {
  if (physical == 0) return {};
  return {physical < 0 ? -physical : physical};
}

void add(GmshFile& f, CellOrigin& origin, const GmshType& type, std::int64_t label,
         std::span<const std::int64_t> tags, std::span<const Index> nodes) {
  const std::size_t cells = f.raw.cell_label.size();
  const std::vector<std::int64_t> groups = groups_of(tags.empty() ? 0 : tags[0]);
  f.add_element(type, label, groups, tags.size() > 1 ? tags[1] : 0, nodes);
  if (f.raw.cell_label.size() > cells) origin.entity.push_back(tags.size() > 1 ? tags[1] : 0);
}

void read_element_line(GmshFile& f, CellOrigin& origin) {
  Cursor& at = f.at;
  const std::int64_t label = at.integer("an element number");
  const std::int64_t number = at.integer("an element type");
  const GmshType type = gmsh_type(number);
  if (type.nodes == 0)
    at.fail(join("element ", label, " has the unknown type ", number), "save with order 1 or 2");
  const std::int64_t tag_count = at.integer("the number of tags");
  if (tag_count < 0 || tag_count > 1000)
    at.fail(join("element ", label, " has ", tag_count, " tags"), rewrite_file);
  std::array<std::int64_t, 2> tags{};
  for (std::int64_t i = 0; i < tag_count; ++i) {
    const std::int64_t tag = at.integer("a tag");
    if (i < 2) tags[static_cast<std::size_t>(i)] = tag;
  }
  std::array<Index, 125> nodes{};
  for (int k = 0; k < type.nodes; ++k)
    nodes[static_cast<std::size_t>(k)] = f.node(at.integer("a node number"));
  add(f, origin, type, label, tags, {nodes.data(), static_cast<std::size_t>(type.nodes)});
}

// A run of elements of one type and tag count; returns how many.
std::size_t read_element_run(GmshFile& f, CellOrigin& origin, std::size_t left) {
  Cursor& at = f.at;
  const auto number = at.raw<std::int32_t>("an element type");
  const auto count = at.raw<std::int32_t>("a number of elements");
  const auto tag_count = at.raw<std::int32_t>("the number of tags");
  const GmshType type = gmsh_type(number);
  if (type.nodes == 0) at.fail(join("the element type ", number, " is unknown"), "save with order 1 or 2");
  if (tag_count < 0 || tag_count > 1000) at.fail(join(tag_count, " tags an element"), rewrite_file);
  const std::size_t in_run = at.checked_count(count, 8, "the number of elements in a run");
  if (in_run == 0 || in_run > left) {
    at.fail(join("a run of ", in_run, " elements where ", left, " are left"), rewrite_file);
  }
  for (std::size_t e = 0; e < in_run; ++e) {
    const auto label = at.raw<std::int32_t>("an element number");
    std::array<std::int64_t, 2> tags{};
    for (std::int32_t i = 0; i < tag_count; ++i) {
      const auto tag = at.raw<std::int32_t>("a tag");
      if (i < 2) tags[static_cast<std::size_t>(i)] = tag;
    }
    std::array<Index, 125> nodes{};
    for (int k = 0; k < type.nodes; ++k) {
      nodes[static_cast<std::size_t>(k)] = f.node(at.raw<std::int32_t>("a node number"));
    }
    add(f, origin, type, label, tags, {nodes.data(), static_cast<std::size_t>(type.nodes)});
  }
  return in_run;
}

// Format 2 writes a cell that is in two physical groups twice. The same cell of the same entity under another
// group is such a copy; anything else is a duplicate for check_mesh to report.
void merge_copies(RawMesh& raw, const CellOrigin& origin) {
  const std::size_t count = raw.cell_label.size();
  const auto width = static_cast<std::size_t>(raw.cell_width);
  if (std::set<std::int64_t>(raw.cell_tag.begin(), raw.cell_tag.end()).size() < 2) return;
  std::vector<std::pair<std::array<Index, 4>, std::size_t>> key(count);
  for (std::size_t c = 0; c < count; ++c) {
    std::copy_n(&raw.cells[c * width], 4, key[c].first.begin());
    key[c].second = c;
  }
  std::sort(key.begin(), key.end());
  std::vector<bool> copy(count, false);
  for (std::size_t i = 1, first = 0; i < count; ++i) {
    if (key[i].first != key[first].first) first = i;
    const std::size_t a = key[first].second, b = key[i].second;
    copy[b] = a != b && origin.entity[a] == origin.entity[b] && raw.cell_tag[a] != raw.cell_tag[b];
  }
  std::size_t kept = 0;
  for (std::size_t c = 0; c < count; ++c) {
    if (copy[c]) {
      ++raw.shared_cells;
      if (raw.shared_examples.size() < 8) raw.shared_examples.push_back(raw.cell_label[c]);
      continue;
    }
    std::copy_n(raw.cells.begin() + static_cast<std::ptrdiff_t>(c * width), width,
                raw.cells.begin() + static_cast<std::ptrdiff_t>(kept * width));
    raw.cell_label[kept] = raw.cell_label[c];
    raw.cell_tag[kept++] = raw.cell_tag[c];
  }
  raw.cells.resize(kept * width);
  raw.cell_label.resize(kept);
  raw.cell_tag.resize(kept);
}

}  // namespace

void read_nodes2(GmshFile& f) {
  Cursor& at = f.at;
  const std::size_t least = at.binary() ? 28 : 8;
  const std::size_t count = at.checked_count(at.integer("the number of nodes"), least, "the number of nodes");
  if (at.binary()) at.line("the end of the line");
  f.raw.nodes.reserve(count);
  f.raw.node_label.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::int64_t label =
        at.binary() ? at.raw<std::int32_t>("a node number") : at.integer("a node number");
    Vec3 x;
    for (int k = 0; k < 3; ++k) x[k] = at.binary() ? at.raw_finite("a coordinate") : at.real("a coordinate");
    f.add_node(label, x);
  }
}

void read_elements2(GmshFile& f) {
  Cursor& at = f.at;
  const std::int64_t promised = at.integer("the number of elements");
  const std::size_t count = at.checked_count(promised, 8, "the number of elements");
  if (at.binary()) at.line("the end of the line");
  CellOrigin origin;
  for (std::size_t i = 0; i < count && !at.binary(); ++i) read_element_line(f, origin);
  for (std::size_t i = 0; i < count && at.binary();) i += read_element_run(f, origin, count - i);
  merge_copies(f.raw, origin);
}

}  // namespace isochor::mesh_files
