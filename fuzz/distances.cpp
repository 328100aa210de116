// Grids of distances: the first byte chooses the extension, the rest is the file.
#include "fuzz/input.h"
#include "isochor/solids.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static fuzz::File files[] = {fuzz::File(".vtk"), fuzz::File(".sdf")};
  if (size == 0) return 0;
  const auto grid = isochor::read_distances(files[data[0] % 2].write(data + 1, size - 1));
  if (!grid) {
    fuzz::require_message(grid.error());
    return 0;
  }
  const auto& g = grid.value();
  const double points = static_cast<double>(g.count[0]) * g.count[1] * g.count[2];
  fuzz::require(static_cast<double>(g.values.size()) == points, "a grid has not as many values as points");
  if (points > 4000) return 0;
  const auto solid = isochor::field_solid(g);
  if (!solid) fuzz::require_message(solid.error());
  return 0;
}
