// check_mesh: the order of the checks, and the ones about plain arrays.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/base/available_memory.h"
#include "engine/mesh/check/check_parts.h"

namespace isochor {

namespace mesh_files {

std::string Tally::text(const char* singular, const char* plural, const char* numbered) const {
  std::string numbers;
  for (const std::int64_t n : examples_) numbers += (numbers.empty() ? "" : ", ") + std::to_string(n);
  if (count_ > most) numbers += ", ...";
  return shown(count_) + " " + (count_ == 1 ? singular : plural) + " (" + numbered + numbers + ")";
}

void Tally::report(MeshReport& report, Severity severity, const char* code, const char* singular,
                   const char* plural, const std::string& message, const char* numbered) const {
  if (count_ == 0) return;
  report.findings.push_back(
      {severity, code, text(singular, plural, numbered) + " " + message, count_, examples_});
}

std::int64_t cell_label(const Mesh& mesh, Index cell) {
  return mesh.cell_label.empty() ? cell + 1 : mesh.cell_label[at(cell)];
}

std::int64_t node_label(const Mesh& mesh, Index node) {
  return mesh.node_label.empty() ? node + 1 : mesh.node_label[at(node)];
}

Groups::Groups(std::size_t count) : parent_(count) {
  std::iota(parent_.begin(), parent_.end(), 0);
}

Index Groups::root(Index i) {
  while (parent_[at(i)] != i) {
    parent_[at(i)] = parent_[at(parent_[at(i)])];
    i = parent_[at(i)];
  }
  return i;
}

void Groups::join(Index a, Index b) {
  a = root(a);
  b = root(b);
  // The smaller index leads, so that a group is named by its first member.
  parent_[at(std::max(a, b))] = std::min(a, b);
}

namespace {

void refuse(MeshReport& report, const char* code, std::string message) {
  report.findings.push_back({Severity::error, code, std::move(message), 1, {}});
}

bool in_range(const Mesh& mesh, const std::vector<Index>& indices) {
  return std::all_of(indices.begin(), indices.end(),
                     [&](Index n) { return n >= 0 && n < mesh.node_count(); });
}

void check_lengths(const Mesh& mesh, MeshReport& report) {
  const auto width = static_cast<std::size_t>(nodes_per_cell(mesh.cell_type));
  if (mesh.cells.empty())
    refuse(report, "no-cells",
           mesh.cell_type == CellType::tri3 ? "the mesh has no faces; give it triangles"
                                            : "the mesh has no cells; give it tetrahedra or hexahedra");
  if (mesh.cells.size() % width != 0) {
    refuse(report, "array-length",
           join("'cells' has ", mesh.cells.size(), " entries, no multiple of ", width,
                "; complete the last cell"));
  }
  const std::size_t cells = mesh.cells.size() / width;
  const auto require = [&](std::size_t length, std::size_t expected, const char* name) {
    if (length == 0 || length == expected) return;
    refuse(report, "array-length",
           join("'", name, "' has ", length, " entries; leave it empty or give it ", expected));
  };
  require(mesh.cell_region.size(), cells, "cell_region");
  require(mesh.cell_label.size(), cells, "cell_label");
  require(mesh.node_label.size(), mesh.nodes.size(), "node_label");
  for (const MeshField& field : mesh.fields) {
    if (field.components > 0 && field.values.size() == mesh.nodes.size() * at(field.components)) continue;
    refuse(report, "array-length",
           join("field '", field.name, "' has ", field.values.size(), " values for ", mesh.nodes.size(),
                " nodes of ", field.components, " components"));
  }
  for (const MeshField& field : mesh.cell_fields) {
    if (field.components > 0 && field.values.size() == cells * at(field.components)) continue;
    refuse(report, "array-length",
           join("cell field '", field.name, "' has ", field.values.size(), " values for ", cells,
                " cells of ", field.components, " components"));
  }
}

void check_indices(const Mesh& mesh, MeshReport& report) {
  const auto refuse_range = [&](const std::string& what) {
    refuse(report, "index-out-of-range",
           join(what, " names a node outside of 0 to ", mesh.node_count() - 1, "; correct the indices"));
  };
  if (!in_range(mesh, mesh.cells)) refuse_range("a cell");
  const auto width = static_cast<std::size_t>(nodes_per_face(mesh.cell_type));
  for (const MeshSurface& surface : mesh.surfaces) {
    if (!in_range(mesh, surface.faces)) refuse_range("surface '" + surface.name + "'");
    if (surface.faces.size() % width != 0) {
      refuse(report, "array-length",
             join("surface '", surface.name, "' has ", surface.faces.size(), " entries, no multiple of ",
                  width));
    }
  }
  for (const MeshNodeSet& set : mesh.node_sets) {
    if (!in_range(mesh, set.nodes)) refuse_range("node set '" + set.name + "'");
  }
  // Without a list of regions only region 0 exists.
  const auto regions = static_cast<Index>(std::max<std::size_t>(1, mesh.regions.size()));
  if (!std::all_of(mesh.cell_region.begin(), mesh.cell_region.end(),
                   [&](Index r) { return r >= 0 && r < regions; })) {
    refuse(report, "index-out-of-range", join("a cell names a region outside of 0 to ", regions - 1));
  }
}

void check_finite(const Mesh& mesh, MeshReport& report) {
  Tally nodes;
  for (Index n = 0; n < mesh.node_count(); ++n) {
    const Vec3& x = mesh.nodes[at(n)];
    if (!std::isfinite(x.x) || !std::isfinite(x.y) || !std::isfinite(x.z)) {
      nodes.add(mesh.node_label.size() == mesh.nodes.size() ? node_label(mesh, n) : n + 1);
    }
  }
  nodes.report(report, Severity::error, "not-finite", "node", "nodes",
               "have NaN or infinite coordinates; repair them");
  for (const MeshField& field : mesh.fields) {
    const auto bad =
        std::count_if(field.values.begin(), field.values.end(), [](double v) { return !std::isfinite(v); });
    if (bad == 0) continue;
    report.findings.push_back({Severity::warning,
                               "field-not-finite",
                               join(bad, " values of field '", field.name,
                                    "' are NaN or infinite; they must not be used as weights"),
                               bad,
                               {}});
  }
}

}  // namespace

bool check_arrays(const Mesh& mesh, MeshReport& report) {
  check_lengths(mesh, report);
  check_indices(mesh, report);
  check_finite(mesh, report);
  return report.usable();
}

}  // namespace mesh_files

bool MeshReport::usable() const {
  return std::none_of(findings.begin(), findings.end(),
                      [](const MeshFinding& f) { return f.severity == Severity::error; });
}

MeshReport check_mesh(const Mesh& mesh) {
  MeshReport report;
  report.nodes = mesh.node_count();
  report.cells = mesh.cell_count();
  for (const MeshNote& note : mesh.notes) {
    report.findings.push_back({Severity::note, note.code, note.message, note.count, note.examples});
  }
  if (!mesh_files::check_arrays(mesh, report)) return report;
  if (auto why = too_large_for_memory(mesh.cell_count(), mesh.cell_type, MeshUse::check); !why.empty()) {
    report.findings.push_back({Severity::error, "too-large", std::move(why), 1, {}});
    return report;
  }
  mesh_files::check_nodes(mesh, report);
  mesh_files::check_cells(mesh, report);
  const std::vector<mesh_files::CellFace> faces = mesh_files::sorted_cell_faces(mesh);
  mesh_files::check_boundary(mesh, faces, report);
  mesh_files::check_named_sets(mesh, faces, report);
  // Worst first; within a severity the order of the checks stands.
  std::stable_sort(report.findings.begin(), report.findings.end(),
                   [](const MeshFinding& a, const MeshFinding& b) { return a.severity > b.severity; });
  return report;
}

}  // namespace isochor
