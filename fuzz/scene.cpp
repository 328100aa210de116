// Scene files: JSON, the scene in it, and the world that is built from it where it is small. Files that a
// scene names are looked for in the folder of the library's scenes.
#include <algorithm>

#include "fuzz/input.h"
#include "scenes/library.h"
#include "scenes/scene_file.h"

namespace {

using namespace isochor;

// Boxes of a few cells; meshes of files are those of the library, which are larger.
bool is_small(const SceneDef& scene) {
  double cells = 0;
  for (const SceneBody& body : scene.bodies) {
    const auto* box = std::get_if<BoxMeshDef>(&body.mesh);
    if (box == nullptr) return false;
    cells += 6.0 * std::max(0, box->divisions[0]) * std::max(0, box->divisions[1]) *
             std::max(0, box->divisions[2]);
  }
  return cells <= 300 && scene.bodies.size() <= 3;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  const auto scene = parse_scene(text, "input", scenes_folder() + "/files");
  if (!scene) {
    fuzz::require_message(scene.error());
    return 0;
  }
  // What was read can be written and read again, and is the same then.
  const std::string written = to_json(scene.value());
  const auto again = parse_scene(written, "written", scenes_folder() + "/files");
  fuzz::require(again.ok(), "a scene that was read and written is refused");
  fuzz::require(to_json(again.value()) == written, "a scene changes when it is written and read");
  if (!is_small(scene.value())) return 0;
  const auto built = build(scene.value(), {1});
  if (!built) fuzz::require_message(built.error());
  return 0;
}
