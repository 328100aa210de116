// Solids of obstacles from the files that a scene names.
#pragma once

#include <map>
#include <tuple>

#include "isochor/contact.h"

namespace isochor {

// Each file is read once, however many obstacles name it.
class SolidFiles {
 public:
  // `folder`: where relative paths start.
  explicit SolidFiles(std::string folder) : folder_(std::move(folder)) {}
  // Sets `solid` of a mesh or a distance field that has a file.
  Result<void> load(Obstacle& obstacle);

 private:
  std::string folder_;
  std::map<std::tuple<ObstacleShape, std::string, double, double>, SolidPtr> read_;
};

}  // namespace isochor
