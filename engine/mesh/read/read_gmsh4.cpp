// Entities, nodes and elements of Gmsh format 4.1, ASCII and binary.
#include <algorithm>

#include "engine/mesh/read/gmsh_parts.h"

namespace isochor::mesh_files {

namespace {

std::int64_t read_int(GmshFile& f, const char* what) {
  return f.at.binary() ? f.at.raw<std::int32_t>(what) : f.at.integer(what);
}

// Counts and numbers of nodes and elements are "size_t" in binary files, 4 or 8 bytes wide.
std::int64_t read_size(GmshFile& f, const char* what) {
  if (!f.at.binary()) return f.at.integer(what);
  return f.size_bytes == 8 ? f.at.raw<std::int64_t>(what) : f.at.raw<std::uint32_t>(what);
}

double read_any(GmshFile& f, const char* what) {
  return f.at.binary() ? f.at.raw<double>(what) : f.at.any_real(what);
}

std::size_t read_count(GmshFile& f, std::size_t least_text_bytes, std::size_t least_raw_bytes,
                       const char* what) {
  const std::int64_t count = read_size(f, what);
  return f.at.checked_count(count, f.at.binary() ? least_raw_bytes : least_text_bytes, what);
}

int read_dimension(GmshFile& f) {
  const std::int64_t dim = read_int(f, "a dimension");
  if (dim < 0 || dim > 3) f.at.fail(join("the dimension is ", dim, ", not 0 to 3"), rewrite_file);
  return static_cast<int>(dim);
}

void read_entity(GmshFile& f, int dim, bool partitioned) {
  const std::int64_t tag = read_int(f, "an entity number");
  if (partitioned) {
    read_int(f, "a parent dimension");
    read_int(f, "a parent number");
    const std::size_t parts = read_count(f, 2, 4, "the number of partitions");
    for (std::size_t i = 0; i < parts; ++i) read_int(f, "a partition");
  }
  for (int i = 0; i < (dim == 0 ? 3 : 6); ++i) read_any(f, "a bound of an entity");
  const std::size_t count = read_count(f, 2, 4, "the number of physical groups");
  std::vector<std::int64_t> groups;
  for (std::size_t i = 0; i < count; ++i) {
    const std::int64_t group = read_int(f, "a physical number");
    // The sign only says how the group is oriented.
    groups.push_back(group < 0 ? -group : group);
  }
  if (!groups.empty()) f.entity_groups[{dim, tag}] = std::move(groups);
  const std::size_t bounds = dim == 0 ? 0 : read_count(f, 2, 4, "the number of bounding entities");
  for (std::size_t i = 0; i < bounds; ++i) read_int(f, "a bounding entity");
}

}  // namespace

void read_entities4(GmshFile& f, bool partitioned) {
  if (partitioned) {
    read_size(f, "the number of partitions");
    const std::size_t ghosts = read_count(f, 4, 8, "the number of ghost entities");
    for (std::size_t i = 0; i < 2 * ghosts; ++i) read_int(f, "a ghost entity");
  }
  std::array<std::size_t, 4> counts{};
  for (std::size_t& n : counts) n = read_count(f, 4, 12, "the number of entities");
  for (int dim = 0; dim < 4; ++dim) {
    for (std::size_t i = 0; i < counts[static_cast<std::size_t>(dim)]; ++i) read_entity(f, dim, partitioned);
  }
}

void read_nodes4(GmshFile& f) {
  Cursor& at = f.at;
  const std::size_t blocks = read_count(f, 8, 12, "the number of blocks");
  const std::size_t count = read_count(f, 8, 28, "the number of nodes");
  read_size(f, "the lowest node number");
  read_size(f, "the highest node number");
  f.raw.nodes.reserve(count);
  f.raw.node_label.reserve(count);
  for (std::size_t b = 0; b < blocks; ++b) {
    const int dim = read_dimension(f);
    read_int(f, "an entity number");
    const bool parametric = read_int(f, "the parametric mark") != 0;
    const std::size_t in_block = read_count(f, 8, 28, "the number of nodes in a block");
    if (in_block > count - f.raw.nodes.size()) {
      at.fail(join("a block of ", in_block, " nodes where ", count - f.raw.nodes.size(), " are left"),
              rewrite_file);
    }
    for (std::size_t i = 0; i < in_block; ++i) f.raw.node_label.push_back(read_size(f, "a node number"));
    for (std::size_t i = 0; i < in_block; ++i) {
      Vec3 x;
      for (int k = 0; k < 3; ++k)
        x[k] = at.binary() ? at.raw_finite("a coordinate") : at.real("a coordinate");
      f.raw.nodes.push_back(x);
      for (int k = 0; parametric && k < dim; ++k) read_any(f, "a parameter of a node");
    }
  }
  if (f.raw.nodes.size() != count) {
    at.fail(join("the blocks hold ", f.raw.nodes.size(), " nodes but ", count, " were announced"),
            rewrite_file);
  }
}

void read_elements4(GmshFile& f) {
  Cursor& at = f.at;
  const std::size_t blocks = read_count(f, 8, 12, "the number of blocks");
  const std::size_t count = read_count(f, 4, 8, "the number of elements");
  read_size(f, "the lowest element number");
  read_size(f, "the highest element number");
  std::size_t seen = 0;
  for (std::size_t b = 0; b < blocks; ++b) {
    const int dim = read_dimension(f);
    const std::int64_t entity = read_int(f, "an entity number");
    const std::int64_t number = read_int(f, "an element type");
    const GmshType type = gmsh_type(number);
    if (type.nodes == 0) at.fail(join("the element type ", number, " is unknown"), "save with order 1 or 2");
    const std::size_t in_block = read_count(f, 4, 8, "the number of elements in a block");
    const auto found = f.entity_groups.find({dim, entity});
    const std::span<const std::int64_t> groups =
        found != f.entity_groups.end() ? found->second : std::span<const std::int64_t>{};
    std::array<Index, 125> nodes{};
    for (std::size_t e = 0; e < in_block; ++e) {
      const std::int64_t label = read_size(f, "an element number");
      for (int k = 0; k < type.nodes; ++k) {
        nodes[static_cast<std::size_t>(k)] = f.node(read_size(f, "a node number"));
      }
      f.add_element(type, label, groups, entity, {nodes.data(), static_cast<std::size_t>(type.nodes)});
    }
    seen += in_block;
  }
  if (seen != count) {
    at.fail(join("the blocks hold ", seen, " elements but ", count, " were announced"), rewrite_file);
  }
}

}  // namespace isochor::mesh_files
