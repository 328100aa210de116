#include "scenes/obstacle_files.h"

#include "engine/base/text.h"
#include "scenes/body_parts.h"

namespace isochor {

namespace {

Result<SolidPtr> read_solid(const Obstacle& o, const std::string& path) {
  if (o.shape == ObstacleShape::mesh) {
    auto surface = read_surface(path, o.scale);
    if (!surface) return surface.failure();
    return mesh_solid(surface.value());
  }
  if (o.spacing > 0) {
    auto surface = read_surface(path, o.scale);
    if (!surface) return surface.failure();
    auto grid = sampled_distances(surface.value(), o.spacing);
    if (!grid) return grid.failure();
    return field_solid(grid.value());
  }
  auto grid = read_distances(path, o.scale);
  if (!grid) return Error{grid.error() + " (a surface needs a spacing)"};
  return field_solid(grid.value());
}

}  // namespace

Result<void> SolidFiles::load(Obstacle& o) {
  const bool solid = o.shape == ObstacleShape::mesh || o.shape == ObstacleShape::distance_field;
  if (!solid && !o.file.empty()) {
    return Error{"file = \"" + o.file + "\": only the shapes mesh and distance_field are read from files"};
  }
  if (!solid || o.file.empty() || o.solid) return {};
  if (!(o.spacing >= 0)) {
    return Error{"spacing = " + number(o.spacing) + " m; it must be positive, or 0 for a file of distances"};
  }
  SolidPtr& known = read_[{o.shape, o.file, o.scale, o.spacing}];
  if (!known) {
    const std::string path = path_in(folder_, o.file);
    auto made = read_solid(o, path);
    if (!made) {
      const bool named = made.error().find(path) != std::string::npos;
      return Error{(named ? "" : path + ": ") + made.error()};
    }
    known = std::move(made).value();
  }
  o.solid = known;
  return {};
}

}  // namespace isochor
