// What the Gmsh readers of format 2 and of format 4 share.
#pragma once

#include <array>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/mesh/read/cursor.h"
#include "engine/mesh/read/raw_mesh.h"

namespace isochor::mesh_files {

// One element type of Gmsh; nodes == 0 for a number that Gmsh does not define.
struct GmshType {
  int dim = 0, nodes = 0;
  const char* name = "";
};
GmshType gmsh_type(std::int64_t number);

struct GmshFile {
  Cursor at;
  RawMesh raw;
  LabelMap node_index;
  int size_bytes = 8;  // of a count in a binary file of format 4
  bool has_nodes = false;

  // Physical groups of the entities (dimension, tag) of format 4.
  std::map<std::pair<int, std::int64_t>, std::vector<std::int64_t>> entity_groups;

  Index node(std::int64_t label) const;
  // Files one element under its physical groups, a face without one under its entity; nodes are indices.
  void add_element(const GmshType& type, std::int64_t label, std::span<const std::int64_t> groups,
                   std::int64_t entity, std::span<const Index> nodes);
  // Names the surfaces of entities by their numbers, once all is read.
  void name_entities();
  void add_node(std::int64_t label, const Vec3& position);
  void finish_nodes();
  void require_nodes() const;
};

// Bodies of $Nodes and $Elements in format 2, of $Entities, $PartitionedEntities, $Nodes and $Elements in
// format 4.
void read_nodes2(GmshFile& f);
void read_elements2(GmshFile& f);
void read_entities4(GmshFile& f, bool partitioned);
void read_nodes4(GmshFile& f);
void read_elements4(GmshFile& f);

}  // namespace isochor::mesh_files
