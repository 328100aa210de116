// Meshes: arrays in and out, readers, the generator of boxes, the checker.
#include <pybind11/stl.h>

#include "engine/base/text.h"
#include "interop.h"
#include "isochor/generate.h"
#include "isochor/mesh_io.h"
#include "isochor/mesh_select.h"

namespace isochor::python {

namespace {

using MeshPtr = std::shared_ptr<const Mesh>;
using MeshClass = py::class_<Mesh, std::shared_ptr<Mesh>>;

const char* name_of(CellType type) {
  constexpr const char* names[] = {"tet4", "tet10", "hex8", "tri3"};
  return names[static_cast<int>(type)];
}

CellType cell_type_of(const py::array& cells) {
  const py::ssize_t width = cells.ndim() == 2 ? cells.shape(1) : 0;
  if (width == 4) return CellType::tet4;
  if (width == 10) return CellType::tet10;
  if (width == 8) return CellType::hex8;
  if (width == 3) return CellType::tri3;
  throw Refused("Mesh: cells have " +
                (cells.ndim() == 2 ? std::to_string(width) + " nodes each"
                                   : std::to_string(cells.ndim()) + " dimensions") +
                "; give an array of shape (m, 4), (m, 10), (m, 8) or (m, 3) for tet4, tet10, hex8 or tri3");
}

std::shared_ptr<Mesh> make_mesh(const py::object& points, const py::object& cells,
                                const py::object& cell_region, const std::vector<std::string>& regions,
                                const py::dict& surfaces, const py::dict& node_sets, const py::dict& fields,
                                const std::string& source) {
  auto mesh = std::make_shared<Mesh>();
  mesh->source = source;
  mesh->nodes = points_in(points, "Mesh: points");
  mesh->cell_type = cell_type_of(py::module_::import("numpy").attr("asarray")(cells));
  const Index nodes = mesh->node_count();
  mesh->cells = indices_in(cells, "Mesh: cells", nodes_per_cell(mesh->cell_type), nodes);
  mesh->regions = regions.empty() ? std::vector<std::string>{"body"} : regions;
  if (!cell_region.is_none()) {
    mesh->cell_region =
        indices_in(cell_region, "Mesh: cell_region", 0, static_cast<Index>(mesh->regions.size()));
    if (static_cast<Index>(mesh->cell_region.size()) != mesh->cell_count()) {
      throw Refused("Mesh: cell_region has " + std::to_string(mesh->cell_region.size()) + " entries for " +
                    std::to_string(mesh->cell_count()) + " cells; give one a cell");
    }
  }
  for (const auto& [name, faces] : surfaces) {
    const auto key = py::cast<std::string>(name);
    mesh->surfaces.push_back(
        {key, indices_in(faces, "Mesh: surface \"" + key + "\"", nodes_per_face(mesh->cell_type), nodes)});
  }
  for (const auto& [name, set] : node_sets) {
    const auto key = py::cast<std::string>(name);
    mesh->node_sets.push_back({key, indices_in(set, "Mesh: node set \"" + key + "\"", 0, nodes)});
  }
  for (const auto& [name, values] : fields) {
    const auto key = py::cast<std::string>(name);
    std::vector<double> numbers = numbers_in(values, "Mesh: field \"" + key + "\"");
    const auto count = static_cast<std::size_t>(nodes);
    if (count == 0 || numbers.empty() || numbers.size() % count != 0) {
      throw Refused("Mesh: field \"" + key + "\" has " + std::to_string(numbers.size()) + " numbers for " +
                    std::to_string(nodes) + " nodes; give as many a node");
    }
    mesh->fields.push_back({key, static_cast<int>(numbers.size() / count), std::move(numbers)});
  }
  return mesh;
}

py::dict surfaces_of(const std::shared_ptr<Mesh>& mesh) {
  py::dict out;
  for (const MeshSurface& s : mesh->surfaces)
    out[py::str(s.name)] = array_of(std::span<const Index>(s.faces), nodes_per_face(mesh->cell_type), mesh);
  return out;
}

py::dict node_sets_of(const std::shared_ptr<Mesh>& mesh) {
  py::dict out;
  for (const MeshNodeSet& s : mesh->node_sets)
    out[py::str(s.name)] = array_of(std::span<const Index>(s.nodes), 0, mesh);
  return out;
}

py::dict fields_of(const std::shared_ptr<Mesh>& mesh) {
  py::dict out;
  for (const MeshField& f : mesh->fields)
    out[py::str(f.name)] =
        array_of(std::span<const double>(f.values), f.components > 1 ? f.components : 0, mesh);
  return out;
}

py::list notes_of(const Mesh& mesh) {
  py::list out;
  for (const MeshNote& note : mesh.notes) out.append(py::make_tuple(note.code, note.message));
  return out;
}

const char* name_of(Severity severity) {
  return severity == Severity::error ? "error" : (severity == Severity::warning ? "warning" : "note");
}

py::dict check(const Mesh& mesh) {
  MeshReport report;
  {
    const py::gil_scoped_release free;
    report = check_mesh(mesh);
  }
  py::list findings;
  for (const MeshFinding& f : report.findings) {
    py::dict one;
    one["severity"] = name_of(f.severity);
    one["code"] = f.code;
    one["message"] = f.message;
    one["count"] = f.count;
    findings.append(one);
  }
  py::dict out;
  out["usable"] = report.usable();
  out["nodes"] = report.nodes;
  out["cells"] = report.cells;
  out["parts"] = report.parts;
  out["volume"] = report.volume;
  out["box"] = array_of(std::vector<Vec3>(report.box.begin(), report.box.end()));
  out["worst_quality"] = report.worst_quality;
  out["smallest_dihedral_deg"] = report.smallest_dihedral_deg;
  out["findings"] = findings;
  return out;
}

std::shared_ptr<Mesh> read(const std::string& path, double scale, bool triangles) {
  const py::gil_scoped_release free;
  return std::make_shared<Mesh>(need(read_mesh(path, {scale, triangles})));
}

std::shared_ptr<Mesh> box(const py::object& lower, const py::object& upper, const py::object& divisions,
                          const std::string& cell_type) {
  constexpr Index most = 1 << 20;
  const std::vector<Index> sides = indices_in(divisions, "box_mesh: divisions", 0, most);
  if (sides.size() != 3) {
    throw Refused("box_mesh: divisions are " + std::to_string(sides.size()) +
                  " numbers; give three, cells a side");
  }
  BoxMeshDef def;
  def.lower = vector_in(lower, "box_mesh: lower");
  def.upper = vector_in(upper, "box_mesh: upper");
  def.divisions = {sides[0], sides[1], sides[2]};
  for (const CellType type : {CellType::tet4, CellType::tet10, CellType::hex8, CellType::tri3}) {
    if (cell_type != name_of(type)) continue;
    def.cell_type = type;
    return std::make_shared<Mesh>(need(box_mesh(def)));
  }
  throw Refused("box_mesh: cell_type is \"" + cell_type +
                "\"; give \"tet4\", \"tet10\", \"hex8\" or \"tri3\"");
}

}  // namespace

void bind_meshes(py::module_& module) {
  MeshClass(module, "Mesh")
      .def(py::init(&make_mesh))
      .def_property_readonly(
          "points",
          [](const std::shared_ptr<Mesh>& m) { return array_of(std::span<const Vec3>(m->nodes), m); })
      .def_property_readonly("cells",
                             [](const std::shared_ptr<Mesh>& m) {
                               return array_of(std::span<const Index>(m->cells), nodes_per_cell(m->cell_type),
                                               m);
                             })
      .def_property_readonly("cell_region",
                             [](const std::shared_ptr<Mesh>& m) -> py::object {
                               if (m->cell_region.empty()) return py::none();
                               return array_of(std::span<const Index>(m->cell_region), 0, m);
                             })
      .def_property_readonly("cell_type", [](const Mesh& m) { return name_of(m.cell_type); })
      .def_readonly("regions", &Mesh::regions)
      .def_readonly("source", &Mesh::source)
      .def_property_readonly("surfaces", &surfaces_of)
      .def_property_readonly("node_sets", &node_sets_of)
      .def_property_readonly("fields", &fields_of)
      .def_property_readonly("notes", &notes_of)
      .def("check", &check);
  module.def("read_mesh", &read);
  module.def("box_mesh", &box);
}

}  // namespace isochor::python
