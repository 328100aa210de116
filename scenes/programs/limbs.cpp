// Limbs that bones drive.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "scenes/programs/parts.h"

namespace isochor {

using namespace programs;

// Two flat bones in the middle of a limb along x meet at x = 0 and share the nodes around the joint; the
// second one turns about y by a right angle.
SceneDef elbow(const SceneVariant& variant) {
  SceneDef s;
  s.name = "elbow";
  s.title = "Elbow";
  s.description =
      "A limb of 80 x 20 x 20 cm about two bones that share the flesh around their joint, by weights; the "
      "lower one "
      "turns by a right angle.";
  s.folder = scenes_folder();
  SceneBody limb;
  limb.name = "limb";
  BoxMeshDef box;
  box.lower = {-0.4, -0.1, -0.1};
  box.upper = {0.4, 0.1, 0.1};
  box.divisions = {16, 4, 4};
  limb.element = variant.element.value_or(Element::hex8);
  box.cell_type = limb.element == Element::hex8    ? CellType::hex8
                  : limb.element == Element::tet10 ? CellType::tet10
                                                   : CellType::tet4;
  limb.mesh = box;
  MaterialDef flesh = rubber(1e5, 0.5);
  flesh.law = MaterialLaw::stable_neo_hookean;
  limb.materials = {flesh};
  s.bodies = {limb};
  s.analysis.steps = 4;
  SkinDef skin;
  skin.name = "bones";
  skin.where.boxes = {{Vec3{-1, -0.06, -0.03}, Vec3{1, 0.06, 0.03}}};
  skin.bones.resize(2);
  if (const auto mesh = box_mesh(box)) {
    for (const Vec3& X : mesh.value().nodes) {
      // Eighths, so that the scene file says the same.
      const double share = std::round(8 * std::clamp(0.5 + X.x / 0.2, 0.0, 1.0)) / 8;
      skin.bones[0].weights.push_back(1 - share);
      skin.bones[1].weights.push_back(share);
    }
  }
  const double half = 0.25 * std::numbers::pi;
  skin.bones[0].track.keys = {{0, {}, {1, 0, 0, 0}}};
  skin.bones[1].track.keys = {{0, {}, {1, 0, 0, 0}}, {1, {}, {std::cos(half), 0, std::sin(half), 0}}};
  s.skins = {skin};
  s.probes = {{"hand", {}, {0.4, 0, 0}}, {"crook", {}, {0, 0, -0.1}}};
  const char* given = "where its bone is";
  MetricDef volume, least;
  volume.name = "volume kept";
  volume.quantity = Quantity::volume_change;
  least.name = "least J";
  least.quantity = Quantity::min_J;
  s.metrics = {against(displacement("hand along", "hand", Component::x), -0.4, 1e-9, given),
               against(displacement("hand down", "hand", Component::z), -0.4, 1e-9, given),
               against(volume, 0, 1e-9, "nu = 0.5"), least};
  return s;
}

}  // namespace isochor
