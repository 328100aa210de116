// What there is, and where it is.
#include "handles.h"

using namespace isochor;
using namespace isochor::c;

namespace {

// A view of vectors. What waits to be compiled is compiled first, so that the view stays good.
iso_status view(iso_world* world, const char* call, iso_body body, const double** out, size_t* count,
                const auto& ask) {
  return enter(world, call, [&] {
    (void)given(out, "out");
    (void)given(count, "count");
    const BodyId id = body_of(*world->world, body);
    need(world->world->compile());
    const std::span<const Vec3> all = ask(*world->world, id);
    *out = all.empty() ? nullptr : &all.front().x;
    *count = all.size();
  });
}

template <class Handle, class Id>
void list(std::vector<Handle>& kept, const std::vector<Id>& all, const Handle** out, size_t* count) {
  (void)given(out, "out");
  (void)given(count, "count");
  kept.clear();
  for (const Id one : all) kept.push_back(handle(one));
  *out = kept.data();
  *count = kept.size();
}

}  // namespace

extern "C" iso_status iso_time(iso_world* world, double* out) {
  return enter(world, "iso_time", [&] { given(out, "out") = world->world->time(); });
}

extern "C" iso_status iso_positions(iso_world* world, iso_body body, const double** out, size_t* count) {
  return view(world, "iso_positions", body, out, count, [](World& w, BodyId b) { return w.positions(b); });
}

extern "C" iso_status iso_velocities(iso_world* world, iso_body body, const double** out, size_t* count) {
  return view(world, "iso_velocities", body, out, count, [](World& w, BodyId b) { return w.velocities(b); });
}

extern "C" iso_status iso_rest_positions(iso_world* world, iso_body body, const double** out, size_t* count) {
  return view(world, "iso_rest_positions", body, out, count,
              [](World& w, BodyId b) { return w.rest_positions(b); });
}

extern "C" iso_status iso_body_mesh(iso_world* world, iso_body body, const iso_mesh** out) {
  return enter(world, "iso_body_mesh", [&] {
    (void)given(out, "out");
    const BodyId id = body_of(*world->world, body);
    need(world->world->compile());
    world->answers.mesh.show(world->world->mesh(id));
    *out = &world->answers.mesh.mesh;
  });
}

extern "C" iso_status iso_bodies(iso_world* world, const iso_body** out, size_t* count) {
  return enter(world, "iso_bodies", [&] { list(world->answers.bodies, world->world->bodies(), out, count); });
}

extern "C" iso_status iso_effects(iso_world* world, const iso_effect** out, size_t* count) {
  return enter(world, "iso_effects",
               [&] { list(world->answers.effects, world->world->effects(), out, count); });
}

extern "C" iso_status iso_find_body(iso_world* world, const char* name, iso_body* out) {
  return enter(world, "iso_find_body", [&] {
    const std::string wanted = text(name, "name");
    (void)given(out, "out");
    std::string known;
    for (const auto& [one, id] : world->keys.bodies) {
      if (!world->world->check(id)) continue;
      if (one == wanted) {
        *out = handle(id);
        return;
      }
      known += (known.empty() ? "\"" : ", \"") + one + "\"";
    }
    refuse("there is no body \"" + wanted + "\"; there are " + (known.empty() ? "none" : known));
  });
}

extern "C" iso_status iso_find_effect(iso_world* world, const char* name, iso_effect* out) {
  return enter(world, "iso_find_effect", [&] {
    const std::string wanted = text(name, "name");
    (void)given(out, "out");
    std::string known;
    for (const EffectId id : world->world->effects()) {
      const std::string& one = world->world->effect_name(id);
      if (one == wanted) {
        *out = handle(id);
        return;
      }
      known += (known.empty() ? "\"" : ", \"") + one + "\"";
    }
    refuse("there is no effect \"" + wanted + "\"; there are " + (known.empty() ? "none" : known));
  });
}

extern "C" iso_status iso_body_name(iso_world* world, iso_body body, const char** out) {
  return enter(world, "iso_body_name", [&] {
    (void)given(out, "out");
    const BodyId id = body_of(*world->world, body);
    world->answers.name = world->world->body_name(id);
    *out = world->answers.name.c_str();
  });
}

extern "C" iso_status iso_effect_name(iso_world* world, iso_effect effect, const char** out) {
  return enter(world, "iso_effect_name", [&] {
    (void)given(out, "out");
    world->answers.name = world->world->effect_name(effect_of(*world->world, effect));
    *out = world->answers.name.c_str();
  });
}

extern "C" iso_status iso_check_body(iso_world* world, iso_body body) {
  return enter(world, "iso_check_body", [&] { (void)body_of(*world->world, body); });
}

extern "C" iso_status iso_check_effect(iso_world* world, iso_effect effect) {
  return enter(world, "iso_check_effect", [&] { (void)effect_of(*world->world, effect); });
}
