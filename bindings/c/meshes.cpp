// Meshes between C and the engine.
#include <cstring>
#include <limits>

#include "handles.h"
#include "isochor/generate.h"
#include "isochor/mesh_io.h"

namespace isochor::c {

namespace {

// What iso_mesh_read() and iso_mesh_box() hand out the view of.
struct OwnedMesh {
  MeshView view;
  Mesh mesh;
};

void show_list(const std::string& name, const std::vector<Index>& indices,
               std::vector<iso_named_indices>& list) {
  list.push_back({name.c_str(), indices.data(), indices.size()});
}

std::size_t at_most(std::size_t count, std::size_t each, const char* what) {
  if (count > static_cast<std::size_t>(std::numeric_limits<Index>::max()) / each)
    refuse(std::string(what) + " = " + std::to_string(count) + " is more than a mesh can have");
  return count;
}

std::vector<Index> cells_from(const iso_mesh& m, std::size_t nodes) {
  const std::size_t packed = nodes * sizeof(Index);
  if (at_most(m.cell_count, nodes, "mesh->cell_count") > 0) (void)given(m.cells, "mesh->cells");
  if (m.cell_stride != 0 && m.cell_stride < packed)
    refuse("mesh->cell_stride = " + std::to_string(m.cell_stride) + " bytes is less than the " +
           std::to_string(packed) + " of a cell; give 0 for cells without gaps");
  std::vector<Index> cells(m.cell_count * nodes);
  const char* from = reinterpret_cast<const char*>(m.cells);
  for (std::size_t c = 0; c < m.cell_count; ++c)
    std::memcpy(&cells[c * nodes], from + c * (m.cell_stride == 0 ? packed : m.cell_stride), packed);
  return cells;
}

std::vector<Index> indices_from(const iso_named_indices& list, const char* name) {
  if (at_most(list.count, 1, name) > 0) (void)given(list.indices, name);
  return {list.indices, list.indices + list.count};
}

void add_lists(const iso_mesh& m, Mesh& mesh) {
  if (m.surface_count > 0) (void)given(m.surfaces, "mesh->surfaces");
  for (std::size_t s = 0; s < m.surface_count; ++s)
    mesh.surfaces.push_back({text(m.surfaces[s].name, "a name of mesh->surfaces"),
                             indices_from(m.surfaces[s], "the indices of one of mesh->surfaces")});
  if (m.node_set_count > 0) (void)given(m.node_sets, "mesh->node_sets");
  for (std::size_t s = 0; s < m.node_set_count; ++s)
    mesh.node_sets.push_back({text(m.node_sets[s].name, "a name of mesh->node_sets"),
                              indices_from(m.node_sets[s], "the indices of one of mesh->node_sets")});
  if (m.field_count > 0) (void)given(m.fields, "mesh->fields");
  for (std::size_t f = 0; f < m.field_count; ++f) {
    const iso_field& field = m.fields[f];
    if (field.components < 1 || field.components > 64)
      refuse("mesh->fields[" + std::to_string(f) + "].components = " + std::to_string(field.components) +
             "; it must lie between 1 and 64");
    const double* values = &given(field.values, "the values of one of mesh->fields");
    mesh.fields.push_back({text(field.name, "a name of mesh->fields"),
                           field.components,
                           {values, values + m.point_count * static_cast<std::size_t>(field.components)}});
  }
}

iso_mesh* hand_out(Mesh mesh) {
  auto owned = std::make_unique<OwnedMesh>();
  owned->mesh = std::move(mesh);
  owned->view.show(owned->mesh);
  owned->view.mesh.owner = owned.get();
  return &owned.release()->view.mesh;
}

}  // namespace

void MeshView::show(const Mesh& from) {
  regions.clear();
  surfaces.clear();
  node_sets.clear();
  fields.clear();
  for (const std::string& region : from.regions) regions.push_back(region.c_str());
  for (const MeshSurface& s : from.surfaces) show_list(s.name, s.faces, surfaces);
  for (const MeshNodeSet& s : from.node_sets) show_list(s.name, s.nodes, node_sets);
  for (const MeshField& f : from.fields) fields.push_back({f.name.c_str(), f.components, f.values.data()});
  mesh = {};
  mesh.size = sizeof mesh;
  mesh.cell_type = static_cast<std::int32_t>(from.cell_type);
  mesh.points = from.nodes.empty() ? nullptr : &from.nodes.front().x;
  mesh.point_count = from.nodes.size();
  mesh.cells = from.cells.data();
  mesh.cell_count = static_cast<std::size_t>(from.cell_count());
  mesh.cell_region = from.cell_region.empty() ? nullptr : from.cell_region.data();
  mesh.regions = regions.data();
  mesh.region_count = regions.size();
  mesh.surfaces = surfaces.data();
  mesh.surface_count = surfaces.size();
  mesh.node_sets = node_sets.data();
  mesh.node_set_count = node_sets.size();
  mesh.fields = fields.data();
  mesh.field_count = fields.size();
}

Mesh mesh_from(const iso_mesh* pointer) {
  const iso_mesh m = taken(pointer, "mesh");
  if (m.cell_type < ISO_TET4 || m.cell_type > ISO_TRI3)
    refuse("mesh->cell_type = " + std::to_string(m.cell_type) +
           "; it must be ISO_TET4, ISO_TET10, ISO_HEX8 or ISO_TRI3");
  Mesh mesh;
  mesh.cell_type = static_cast<CellType>(m.cell_type);
  mesh.nodes = vectors(m.points, m.point_count, m.point_stride, "mesh->points");
  mesh.cells = cells_from(m, static_cast<std::size_t>(nodes_per_cell(mesh.cell_type)));
  if (m.cell_region != nullptr) mesh.cell_region.assign(m.cell_region, m.cell_region + m.cell_count);
  mesh.regions = texts(m.regions, m.region_count, "mesh->regions");
  if (mesh.regions.empty()) mesh.regions = {"body"};
  add_lists(m, mesh);
  // What messages say of a mesh that was read.
  if (m.owner != nullptr) {
    const Mesh& read = static_cast<const OwnedMesh*>(m.owner)->mesh;
    mesh.source = read.source;
    mesh.notes = read.notes;
    if (read.nodes.size() == mesh.nodes.size()) mesh.node_label = read.node_label;
    if (read.cells.size() == mesh.cells.size()) mesh.cell_label = read.cell_label;
  }
  return mesh;
}

}  // namespace isochor::c

