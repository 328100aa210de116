// Mesh files of all formats that are told by their content; what is read passes the checker, and may go into
// a world.
#include <cmath>

#include "fuzz/input.h"
#include "isochor/mesh_io.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static fuzz::File file(".msh");
  const auto mesh = isochor::read_mesh(file.write(data, size));
  if (!mesh) {
    fuzz::require_message(mesh.error());
    return 0;
  }
  for (const isochor::Index node : mesh.value().cells)
    fuzz::require(node >= 0 && node < mesh.value().node_count(), "a cell names a node that does not exist");
  for (const isochor::Vec3& x : mesh.value().nodes)
    fuzz::require(std::isfinite(x.x + x.y + x.z), "a coordinate is no finite number");
  (void)isochor::check_mesh(mesh.value());
  return 0;
}
