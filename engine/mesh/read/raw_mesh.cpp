#include "engine/mesh/read/raw_mesh.h"

#include <algorithm>

namespace isochor::mesh_files {

void RawMesh::add_cell(const Cursor& at, std::int64_t label, std::int64_t tag,
                       std::span<const Index> file_nodes, const Tet10Order& order) {
  const int width = static_cast<int>(file_nodes.size());
  if (cell_width != 0 && cell_width != width) {
    at.fail(join("cell ", label, " has ", width, " nodes but the cells before it have ", cell_width),
            "a mesh must be of one kind and one order: export all cells as tetrahedra with 4, as tetrahedra "
            "with 10 or as hexahedra with 8 nodes");
  }
  cell_width = width;
  for (int k = 0; k < width; ++k) {
    const auto from = static_cast<std::size_t>(width == 10 ? order[static_cast<std::size_t>(k)] : k);
    cells.push_back(file_nodes[from]);
  }
  cell_label.push_back(label);
  cell_tag.push_back(tag);
}

void RawMesh::add_face(const Cursor& at, std::int64_t tag, std::span<const Index> corners_first) {
  const int width = static_cast<int>(corners_first.size());
  RawSurface& surface = width == 4 ? quadrangles[tag] : surfaces[tag];
  if (surface.width != 0 && surface.width != width) {
    at.fail(join("surface ", tag, " mixes faces of ", surface.width, " and ", width, " nodes"),
            "export all faces in the order of the tetrahedra");
  }
  surface.width = width;
  surface.faces.insert(surface.faces.end(), corners_first.begin(), corners_first.end());
}

std::pair<bool, std::int64_t> LabelMap::build(std::span<const std::int64_t> labels) {
  table_.clear();
  sorted_.clear();
  if (labels.empty()) return {true, 0};
  const auto [low, high] = std::minmax_element(labels.begin(), labels.end());
  first_ = *low;
  // Unsigned, since the difference of two arbitrary numbers may not fit the signed type.
  const std::uint64_t range = static_cast<std::uint64_t>(*high) - static_cast<std::uint64_t>(*low);
  if (range < 8 * labels.size() + 1024) {
    table_.assign(static_cast<std::size_t>(range) + 1, -1);
    for (std::size_t i = 0; i < labels.size(); ++i) {
      Index& slot = table_[static_cast<std::size_t>(labels[i] - first_)];
      if (slot >= 0) return {false, labels[i]};
      slot = static_cast<Index>(i);
    }
    return {true, 0};
  }
  sorted_.reserve(labels.size());
  for (std::size_t i = 0; i < labels.size(); ++i) sorted_.emplace_back(labels[i], static_cast<Index>(i));
  std::sort(sorted_.begin(), sorted_.end());
  for (std::size_t i = 1; i < sorted_.size(); ++i) {
    if (sorted_[i].first == sorted_[i - 1].first) return {false, sorted_[i].first};
  }
  return {true, 0};
}

Index LabelMap::find(std::int64_t label) const {
  if (!table_.empty()) {
    const std::uint64_t place = static_cast<std::uint64_t>(label) - static_cast<std::uint64_t>(first_);
    return place < table_.size() ? table_[static_cast<std::size_t>(place)] : -1;
  }
  const auto found =
      std::lower_bound(sorted_.begin(), sorted_.end(), std::pair<std::int64_t, Index>(label, -1));
  return found != sorted_.end() && found->first == label ? found->second : -1;
}

}  // namespace isochor::mesh_files
