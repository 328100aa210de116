// Effects that begin and end while a scene runs: each has a place in the world all the time, where nothing is
// while it is not there (World::replace).
#pragma once

#include "scenes/scene.h"

namespace isochor {

bool is_scheduled(const SceneDef& scene, const std::string& name);
// With its times, and without an id.
ScheduledEffect scheduled_effect(const SceneDef& scene, const std::string& name, EffectPtr effect);
// Whether all of a built scene's changes can be made; lists the gauges that there are at any time.
Result<void> rehearse(const SceneDef& scene, BuiltScene& built);
// Refuses a schedule where nobody would follow it.
Result<void> no_schedule(const SceneDef& scene, const std::string& who);

}  // namespace isochor
