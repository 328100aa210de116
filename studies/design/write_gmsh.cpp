#include "studies/design/write_gmsh.h"

#include <array>
#include <cstdio>

#include "scenes/run/outputs.h"

namespace isochor::design {

namespace {

struct Types {
  int cell, face;
};
Types types_of(CellType type) {
  switch (type) {
    case CellType::tet4:
      return {4, 2};
    case CellType::tet10:
      return {11, 9};
    case CellType::hex8:
      return {5, 3};
    default:
      return {2, 2};
  }
}

class Writer {
 public:
  explicit Writer(const Mesh& mesh) : mesh_(mesh) {}

  std::string text() {
    out_ = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
    add_names();
    add_nodes();
    add_elements();
    return std::move(out_);
  }

 private:
  void number(long long value) { out_ += std::to_string(value), out_ += ' '; }
  void end_line() { out_.back() = '\n'; }
  // Numbers of groups: regions, then surfaces, then node sets.
  std::size_t regions() const { return mesh_.regions.size(); }
  std::size_t surface_group(std::size_t k) const { return regions() + k + 1; }
  std::size_t set_group(std::size_t k) const { return regions() + mesh_.surfaces.size() + k + 1; }

  void add_names() {
    const std::size_t count = regions() + mesh_.surfaces.size() + mesh_.node_sets.size();
    if (count == 0) return;
    out_ += "$PhysicalNames\n" + std::to_string(count) + "\n";
    const auto name = [&](int dimension, std::size_t group, const std::string& text) {
      out_ += std::to_string(dimension) + " " + std::to_string(group) + " \"" + text + "\"\n";
    };
    for (std::size_t k = 0; k < regions(); ++k) name(3, k + 1, mesh_.regions[k]);
    for (std::size_t k = 0; k < mesh_.surfaces.size(); ++k) name(2, surface_group(k), mesh_.surfaces[k].name);
    for (std::size_t k = 0; k < mesh_.node_sets.size(); ++k) name(0, set_group(k), mesh_.node_sets[k].name);
    out_ += "$EndPhysicalNames\n";
  }

  void add_nodes() {
    out_ += "$Nodes\n" + std::to_string(mesh_.nodes.size()) + "\n";
    for (std::size_t i = 0; i < mesh_.nodes.size(); ++i) {
      const Vec3& x = mesh_.nodes[i];
      char line[120];
      std::snprintf(line, sizeof line, "%zu %.17g %.17g %.17g\n", i + 1, x.x, x.y, x.z);
      out_ += line;
    }
    out_ += "$EndNodes\n";
  }

  void add_element(int type, std::size_t group, std::size_t entity, const Index* nodes, int count) {
    number(static_cast<long long>(++elements_));
    number(type);
    number(2);
    number(static_cast<long long>(group));
    number(static_cast<long long>(entity));
    // Gmsh has the last two edges of a Tet10 the other way round.
    static constexpr std::array<int, 10> gmsh{0, 1, 2, 3, 4, 5, 6, 7, 9, 8};
    for (int k = 0; k < count; ++k) number(nodes[count == 10 ? gmsh[static_cast<std::size_t>(k)] : k] + 1);
    end_line();
  }

  void add_elements() {
    const Types types = types_of(mesh_.cell_type);
    const int per = nodes_per_cell(mesh_.cell_type), on_face = nodes_per_face(mesh_.cell_type);
    std::size_t count = static_cast<std::size_t>(mesh_.cell_count());
    for (const MeshSurface& s : mesh_.surfaces) count += s.faces.size() / static_cast<std::size_t>(on_face);
    for (const MeshNodeSet& s : mesh_.node_sets) count += s.nodes.size();
    out_ += "$Elements\n" + std::to_string(count) + "\n";
    for (std::size_t k = 0; k < mesh_.surfaces.size(); ++k) {
      const std::vector<Index>& faces = mesh_.surfaces[k].faces;
      for (std::size_t f = 0; f < faces.size(); f += static_cast<std::size_t>(on_face))
        add_element(types.face, surface_group(k), k + 1, &faces[f], on_face);
    }
    for (std::size_t k = 0; k < mesh_.node_sets.size(); ++k) {
      for (const Index n : mesh_.node_sets[k].nodes) add_element(15, set_group(k), k + 1, &n, 1);
    }
    for (std::size_t c = 0; c < static_cast<std::size_t>(mesh_.cell_count()); ++c) {
      const std::size_t region =
          mesh_.cell_region.empty() ? 0 : static_cast<std::size_t>(mesh_.cell_region[c]);
      add_element(types.cell, regions() > 0 ? region + 1 : 0, region + 1,
                  &mesh_.cells[c * static_cast<std::size_t>(per)], per);
    }
    out_ += "$EndElements\n";
  }

  const Mesh& mesh_;
  std::string out_;
  std::size_t elements_ = 0;
};

}  // namespace

Result<void> write_gmsh(const std::string& path, const Mesh& mesh) {
  return write_text(path, Writer(mesh).text());
}

}  // namespace isochor::design
