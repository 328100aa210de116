// Triangle surfaces: the first byte chooses the extension, the rest is the file. What is read may become a
// solid.
#include "fuzz/input.h"
#include "isochor/solids.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static fuzz::File files[] = {fuzz::File(".obj"), fuzz::File(".stl")};
  if (size == 0) return 0;
  const auto surface = isochor::read_surface(files[data[0] % 2].write(data + 1, size - 1));
  if (!surface) {
    fuzz::require_message(surface.error());
    return 0;
  }
  const auto points = static_cast<isochor::Index>(surface.value().points.size());
  for (const isochor::Index p : surface.value().triangles)
    fuzz::require(p >= 0 && p < points, "a triangle names a point that does not exist");
  if (surface.value().triangles.size() > 3000) return 0;
  const auto solid = isochor::mesh_solid(surface.value());
  if (!solid) fuzz::require_message(solid.error());
  return 0;
}
