// From what a file says to a Mesh: the steps that are the same for every format.
#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "engine/mesh/cell_shape.h"
#include "engine/mesh/read/raw_mesh.h"
#include "engine/mesh/tet_shape.h"

namespace isochor::mesh_files {

namespace {

constexpr std::size_t most_examples = 8;

std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

[[noreturn]] void fail(const RawMesh& raw, const std::string& problem, const std::string& remedy) {
  throw ReadFailure{join(raw.file, ": ", problem, "; ", remedy)};
}

std::string list(std::span<const std::int64_t> numbers, std::int64_t count) {
  std::string text;
  for (const std::int64_t n : numbers) text += (text.empty() ? "" : ", ") + std::to_string(n);
  return count > static_cast<std::int64_t>(numbers.size()) ? text + ", ..." : text;
}

void require_cells(const RawMesh& raw) {
  if (!raw.foreign_cells.empty()) {
    std::string types;
    for (const auto& [name, count] : raw.foreign_cells) {
      types += (types.empty() ? "" : ", ") + join(count, " ", name);
    }
    fail(raw,
         "the file has volume cells that are neither 4- or 10-node tetrahedra nor 8-node hexahedra: " + types,
         "mesh the body with one of these");
  }
  if (raw.cells.empty()) {
    fail(raw,
         raw.flat_cells > 0 ? join("the file has no tetrahedra or hexahedra, only ", raw.flat_cells,
                                   " faces, edges or points")
                            : std::string("the file has no tetrahedra or hexahedra"),
         "create the 3D mesh and export it with its volume (in Gmsh: a physical volume, or 'save all')");
  }
}

// Which edge each mid-edge slot lies on, by the file's own coordinates: the sum over all cells of the
// relative distance to each edge's middle decides. Curved edges bend far less than the edges are apart.
std::array<int, 6> measured_edges(const RawMesh& raw) {
  std::array<std::array<double, 6>, 6> distance{};
  const std::size_t cells = raw.cells.size() / 10;
  const std::size_t stride = std::max<std::size_t>(1, cells / 2000);
  for (std::size_t c = 0; c < cells; c += stride) {
    const Index* n = &raw.cells[10 * c];
    double size = 0;
    for (const auto& e : tet_edges) {
      size = std::max(size, length(raw.nodes[at(n[e[0]])] - raw.nodes[at(n[e[1]])]));
    }
    if (!(size > 0)) continue;
    for (std::size_t k = 0; k < 6; ++k) {
      for (std::size_t e = 0; e < 6; ++e) {
        const Vec3 middle = 0.5 * (raw.nodes[at(n[tet_edges[e][0]])] + raw.nodes[at(n[tet_edges[e][1]])]);
        distance[k][e] += length(raw.nodes[at(n[4 + k])] - middle) / size;
      }
    }
  }
  std::array<int, 6> edge{};
  for (std::size_t k = 0; k < 6; ++k) {
    const auto best = std::min_element(distance[k].begin(), distance[k].end());
    // Without a clear winner (tangled or degenerate cells) the format's own order stands.
    edge[k] =
        *best < 0.5 * distance[k][k] ? static_cast<int>(best - distance[k].begin()) : static_cast<int>(k);
  }
  return edge;
}

// Exporters disagree on the order of mid-edge nodes even within one format, and a wrong order gives cells
// that look right and behave badly. The coordinates know.
void order_mid_edges(RawMesh& raw, Mesh& mesh) {
  if (raw.cell_width != 10) return;
  const std::array<int, 6> edge = measured_edges(raw);
  std::array<bool, 6> taken{};
  bool as_declared = true;
  for (std::size_t k = 0; k < 6; ++k) {
    as_declared = as_declared && edge[k] == static_cast<int>(k);
    taken[at(edge[k])] = true;
  }
  if (as_declared || std::find(taken.begin(), taken.end(), false) != taken.end()) return;
  for (std::size_t c = 0; c < raw.cells.size(); c += 10) {
    std::array<Index, 6> old{};
    std::copy_n(&raw.cells[c + 4], 6, old.begin());
    for (std::size_t k = 0; k < 6; ++k) raw.cells[c + 4 + at(edge[k])] = old[k];
  }
  mesh.notes.push_back({"mid-edges-reordered",
                        "the mid-edge nodes were not in the order of the file's format; they were put on the "
                        "edges that their coordinates lie on",
                        static_cast<std::int64_t>(raw.cells.size() / 10),
                        {}});
}

bool is_inverted(const RawMesh& raw, const Index* n) {
  if (raw.cell_width != 8)
    return volume6(raw.nodes[at(n[0])], raw.nodes[at(n[1])], raw.nodes[at(n[2])], raw.nodes[at(n[3])]) < 0;
  // The Jacobian in the middle: positive and negative corners may both occur in a bad hexahedron.
  Vec3 d[3] = {};
  for (std::size_t a = 0; a < 8; ++a) {
    for (std::size_t k = 0; k < 3; ++k) d[k] += static_cast<double>(kHexSign[a][k]) * raw.nodes[at(n[a])];
  }
  return dot(d[0], cross(d[1], d[2])) < 0;
}

void turn_inverted(RawMesh& raw, Mesh& mesh) {
  if (raw.cell_width == 3) return;
  const auto width = static_cast<std::size_t>(raw.cell_width);
  std::int64_t count = 0;
  std::vector<std::int64_t> examples;
  for (std::size_t c = 0; c * width < raw.cells.size(); ++c) {
    Index* n = &raw.cells[c * width];
    if (!is_inverted(raw, n)) continue;
    std::array<Index, 10> old{};
    std::copy_n(n, width, old.begin());
    // A hexahedron is turned over by exchanging its bottom and its top.
    for (std::size_t k = 0; k < width; ++k) n[k] = old[width == 8 ? (k + 4) % 8 : at(turned_over[k])];
    if (++count <= static_cast<std::int64_t>(most_examples)) examples.push_back(raw.cell_label[c]);
  }
  if (count == 0) return;
  mesh.notes.push_back(
      {"turned-cell",
       join(count, " cells had inverted corner order and were turned over: ", list(examples, count)), count,
       std::move(examples)});
}

std::string name_of(const std::map<std::int64_t, std::string>& names, std::int64_t tag) {
  const auto found = names.find(tag);
  return found != names.end() && !found->second.empty() ? found->second : std::to_string(tag);
}

// Regions come in the order of their numbers; two numbers with one name are one region.
void name_regions(const RawMesh& raw, Mesh& mesh) {
  std::map<std::int64_t, Index> region;
  for (const auto& [tag, name] : raw.region_name) region[tag] = 0;
  for (const std::int64_t tag : raw.cell_tag) {
    if (region.empty() || tag != region.rbegin()->first) region[tag] = 0;
  }
  const bool has_loose = region.erase(no_tag) > 0;
  const auto index_of = [&](const std::string& name) {
    const auto found = std::find(mesh.regions.begin(), mesh.regions.end(), name);
    if (found != mesh.regions.end()) return static_cast<Index>(found - mesh.regions.begin());
    mesh.regions.push_back(name);
    return static_cast<Index>(mesh.regions.size() - 1);
  };
  for (auto& [tag, index] : region) index = index_of(name_of(raw.region_name, tag));
  if (has_loose) region[no_tag] = index_of("unassigned");
  if (mesh.regions.size() == 1) return;  // no list of regions needed

  std::int64_t loose = 0, last_tag = no_tag;
  std::vector<std::int64_t> examples;
  Index last = has_loose ? region[no_tag] : 0;
  mesh.cell_region.reserve(raw.cell_tag.size());
  for (std::size_t c = 0; c < raw.cell_tag.size(); ++c) {
    if (raw.cell_tag[c] != last_tag) last = region[last_tag = raw.cell_tag[c]];
    mesh.cell_region.push_back(last);
    if (last_tag == no_tag && ++loose <= static_cast<std::int64_t>(most_examples)) {
      examples.push_back(raw.cell_label[c]);
    }
  }
  if (loose > 0) {
    mesh.notes.push_back({"unassigned-cell",
                          join(loose, " cells are in no group of the file and got the region 'unassigned': ",
                               list(examples, loose)),
                          loose, std::move(examples)});
  }
}

void note_shared_cells(const RawMesh& raw, Mesh& mesh) {
  if (raw.shared_cells == 0) return;
  mesh.notes.push_back(
      {"cell-in-several-regions",
       join(raw.shared_cells, " cells are in several groups; the first group is their region: ",
            list(raw.shared_examples, raw.shared_cells)),
       raw.shared_cells, raw.shared_examples});
}

using EdgeMiddles = std::unordered_map<std::uint64_t, Index>;

std::uint64_t edge_key(Index a, Index b) {
  return (static_cast<std::uint64_t>(std::min(a, b)) << 32) | static_cast<std::uint32_t>(std::max(a, b));
}

EdgeMiddles edge_middles(const RawMesh& raw) {
  EdgeMiddles middle;
  middle.reserve(raw.cells.size() / 7);
  for (std::size_t c = 0; c < raw.cells.size(); c += 10) {
    for (std::size_t k = 0; k < 6; ++k) {
      middle.emplace(edge_key(raw.cells[c + at(tet_edges[k][0])], raw.cells[c + at(tet_edges[k][1])]),
                     raw.cells[c + 4 + k]);
    }
  }
  return middle;
}

// Faces get the width of the cells. Mid-edge nodes are taken from the cells, so that a file with straight
// faces on curved cells, or with its own order, still gives the same surface.
void adopt_surfaces(RawMesh& raw, Mesh& mesh) {
  // Faces of the other kind cannot bound these cells.
  if (raw.cell_width == 8) std::swap(raw.surfaces, raw.quadrangles);
  for (const auto& [tag, others] : raw.quadrangles)
    raw.foreign_faces += static_cast<std::int64_t>(others.faces.size()) / others.width;
  for (const auto& [tag, name] : raw.surface_name) raw.surfaces[tag];
  const std::size_t width = raw.cell_width == 10 ? 6 : (raw.cell_width == 8 ? 4 : 3);
  const std::size_t corners = width == 4 ? 4 : 3;
  const EdgeMiddles middle = width == 6 && !raw.surfaces.empty() ? edge_middles(raw) : EdgeMiddles{};
  for (const auto& [tag, surface] : raw.surfaces) {
    const auto from = static_cast<std::size_t>(surface.width);
    std::vector<Index> faces;
    faces.reserve(from == 0 ? 0 : surface.faces.size() / from * width);
    for (std::size_t f = 0; f < surface.faces.size(); f += from) {
      faces.insert(faces.end(), &surface.faces[f], &surface.faces[f] + corners);
      for (std::size_t k = 0; k < 3 && width == 6; ++k) {
        const auto found = middle.find(edge_key(surface.faces[f + k], surface.faces[f + (k + 1) % 3]));
        // -1 marks a face that lies on no cell: it goes with the unused nodes below.
        faces.push_back(found != middle.end() ? found->second : (from == 6 ? surface.faces[f + 3 + k] : -1));
      }
    }
    // Two numbers with one name are one surface.
    const std::string name = name_of(raw.surface_name, tag);
    const auto known = std::find_if(mesh.surfaces.begin(), mesh.surfaces.end(),
                                    [&](const MeshSurface& s) { return s.name == name; });
    if (known == mesh.surfaces.end()) {
      mesh.surfaces.push_back({name, std::move(faces)});
    } else {
      known->faces.insert(known->faces.end(), faces.begin(), faces.end());
    }
  }
}

void adopt_node_sets(RawMesh& raw, Mesh& mesh) {
  for (auto& [key, set] : raw.node_sets) {
    if (set.name.empty()) set.name = std::to_string(key.second);
    std::sort(set.nodes.begin(), set.nodes.end());
    set.nodes.erase(std::unique(set.nodes.begin(), set.nodes.end()), set.nodes.end());
    mesh.node_sets.push_back(std::move(set));
  }
}

// New index of every node, -1 for those that no cell uses.
std::vector<Index> used_nodes(const RawMesh& raw, Index& used) {
  std::vector<Index> place(raw.nodes.size(), -1);
  for (const Index n : raw.cells) place[at(n)] = 0;
  used = 0;
  for (Index& p : place) {
    if (p == 0) p = used++;
  }
  return place;
}

// Faces with a node that is gone are left out; returns how many.
std::int64_t renumber_faces(std::vector<Index>& faces, std::size_t width, const std::vector<Index>& place) {
  std::size_t kept = 0;
  for (std::size_t f = 0; f < faces.size(); f += width) {
    bool whole = true;
    for (std::size_t k = 0; k < width; ++k) {
      const Index n = faces[f + k];
      faces[kept + k] = n < 0 ? -1 : place[at(n)];
      whole = whole && faces[kept + k] >= 0;
    }
    if (whole) kept += width;
  }
  const std::size_t lost = (faces.size() - kept) / width;
  faces.resize(kept);
  return static_cast<std::int64_t>(lost);
}

void renumber_sets(Mesh& mesh, const std::vector<Index>& place) {
  const auto width = static_cast<std::size_t>(nodes_per_face(mesh.cell_type));
  for (MeshSurface& surface : mesh.surfaces) {
    const std::int64_t lost = renumber_faces(surface.faces, width, place);
    if (lost == 0) continue;
    mesh.notes.push_back(
        {"surface-without-cells",
         join(lost, " faces of surface '", surface.name, "' touch nodes that no cell uses and were ",
              "left out: does the surface belong to this body?"),
         lost,
         {}});
  }
  for (MeshNodeSet& set : mesh.node_sets) {
    std::size_t kept = 0;
    for (const Index n : set.nodes) {
      if (place[at(n)] >= 0) set.nodes[kept++] = place[at(n)];
    }
    const auto lost = static_cast<std::int64_t>(set.nodes.size() - kept);
    set.nodes.resize(kept);
    if (lost == 0) continue;
    mesh.notes.push_back(
        {"node-set-without-cells",
         join(lost, " nodes of node set '", set.name, "' are used by no cell and were left out"),
         lost,
         {}});
  }
}

void adopt_nodes(RawMesh& raw, Mesh& mesh, const std::vector<Index>& place, Index used, double scale) {
  mesh.nodes.reserve(at(used));
  mesh.node_label.reserve(at(used));
  std::int64_t dropped = 0;
  std::vector<std::int64_t> examples;
  for (std::size_t i = 0; i < raw.nodes.size(); ++i) {
    if (place[i] < 0) {
      if (++dropped <= static_cast<std::int64_t>(most_examples)) examples.push_back(raw.node_label[i]);
      continue;
    }
    const Vec3 x = scale * raw.nodes[i];
    if (!std::isfinite(x.x) || !std::isfinite(x.y) || !std::isfinite(x.z)) {
      fail(raw, join("node ", raw.node_label[i], " is not finite after scaling by ", scale),
           "correct the scale");
    }
    mesh.nodes.push_back(x);
    mesh.node_label.push_back(raw.node_label[i]);
  }
  for (MeshField& field : raw.fields) {
    const auto width = static_cast<std::size_t>(field.components);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < place.size(); ++i) {
      if (place[i] < 0) continue;
      for (std::size_t k = 0; k < width; ++k) field.values[kept++] = field.values[i * width + k];
    }
    field.values.resize(kept);
    mesh.fields.push_back(std::move(field));
  }
  if (dropped == 0) return;
  mesh.notes.push_back(
      {"dropped-node",
       join(dropped, " nodes of the file are used by no cell and were left out: ", list(examples, dropped)),
       dropped, std::move(examples)});
}

// Labels that count 1, 2, 3, ... say nothing that the index does not.
void drop_plain(std::vector<std::int64_t>& labels) {
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (labels[i] != static_cast<std::int64_t>(i) + 1) return;
  }
  labels.clear();
}

}  // namespace

