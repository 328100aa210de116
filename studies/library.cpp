#include <algorithm>
#include <array>

#include "studies/study.h"

namespace isochor::studies {

std::span<const Study> studies() {
  static const std::array all{accuracy_study(), locking_study(),       solvers_study(),    timesteps_study(),
                              effects_study(),  scaling_study(),       stability_study(),  zones_study(),
                              pressure_study(), stabilization_study(), references_study(), papers_study()};
  return all;
}

const Study* find_study(std::string_view name) {
  const auto all = studies();
  const auto it = std::find_if(all.begin(), all.end(), [&](const Study& s) { return s.name == name; });
  return it == all.end() ? nullptr : &*it;
}

}  // namespace isochor::studies
