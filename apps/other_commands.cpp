// list, check, keys and version.
#include <cstdio>
#include <nlohmann/json.hpp>

#include "apps/commands.h"
#include "apps/table.h"
#include "engine/solvers/linear_solver.h"
#include "isochor/mesh_io.h"
#include "scenes/library.h"
#include "scenes/run/run.h"
#include "scenes/scene_file.h"
#include "scenes/thin_walls.h"
#ifdef ISOCHOR_HAVE_PETSC
#include "petsc/session.h"
#endif

namespace isochor::app {

int refuse(const std::string& what) {
  std::fprintf(stderr, "isochor: %s\n", what.c_str());
  return bad_input;
}

namespace {

using Json = nlohmann::ordered_json;

void print(const Json& json) {
  std::printf("%s\n", json.dump(2, ' ', false, Json::error_handler_t::replace).c_str());
}

std::string mesh_name(const SceneDef& scene) {
  const auto* file = std::get_if<MeshFile>(&scene.bodies[0].mesh);
  if (file) return file->path;
  if (const auto* lattice = std::get_if<LatticeMesh>(&scene.bodies[0].mesh))
    return lattice->surface + " in cubes";
  const auto& box = std::get<BoxMeshDef>(scene.bodies[0].mesh);
  return "box " + std::to_string(box.divisions[0]) + " x " + std::to_string(box.divisions[1]) + " x " +
         std::to_string(box.divisions[2]);
}

const char* to_string(Severity s) {
  return s == Severity::error ? "error" : s == Severity::warning ? "warning" : "note";
}

Json list_of(const Vec3& v) {
  return Json::array({v.x, v.y, v.z});
}

Json report_json(const std::string& path, const MeshReport& r) {
  Json j{{"mesh", path},
         {"usable", r.usable()},
         {"nodes", r.nodes},
         {"cells", r.cells},
         {"parts", r.parts},
         {"volume_m3", r.volume},
         {"box_m", Json::array({list_of(r.box[0]), list_of(r.box[1])})},
         {"worst_quality", r.worst_quality},
         {"smallest_dihedral_deg", r.smallest_dihedral_deg}};
  j["boundary"] = Json::array();
  for (const BoundaryPart& part : r.boundary) {
    j["boundary"].push_back({{"name", part.surface.name}, {"volume_m3", part.volume}, {"taken", part.taken}});
  }
  j["findings"] = Json::array();
  for (const auto& f : r.findings) {
    j["findings"].push_back({{"severity", to_string(f.severity)},
                             {"code", f.code},
                             {"message", f.message},
                             {"count", f.count},
                             {"examples", f.examples}});
  }
  return j;
}

void print_sets(const Mesh& mesh) {
  std::string regions, surfaces, sets;
  for (const auto& r : mesh.regions) regions += (regions.empty() ? "" : ", ") + r;
  const auto width = static_cast<std::size_t>(nodes_per_face(mesh.cell_type));
  for (const auto& s : mesh.surfaces) {
    surfaces += (surfaces.empty() ? "" : ", ") + s.name + " (" + std::to_string(s.faces.size() / width) + ")";
  }
  for (const auto& s : mesh.node_sets) {
    sets += (sets.empty() ? "" : ", ") + s.name + " (" + std::to_string(s.nodes.size()) + ")";
  }
  std::printf("  regions   %s\n  surfaces  %s\n", regions.empty() ? "none" : regions.c_str(),
              surfaces.empty() ? "none" : surfaces.c_str());
  if (!sets.empty()) std::printf("  node sets %s\n", sets.c_str());
}

const char* cell_name(CellType type) {
  constexpr const char* names[] = {"Tet4", "Tet10", "Hex8", "Tri3"};
  return names[static_cast<int>(type)];
}

// What every body has without a group of its mesh.
void print_boundary(const MeshReport& r, CellType type) {
  const auto width = static_cast<std::size_t>(nodes_per_face(type));
  std::string text;
  for (const BoundaryPart& part : r.boundary) {
    text += (text.empty() ? "\"" : ", \"") + part.surface.name + "\" (" +
            std::to_string(part.surface.faces.size() / width);
    if (&part != &r.boundary.front()) text += " around " + number(part.volume) + " m^3";
    text += part.taken ? "; a surface of the mesh has this name)" : ")";
  }
  if (!text.empty()) std::printf("  boundary  %s, by these names in scenes\n", text.c_str());
}

void print_report(const std::string& path, const Mesh& mesh, const MeshReport& r) {
  std::printf("%s\n  %d nodes, %d %s in %d part%s\n", path.c_str(), r.nodes, r.cells,
              cell_name(mesh.cell_type), r.parts, r.parts == 1 ? "" : "s");
  std::printf("  box       (%s, %s, %s) to (%s, %s, %s) m, volume %s m^3\n", number(r.box[0].x).c_str(),
              number(r.box[0].y).c_str(), number(r.box[0].z).c_str(), number(r.box[1].x).c_str(),
              number(r.box[1].y).c_str(), number(r.box[1].z).c_str(), number(r.volume).c_str());
  std::printf("  quality   %s at worst, smallest dihedral angle %s degrees\n",
              number(r.worst_quality, 3).c_str(), number(r.smallest_dihedral_deg, 3).c_str());
  print_sets(mesh);
  print_boundary(r, mesh.cell_type);
  for (const auto& f : r.findings) {
    std::printf("  %-7s   %s: %s\n", to_string(f.severity), f.code.c_str(), f.message.c_str());
  }
  std::printf("  %s\n", r.usable() ? "usable" : "NOT USABLE");
}

}  // namespace

int list(bool json) {
  Json all = Json::array();
  Table table({"scene", "what it shows", "mesh", "steps", "metrics"});
  table.numbers_from(3, 4);
  for (const LibraryScene& s : scene_library()) {
    const SceneDef scene = s.make({});
    all.push_back({{"name", s.name},
                   {"title", s.title},
                   {"mesh", mesh_name(scene)},
                   {"steps", plan_steps(scene.analysis).steps}});
    for (const auto& m : scene.metrics) all.back()["metrics"].push_back(m.name);
    table.add({std::string(s.name), std::string(s.title), mesh_name(scene),
               std::to_string(plan_steps(scene.analysis).steps), std::to_string(scene.metrics.size())});
  }
  if (json)
    print(all);
  else
    std::printf("%s\nRun one with `isochor run NAME`; `isochor show NAME` prints it as a scene file.\n",
                table.text().c_str());
  return success;
}

int keys(KeysAs as) {
  const std::string text = as == KeysAs::schema   ? scene_schema()
                           : as == KeysAs::tables ? scene_key_tables()
                                                  : scene_key_lines();
  std::fputs(text.c_str(), stdout);
  return success;
}

int check(const std::vector<std::string>& meshes, double scale, bool triangles, bool json) {
  bool usable = true;
  Json all = Json::array();
  for (const std::string& path : meshes) {
    const auto mesh = read_mesh(path, {scale, triangles});
    if (!mesh) {
      usable = false;
      if (json)
        all.push_back({{"mesh", path}, {"usable", false}, {"error", mesh.error()}});
      else
        std::fprintf(stderr, "isochor: %s\n", mesh.error().c_str());
      continue;
    }
    MeshReport report = check_mesh(mesh.value());
    if (const std::string walls = report.usable() ? thin_walls(mesh.value()) : ""; !walls.empty())
      report.findings.push_back({Severity::note, "thin-walls", walls, 1, {}});
    usable = usable && report.usable();
    if (json)
      all.push_back(report_json(path, report));
    else
      print_report(path, mesh.value(), report);
  }
  if (json) print(all);
  return usable ? success : bad_input;
}

int version(bool json) {
  std::vector<SolverBackend> backends = linear_solver_backends();
#ifdef ISOCHOR_HAVE_PETSC
  backends.push_back({"PETSc (" + mpi_version() + ")", petsc_version(), "BSD-2-Clause"});
#endif
  if (json) {
    Json solvers = Json::array();
    for (const SolverBackend& b : backends) {
      solvers.push_back({{"name", b.name}, {"version", b.version}, {"license", b.license}});
    }
    print({{"version", isochor::version()},
           {"build", build_description()},
           {"solvers", solvers},
           {"machine", machine_description()},
           {"license", "Apache-2.0"}});
    return success;
  }
  std::printf(
      "isochor %s\n  build     %s\n  machine   %s\n  license   Apache-2.0; of the solvers in this build:\n",
      isochor::version().c_str(), build_description().c_str(), machine_description().c_str());
  for (const SolverBackend& b : backends) {
    std::printf("            %s %s: %s\n", b.name.c_str(), b.version.c_str(), b.license.c_str());
  }
  return success;
}

}  // namespace isochor::app
