// Scenes: files and those of the library, and worlds of them.
#include <filesystem>

#include "handles.h"
#include "scenes/library.h"
#include "scenes/scene_file.h"
#include "scenes/schedule.h"

using namespace isochor;
using namespace isochor::c;

namespace {

SceneDef open(const std::string& name, const Overrides& overrides) {
  std::error_code code;
  if (std::filesystem::exists(name, code)) return need(read_scene_file(name, overrides));
  const LibraryScene* known = find_scene(name);
  if (known == nullptr) {
    std::string all;
    for (const LibraryScene& scene : scene_library())
      all += (all.empty() ? "" : ", ") + std::string(scene.name);
    refuse("there is no file " + name + ", and no scene of that name in the library, which has " + all);
  }
  return need(override_scene(known->make({}), overrides));
}

// Calls that take a scene have no place for a sentence but their status: null pointers are all there is to
// refuse.
template <class F>
iso_status ask(const iso_scene* scene, const F& f) {
  if (!good(scene)) return ISO_REFUSED;
  Buffer nobody(nullptr, 0);
  return caught("", nobody, f);
}

}  // namespace

extern "C" iso_status iso_scene_open(const char* path_or_name, const char* const* overrides, size_t count,
                                     iso_scene** out, char* message, size_t message_size) {
  Buffer said(message, message_size);
  return caught("iso_scene_open", said, [&] {
    (void)given(out, "out");
    auto made = std::make_unique<iso_scene>();
    made->scene = open(text(path_or_name, "path_or_name"), texts(overrides, count, "overrides"));
    made->json = to_json(made->scene);
    *out = made.release();
  });
}

extern "C" void iso_scene_free(iso_scene* scene) {
  if (!good(scene)) return;
  scene->kind = Kind{};
  delete scene;
}

extern "C" iso_status iso_scene_name(const iso_scene* scene, const char** out) {
  return ask(scene, [&] { given(out, "out") = scene->scene.name.c_str(); });
}

extern "C" iso_status iso_scene_json(const iso_scene* scene, const char** out) {
  return ask(scene, [&] { given(out, "out") = scene->json.c_str(); });
}

extern "C" iso_status iso_scene_plan(const iso_scene* scene, int32_t* steps, double* h, double* path_step) {
  return ask(scene, [&] {
    const StepPlan plan = plan_steps(scene->scene.analysis);
    if (steps != nullptr) *steps = plan.steps;
    if (h != nullptr) *h = plan.h;
    if (path_step != nullptr) *path_step = scene->scene.analysis.path_step.value_or(0);
  });
}

extern "C" iso_status iso_scene_world(const iso_scene* scene, int32_t threads, iso_world** out, char* message,
                                      size_t message_size) {
  Buffer said(message, message_size);
  return caught("iso_scene_world", said, [&] {
    (void)given(out, "out");
    if (!good(scene)) refuse("the scene is none that iso_scene_open() made");
    if (threads < 0) refuse("threads = " + std::to_string(threads) + "; it must be positive, or 0 for all");
    if (auto r = no_schedule(scene->scene, "a world of a scene"); !r) refuse(r.error());
    BuiltScene built = need(build(scene->scene, {threads}));
    Keyring keys;
    for (std::size_t b = 0; b < built.bodies.size(); ++b)
      keys.bodies.emplace_back(scene->scene.bodies[b].name, built.bodies[b]);
    keys.analysis = scene->scene.analysis.type;
    keys.gravity = scene->scene.analysis.options.gravity;
    keys.gravity_curve = scene->scene.analysis.options.gravity_curve;
    keys.folder = scene->scene.folder;
    *out = new iso_world(std::move(built.world), std::move(keys));
  });
}
