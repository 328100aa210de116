// An element and a mesh that a scene may be run with.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scenes/flat_faces.h"
#include "scenes/scene.h"

namespace isochor {

struct Setting {
  std::optional<Element> element;  // of all bodies whose cells leave a choice; empty: each has its own
  int refine = 0;                  // levels beyond what the scene has
  // Cells that are refined after that, by round and body, in the mesh of the round.
  std::vector<std::vector<std::vector<Index>>> rounds = {};
  int halved = 0;  // times that the steps are cut in two
  friend bool operator==(const Setting&, const Setting&) = default;
};

// "edge-smoothed Tet4, mesh refined once"
std::string describe(const Setting& setting);
std::string element_text(const std::optional<Element>& element);

// What settings of a scene can differ in.
struct SettingChoices {
  std::vector<bool> linear_tets;  // by body: its mesh has Tet4 cells, which leave a choice
  std::vector<Index> cells;       // by body, as the scene is
  std::vector<std::optional<Element>>
      elements;               // from the cheapest to the best; one without value: no choice
  int most_levels = 0;        // before a body cannot be refined further
  bool can_local = true;      // cells can be refined by themselves
  bool steps_matter = false;  // steps of another length have another answer
  FlatFaces faces;            // of the body whose flat faces cut off most
  std::string faces_of;
};
// Reads the meshes. An error names the body that cannot be refined.
Result<SettingChoices> setting_choices(const SceneDef& scene);

SceneDef with_setting(const SceneDef& scene, const SettingChoices& choices, const Setting& setting);
// What gives the same scene: "--set bodies[0].element=tet10 --set bodies[0].refine=1". Lists of cells are
// named by the files that write_rounds() makes in a folder; without one they are left out.
std::string overrides_for(const SceneDef& scene, const SettingChoices& choices, const Setting& setting,
                          const std::string& folder);
Result<void> write_rounds(const Setting& setting, const std::string& folder);

}  // namespace isochor
