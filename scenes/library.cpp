#include "scenes/library.h"

#include <algorithm>
#include <array>
#include <cstdlib>

namespace isochor {

namespace {

constexpr auto kScenes = std::to_array<LibraryScene>({
    {"finger", "Bending finger with bellows and a limiting layer, 10 kPa", finger},
    {"tube", "Inflated tube, ends held, 10 kPa", tube},
    {"cushion", "Cushion, 10 kPa", cushion},
    {"bubble", "Thin dome, 4 kPa", bubble},
    {"spine", "Spine arm under its own weight", spine},
    {"cantilever", "Cantilever under gravity, whole load in one step", cantilever},
    {"cantilever_tenth", "Cantilever under a tenth of gravity, where bending decides", cantilever_tenth},
    {"cook", "Cook's membrane in 3D", cook},
    {"cook_plane", "Cook's membrane in plane strain", cook_plane},
    {"thick_tube", "Thick tube in plane strain, pressure given", thick_tube},
    {"thick_tube_volume", "Thick tube in plane strain, volume given", thick_tube_volume},
    {"thick_sphere", "Thick sphere, pressure given", thick_sphere},
    {"thick_sphere_volume", "Thick sphere through its limit point, volume given", thick_sphere_volume},
    {"torsion", "Solid cylinder, one end turned", torsion},
    {"cable_finger", "Slender arm bent by a cable that is shortened by a tenth", cable_finger},
    {"gas_tube", "Closed tube into which air flows, isothermal", gas_tube},
    {"finger_lattice", "Finger in a lattice of cubes, hanging", finger_lattice},
    {"two_chambers", "Two domes whose air equalizes when a valve opens", two_chambers},
    {"puck", "Puck of one hard zone, pressed in by half of its height", puck},
    {"puck_skin", "The same with an epidermis", puck_skin},
    {"painted_arm", "Arm whose painted muscles keep their volumes, with skin, pressed in", painted_arm},
    {"ball_drop", "Incompressible ball dropped on the floor", ball_drop},
    {"incline", "Block that slides down a slope with friction", incline},
    {"squeezed_block", "Block pressed between cylinders and released", squeezed_block},
    {"gripper", "Three pneumatic fingers lift a rigid ball and hold it by friction", gripper},
    {"indented_puck", "Incompressible puck indented by a sphere", indented_puck},
    {"bellows", "Bellows that folds onto itself as air is drawn out", bellows},
    {"colliding_balls", "Two incompressible balls that collide off center", colliding_balls},
    {"thin_strip", "Thin strip bent by a force at its end", thin_strip},
    {"paper_strip", "Soft strip that swells on a sheet of paper and curls", paper_strip},
    {"elbow", "Limb about two bones that bends by a right angle", elbow},
});

}  // namespace

std::span<const LibraryScene> scene_library() {
  return kScenes;
}

const LibraryScene* find_scene(std::string_view name) {
  const auto it = std::find_if(kScenes.begin(), kScenes.end(), [&](const auto& s) { return s.name == name; });
  return it == kScenes.end() ? nullptr : &*it;
}

std::string scenes_folder() {
  const char* set = std::getenv("ISOCHOR_SCENES");
  return set && *set ? set : ISOCHOR_SCENES_FOLDER;
}

}  // namespace isochor
