#include <algorithm>

#include "isochor/scene.h"
#include "scenes/effects/kind.h"
#include "scenes/library.h"
#include "scenes/probes.h"
#include "scenes/scene_file.h"
#include "scenes/schedule.h"

namespace isochor {

struct Scene::Data {
  SceneDef scene;
};

struct SceneMaker {
  static Result<Scene> make(Result<SceneDef> scene) {
    if (!scene) return scene.failure();
    return Scene(std::make_shared<const Scene::Data>(Scene::Data{std::move(scene).value()}));
  }
};

namespace {

template <class T>
Result<T> find(const std::vector<std::pair<std::string, T>>& all, const std::string& name, const char* what) {
  std::string known;
  for (const auto& [other, id] : all) {
    if (other == name) return id;
    known += (known.empty() ? "\"" : ", \"") + other + "\"";
  }
  return Error{std::string("scene: there is no ") + what + " \"" + name + "\"; it has " +
               (known.empty() ? "none" : known)};
}

}  // namespace

Scene::Scene(std::shared_ptr<const Data> data) : data_(std::move(data)) {}

const std::string& Scene::name() const {
  return data_->scene.name;
}
std::string Scene::to_json() const {
  return isochor::to_json(data_->scene);
}
int Scene::steps() const {
  return plan_steps(data_->scene.analysis).steps;
}
double Scene::step_length() const {
  return plan_steps(data_->scene.analysis).h;
}

std::optional<double> Scene::path_step() const {
  return data_->scene.analysis.path_step;
}

Result<SceneWorld> Scene::world(int threads) const {
  const SceneDef& scene = data_->scene;
  if (auto r = no_schedule(scene, "a world of a scene"); !r) return r.failure();
  BuildOptions options;
  options.threads = threads;
  auto made = build(scene, options);
  if (!made) return made.failure();
  BuiltScene built = std::move(made).value();
  SceneWorld out{std::move(built.world), {}, {}, {}};
  for (std::size_t b = 0; b < scene.bodies.size(); ++b)
    out.bodies.emplace_back(scene.bodies[b].name, built.bodies[b]);
  for (const EffectId id : out.world.effects()) out.effects.emplace_back(out.world.effect_name(id), id);
  for (const ProbeDef& probe : scene.probes) {
    const BodyId body = built.bodies[static_cast<std::size_t>(probe.body)];
    const MaterialPoint point = locate(out.world.mesh(body), probe.point);
    SceneWorld::Probe p{probe.name, body, {}};
    for (int k = 0; k < point.count; ++k)
      p.nodes.emplace_back(point.nodes[static_cast<std::size_t>(k)],
                           point.weights[static_cast<std::size_t>(k)]);
    out.probes.push_back(std::move(p));
  }
  return out;
}

Result<BodyId> SceneWorld::body(const std::string& name) const {
  return find(bodies, name, "body");
}
Result<EffectId> SceneWorld::effect(const std::string& name) const {
  return find(effects, name, "effect");
}
Result<Vec3> SceneWorld::probe(const std::string& name) const {
  std::vector<std::pair<std::string, std::size_t>> all;
  for (std::size_t p = 0; p < probes.size(); ++p) all.emplace_back(probes[p].name, p);
  const auto found = find(all, name, "probe");
  if (!found) return found.failure();
  const Probe& p = probes[found.value()];
  const auto x = world.positions(p.body);
  Vec3 sum{};
  for (const auto& [node, weight] : p.nodes) sum += weight * x[static_cast<std::size_t>(node)];
  return sum;
}

Result<Scene> read_scene(const std::string& path, const std::vector<std::string>& changes) {
  return SceneMaker::make(read_scene_file(path, changes));
}

Result<Scene> scene_from_text(const std::string& text, const std::string& folder,
                              const std::vector<std::string>& changes) {
  return SceneMaker::make(parse_scene(text, "scene", folder, changes));
}

Result<Scene> library_scene(const std::string& name, const std::vector<std::string>& changes) {
  const LibraryScene* known = find_scene(name);
  if (known) return SceneMaker::make(override_scene(known->make({}), changes));
  std::string all;
  for (const LibraryScene& scene : scene_library())
    all += (all.empty() ? "" : ", ") + std::string(scene.name);
  return Error{"scene: the library has no \"" + name + "\"; it has " + all};
}

}  // namespace isochor
