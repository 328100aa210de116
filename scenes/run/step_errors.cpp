#include "scenes/run/step_errors.h"

#include <algorithm>
#include <cmath>

namespace isochor {

bool steps_matter(const SceneDef& scene) {
  if (scene.analysis.type == AnalysisType::dynamics) return true;
  if (scene.analysis.path_step) return false;
  const auto rubs = [](const auto& contact) { return contact.friction > 0; };
  if (std::any_of(scene.contacts.begin(), scene.contacts.end(), rubs) ||
      std::any_of(scene.surface_contacts.begin(), scene.surface_contacts.end(), rubs))
    return true;
  for (const SceneBody& body : scene.bodies) {
    for (const MaterialDef& m : body.materials) {
      if (m.mullins || (!m.prony.empty() && m.static_time == StaticTime::seconds)) return true;
    }
  }
  return false;
}

Evidence StepErrors::evidence(int halved) const {
  const std::size_t n = runs_.size(), k = static_cast<std::size_t>(halved);
  const Evidence last = n >= 3 ? from_three_meshes(runs_[n - 3], runs_[n - 2], runs_[n - 1])
                               : from_two_meshes(runs_[n - 2], runs_[n - 1]);
  return k + 1 == n ? last : together(from_two_meshes(runs_[k], runs_[n - 1]), last);
}

std::optional<int> StepErrors::within(double error) const {
  for (int k = 0; runs() > 1 && k < runs(); ++k) {
    if (evidence(k).largest <= error) return k;
  }
  return {};
}

int StepErrors::missing(double error) const {
  if (runs() < 2) return 1;
  const double left = evidence(runs() - 1).largest;
  return std::isfinite(left) ? std::max(1, static_cast<int>(std::ceil(std::log2(left / error)))) : 1;
}

Evidence from_interplay(std::span<const Answer> mesh, std::span<const Answer> steps_before,
                        std::span<const Answer> steps_after, std::span<const Answer> both) {
  std::vector<Answer> expected;
  for (const Answer& a : mesh) {
    for (const Answer& before : steps_before) {
      for (const Answer& after : steps_after) {
        if (before.name != a.name || after.name != a.name) continue;
        expected.push_back(a);
        expected.back().value += after.value - before.value;
      }
    }
  }
  return from_two_meshes(expected, both);
}

}  // namespace isochor
