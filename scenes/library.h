// The scenes that come with Isochor.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "scenes/scene.h"

namespace isochor {

// What studies vary. Level 0 is the scene's own mesh; others name a mesh of scenes/meshes by its suffix.
struct SceneVariant {
  std::string mesh;  // file under scenes/meshes without .msh; empty: the scene's own
  std::optional<Element> element;
};

struct LibraryScene {
  std::string_view name, title;
  SceneDef (*make)(const SceneVariant&);
};

std::span<const LibraryScene> scene_library();
const LibraryScene* find_scene(std::string_view name);

// Where meshes of the library are: the source tree, or $ISOCHOR_SCENES.
std::string scenes_folder();

// One program each, in scenes/programs.
SceneDef tube(const SceneVariant& variant = {});
SceneDef cushion(const SceneVariant& variant = {});
SceneDef bubble(const SceneVariant& variant = {});
SceneDef finger(const SceneVariant& variant = {});
SceneDef finger_lattice(const SceneVariant& variant = {});
SceneDef spine(const SceneVariant& variant = {});
SceneDef cantilever(const SceneVariant& variant = {});
SceneDef cantilever_tenth(const SceneVariant& variant = {});
SceneDef cook(const SceneVariant& variant = {});
SceneDef cook_plane(const SceneVariant& variant = {});
SceneDef thick_tube(const SceneVariant& variant = {});
SceneDef thick_tube_volume(const SceneVariant& variant = {});
SceneDef thick_sphere(const SceneVariant& variant = {});
SceneDef thick_sphere_volume(const SceneVariant& variant = {});
SceneDef torsion(const SceneVariant& variant = {});
SceneDef cable_finger(const SceneVariant& variant = {});
SceneDef gas_tube(const SceneVariant& variant = {});
SceneDef two_chambers(const SceneVariant& variant = {});
SceneDef puck(const SceneVariant& variant = {});
SceneDef puck_skin(const SceneVariant& variant = {});
SceneDef painted_arm(const SceneVariant& variant = {});
SceneDef ball_drop(const SceneVariant& variant = {});
SceneDef incline(const SceneVariant& variant = {});
SceneDef squeezed_block(const SceneVariant& variant = {});
SceneDef gripper(const SceneVariant& variant = {});
SceneDef indented_puck(const SceneVariant& variant = {});
SceneDef bellows(const SceneVariant& variant = {});
SceneDef colliding_balls(const SceneVariant& variant = {});
SceneDef thin_strip(const SceneVariant& variant = {});
SceneDef paper_strip(const SceneVariant& variant = {});
SceneDef elbow(const SceneVariant& variant = {});

}  // namespace isochor
