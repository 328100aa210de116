#include "scenes/body_parts.h"
#include "scenes/effects/kind.h"
#include "scenes/run/step_measures.h"
#include "scenes/schedule.h"

namespace isochor {

namespace {

Result<void> add_bodies(const SceneDef& scene, const BuildOptions& options, BuiltScene& built) {
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    auto made = make_body(scene.bodies[b], scene.folder, place("bodies", b));
    if (!made) return made.failure();
    built.surfaces.push_back(std::move(made.value().surface));
    built.parents.push_back(std::move(made.value().parent));
    if (options.parts) options.parts->bodies.push_back(made.value().def);
    auto id = built.world.add_body(std::move(made.value().def));
    if (!id) return id.failure();
    built.bodies.push_back(id.value());
  }
  return {};
}

Result<void> add_effects(const SceneDef& scene, const BuildOptions& options, BuiltScene& built) {
  EffectAdder adder(scene, [&](const EffectKind& kind, EffectPtr effect) -> Result<void> {
    if (options.parts) options.parts->effects.push_back(effect);
    auto id = built.world.add(effect);
    if (!id) return id.failure();
    std::vector<EffectId>& ids = built.effects[&kind];
    ids.push_back(id.value());
    if (scene.schedule.empty() || ids.size() > kind.size(scene)) return {};
    const std::string& name = kind.name(scene, ids.size() - 1);
    if (!is_scheduled(scene, name)) return {};
    built.scheduled.push_back(scheduled_effect(scene, name, std::move(effect)));
    built.scheduled.back().id = id.value();
    return {};
  });
  for (const EffectKind* kind : kinds_by_phase()) {
    if (auto r = kind->add(*kind, adder); !r) return r;
  }
  built.obstacles = std::move(adder.obstacles);
  built.rigid_shapes = std::move(adder.rigid_shapes);
  return {};
}

// What is watched of meshes: nodes that have a rotation, regions that there are.
Result<void> check_watched(const SceneDef& scene, const BuiltScene& built) {
  for (std::size_t i = 0; i < scene.orientations.size(); ++i) {
    if (const auto r = built.world.orientation(scene.orientations[i].where); !r)
      return Error{place("orientations", i) + ".where: " + r.error()};
  }
  for (std::size_t i = 0; i < scene.metrics.size(); ++i) {
    const MetricDef& m = scene.metrics[i];
    const bool of_part = m.quantity == Quantity::volume_change || m.quantity == Quantity::volume ||
                         m.quantity == Quantity::min_J || m.quantity == Quantity::max_J;
    if (!of_part || m.of.empty()) continue;
    std::string known;
    bool found = false;
    for (const VolumeMeasures& part : volume_parts(built)) {
      found = found || part.name == m.of;
      known += (known.empty() ? "\"" : ", \"") + part.name + "\"";
    }
    if (!found)
      return Error{place("metrics", i) + ".of = \"" + m.of + "\" names no body or region; there are " +
                   known};
  }
  return {};
}

// How bodies move at the start.
Result<void> set_motion(const SceneDef& scene, BuiltScene& built) {
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const Vec3 v = scene.bodies[b].velocity, w = scene.bodies[b].angular_velocity;
    if (v == Vec3{} && w == Vec3{}) continue;
    const Vec3 center = built.world.measures(built.bodies[b]).center_of_mass;
    std::vector<Vec3> all;
    for (const Vec3& x : built.world.rest_positions(built.bodies[b])) all.push_back(v + cross(w, x - center));
    if (auto r = built.world.set_velocities(built.bodies[b], all); !r) return r;
  }
  return {};
}

}  // namespace

Result<BuiltScene> build(const SceneDef& scene, const BuildOptions& options) {
  if (auto r = check_scene(scene); !r) return r.failure();
  WorldOptions world_options = scene.analysis.options;
  world_options.scheme = make_scheme(scene.analysis);
  world_options.threads = options.threads;
  Host host;
  host.ranks = options.ranks;
  auto world = World::create(std::move(world_options), std::move(host));
  if (!world) return world.failure();
  BuiltScene built{std::move(world).value()};
  if (auto r = add_bodies(scene, options, built); !r) return r.failure();
  if (auto r = add_effects(scene, options, built); !r) return r.failure();
  if (auto r = follow_schedule(built, 0.5 * plan_steps(scene.analysis).h); !r) return r.failure();
  if (auto r = built.world.compile(); !r) return r.failure();
  if (auto r = rehearse(scene, built); !r) return r.failure();
  if (auto r = check_watched(scene, built); !r) return r.failure();
  if (auto r = set_motion(scene, built); !r) return r.failure();
  return built;
}

}  // namespace isochor