using namespace isochor;
using namespace isochor::c;

extern "C" iso_status iso_mesh_read(const char* path, double scale, iso_mesh** out, char* message,
                                    size_t message_size) {
  Buffer said(message, message_size);
  return caught("iso_mesh_read", said, [&] {
    (void)given(out, "out");
    if (!(scale > 0)) refuse("scale = " + std::to_string(scale) + "; it must be positive, 1 for meters");
    *out = hand_out(need(read_mesh(text(path, "path"), {scale})));
  });
}

extern "C" iso_status iso_mesh_box(const double lower[3], const double upper[3], const int32_t divisions[3],
                                   int32_t cell_type, iso_mesh** out, char* message, size_t message_size) {
  Buffer said(message, message_size);
  return caught("iso_mesh_box", said, [&] {
    (void)given(out, "out");
    if (cell_type != ISO_TET4 && cell_type != ISO_HEX8 && cell_type != ISO_TRI3)
      refuse("cell_type = " + std::to_string(cell_type) + "; it must be ISO_TET4, ISO_HEX8 or ISO_TRI3");
    (void)given(divisions, "divisions");
    BoxMeshDef box;
    box.lower = vector(lower, "lower");
    box.upper = vector(upper, "upper");
    box.divisions = {divisions[0], divisions[1], divisions[2]};
    box.cell_type = static_cast<CellType>(cell_type);
    *out = hand_out(need(box_mesh(box)));
  });
}

extern "C" void iso_mesh_free(iso_mesh* mesh) {
  if (mesh != nullptr) delete static_cast<OwnedMesh*>(mesh->owner);
}