Mesh assemble(RawMesh raw, double scale) {
  require_cells(raw);
  Mesh mesh;
  mesh.source = raw.file;
  mesh.cell_type = raw.cell_width == 10  ? CellType::tet10
                   : raw.cell_width == 8 ? CellType::hex8
                   : raw.cell_width == 3 ? CellType::tri3
                                         : CellType::tet4;
  order_mid_edges(raw, mesh);
  turn_inverted(raw, mesh);
  name_regions(raw, mesh);
  note_shared_cells(raw, mesh);
  adopt_surfaces(raw, mesh);
  adopt_node_sets(raw, mesh);
  if (raw.stray_lines > 0) {
    mesh.notes.push_back({"stray-line",
                          join(raw.stray_lines, raw.stray_lines == 1 ? " line" : " lines",
                               " outside of the sections of the file left out (Gmsh appends commands of its ",
                               "window to the file that is open)"),
                          raw.stray_lines,
                          {}});
  }
  if (raw.foreign_faces > 0) {
    mesh.notes.push_back(
        {"foreign-face",
         join(raw.foreign_faces, " faces that no cell of this mesh can have (triangles on hexahedra, ",
              "quadrangles on tetrahedra or another order) were left out"),
         raw.foreign_faces,
         {}});
  }
  Index used = 0;
  const std::vector<Index> place = used_nodes(raw, used);
  renumber_sets(mesh, place);
  adopt_nodes(raw, mesh, place, used, scale);
  for (Index& n : raw.cells) n = place[at(n)];
  mesh.cells = std::move(raw.cells);
  for (MeshField& field : raw.cell_fields) {
    if (field.values.size() == at(mesh.cell_count()) * at(field.components)) {
      mesh.cell_fields.push_back(std::move(field));
      continue;
    }
    mesh.notes.push_back(
        {"partial-field",
         join("field '", field.name, "' is not in every cell and was left out; write it for ", "all of them"),
         1,
         {}});
  }
  mesh.cell_label = std::move(raw.cell_label);
  drop_plain(mesh.node_label);
  drop_plain(mesh.cell_label);
  return mesh;
}

}  // namespace isochor::mesh_files
