// In the place of read_vtu.cpp and write_vtu.cpp where a build has neither pugixml nor zlib
// (ISOCHOR_WITH_VTU=OFF).
#include "engine/mesh/read/readers.h"
#include "isochor/mesh_io.h"

namespace isochor {

namespace {

std::string refusal(const std::string& file) {
  return file + ": this build does without VTK XML files; configure with -DISOCHOR_WITH_VTU=ON";
}

}  // namespace

namespace mesh_files {

RawMesh read_vtu(std::string_view, const std::string& file) {
  throw ReadFailure{refusal(file) + ", or convert the mesh to Gmsh .msh"};
}

}  // namespace mesh_files

Result<void> write_vtu(const std::string& path, const VtkGrid&) {
  return Error{refusal(path)};
}

Result<void> write_pvd(const std::string& path, std::span<const PvdEntry>) {
  return Error{refusal(path)};
}

}  // namespace isochor
