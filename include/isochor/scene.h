// Scene files in a host: the same scenes as the command line runs, with the same bits. Target isochor::scene.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "isochor/world.h"

namespace isochor {

// The world of a scene, and what its file calls things.
struct SceneWorld {
  World world;
  std::vector<std::pair<std::string, BodyId>> bodies;     // in the order of the file
  std::vector<std::pair<std::string, EffectId>> effects;  // in the order in which they were added
  struct Probe {
    std::string name;
    BodyId body{};
    std::vector<std::pair<Index, double>> nodes;  // of the body's mesh, with their weights
  };
  std::vector<Probe> probes;

  // Refused where there is none of the name; the sentence lists those that there are.
  Result<BodyId> body(const std::string& name) const;
  Result<EffectId> effect(const std::string& name) const;
  Result<Vec3> probe(const std::string& name) const;  // where it is now [m]
};

// A scene as a file has it. Cheap to copy; nothing changes it.
class Scene {
 public:
  const std::string& name() const;
  // The text of its file.
  std::string to_json() const;
  // Steps of its analysis, and the length of one [s]; statics: of load factor. `isochor run` calls
  // World::advance() with it so many times, and World::follow() where the file asks for a path.
  int steps() const;
  double step_length() const;
  std::optional<double> path_step() const;  // length of a step of World::follow() [m]
  // Reads the meshes, makes materials and effects, compiles. `threads` 0: all the machine has.
  Result<SceneWorld> world(int threads = 0) const;

 private:
  friend struct SceneMaker;
  struct Data;
  explicit Scene(std::shared_ptr<const Data> data);
  std::shared_ptr<const Data> data_;
};

// `changes` are those of --set: "bodies[0].materials[0].young=2e5". Errors name the place in the file, the
// value and the remedy.
Result<Scene> read_scene(const std::string& path, const std::vector<std::string>& changes = {});
// The same from text; relative paths start in `folder`.
Result<Scene> scene_from_text(const std::string& text, const std::string& folder,
                              const std::vector<std::string>& changes = {});
// A scene of the library, such as "finger".
Result<Scene> library_scene(const std::string& name, const std::vector<std::string>& changes = {});

}  // namespace isochor
