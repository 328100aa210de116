// Bodies and effects: added, replaced, removed.
#include <cstring>

#include "handles.h"
#include "isochor/effects.h"

using namespace isochor;
using namespace isochor::c;

namespace {

iso_body add(iso_world& w, BodyDef def) {
  const std::string name = def.name;
  for (const auto& [taken, id] : w.keys.bodies) {
    if (taken == name && w.world->check(id))
      refuse("there is a body \"" + name + "\" already; give each its own name");
  }
  w.keys.bodies.reserve(w.keys.bodies.size() + 1);
  const BodyId id = need(w.world->add_body(std::move(def)));
  w.keys.bodies.emplace_back(name, id);
  return handle(id);
}

iso_status add_effect(iso_world* world, const char* call, iso_effect* out, const auto& make) {
  return enter(world, call, [&] {
    (void)given(out, "out");
    *out = handle(need(world->world->add(make(*world->world))));
  });
}

std::string free_name(const World& world, const std::string& name) {
  const auto taken = [&](const std::string& one) {
    for (const EffectId e : world.effects()) {
      if (world.effect_name(e) == one) return true;
    }
    return false;
  };
  std::string free = name;
  for (int n = 2; taken(free); ++n) free = name + " " + std::to_string(n);
  return free;
}

}  // namespace

extern "C" iso_status iso_add_body(iso_world* world, const char* keys, const iso_mesh* mesh, iso_body* out) {
  return enter(world, "iso_add_body", [&] {
    (void)given(out, "out");
    const std::string said = text(keys, "keys");
    if (mesh == nullptr) {
      *out = add(*world, need(body_from_keys(said, world->keys.folder)));
    } else {
      const Mesh made = mesh_from(mesh);
      *out = add(*world, need(body_from_keys(said, world->keys.folder, &made)));
    }
  });
}

extern "C" iso_status iso_add_soft_body(iso_world* world, const char* name, const iso_mesh* mesh,
                                        double young, double poisson, double density, iso_body* out) {
  return enter(world, "iso_add_soft_body", [&] {
    (void)given(out, "out");
    ElasticConstants constants;
    constants.young = young;
    constants.poisson = poisson;
    BodyDef body;
    body.name = text(name, "name");
    body.mesh = mesh_from(mesh);
    body.materials = {{"", need(neo_hookean(constants)), density}};
    *out = add(*world, std::move(body));
  });
}

extern "C" iso_status iso_add(iso_world* world, const char* kind, const char* keys, iso_effect* out) {
  return add_effect(world, "iso_add", out, [&](World& w) {
    return need(effect_from_keys(text(kind, "kind"), text(keys, "keys"), world->keys.context(w)));
  });
}

extern "C" iso_status iso_add_volume(iso_world* world, iso_body body, iso_effect* out) {
  return add_effect(world, "iso_add_volume", out, [&](World& w) {
    VolumeDef def;
    def.body = body_of(w, body);
    def.name = free_name(w, def.name);
    return volume(def);
  });
}

extern "C" iso_status iso_add_support(iso_world* world, const char* name, iso_body body,
                                      const char* const* surfaces, size_t count, iso_effect* out) {
  return add_effect(world, "iso_add_support", out, [&](World& w) {
    DirichletDef def;
    def.name = text(name, "name");
    def.where.body = body_of(w, body);
    def.where.surfaces = texts(surfaces, count, "surfaces");
    return dirichlet(def);
  });
}

extern "C" iso_status iso_add_cavity(iso_world* world, const char* name, iso_body body,
                                     const char* const* surfaces, size_t count, iso_effect* out) {
  return add_effect(world, "iso_add_cavity", out, [&](World& w) {
    CavityDef def;
    def.name = text(name, "name");
    def.body = body_of(w, body);
    def.surfaces = texts(surfaces, count, "surfaces");
    return cavity(def);
  });
}

extern "C" iso_status iso_add_floor(iso_world* world, const char* name, iso_body body,
                                    const char* const* surfaces, size_t count, const double point[3],
                                    const double normal[3], double friction, iso_effect* out) {
  return add_effect(world, "iso_add_floor", out, [&](World& w) {
    ContactDef def;
    def.name = text(name, "name");
    def.body = body_of(w, body);
    def.surfaces = texts(surfaces, count, "surfaces");
    def.obstacle.shape = ObstacleShape::plane;
    def.obstacle.position = vector(point, "point");
    def.obstacle.axis = vector(normal, "normal");
    def.friction = friction;
    return contact(def);
  });
}

extern "C" iso_status iso_keys(char* out, size_t size, size_t* needed) {
  if (needed == nullptr || (out == nullptr && size > 0)) return ISO_REFUSED;
  Buffer nobody(nullptr, 0);
  return caught("iso_keys", nobody, [&] {
    const std::string all = "{\"effects\": " + effect_keys_json() + ", \"parts\": " + part_keys_json() + "}";
    *needed = all.size() + 1;
    if (size >= *needed) std::memcpy(out, all.c_str(), *needed);
  });
}

extern "C" iso_status iso_compile(iso_world* world, iso_compile_report* out) {
  return enter(world, "iso_compile", [&] {
    if (out != nullptr) check_size(out, "out");
    need(world->world->compile());
    if (out == nullptr) return;
    Filled<iso_compile_report> told(out, "out");
    const CompileReport& report = world->world->compile_report();
    told->work = static_cast<std::int32_t>(report.work);
    told->seconds = report.seconds;
    told.give();
  });
}

extern "C" iso_status iso_remove_body(iso_world* world, iso_body body) {
  return enter(world, "iso_remove_body", [&] { need(world->world->remove(body_of(*world->world, body))); });
}

extern "C" iso_status iso_remove_effect(iso_world* world, iso_effect effect) {
  return enter(world, "iso_remove_effect",
               [&] { need(world->world->remove(effect_of(*world->world, effect))); });
}

extern "C" iso_status iso_replace(iso_world* world, iso_effect effect, const char* kind, const char* keys) {
  return enter(world, "iso_replace", [&] {
    World& w = *world->world;
    const EffectId id = effect_of(w, effect);
    // Its own name is free for the one that takes its place, and what it has where the keys give none.
    PartContext context = world->keys.context(w);
    std::erase(context.names_taken, w.effect_name(id));
    need(w.replace(id, need(effect_from_keys(text(kind, "kind"), text(keys, "keys"), context))));
  });
}

extern "C" iso_status iso_set_material(iso_world* world, iso_body body, const char* region,
                                       const char* keys) {
  return enter(world, "iso_set_material", [&] {
    RegionMaterial made = need(material_from_keys(text(keys, "keys"), world->keys.folder));
    need(world->world->set_material(body_of(*world->world, body), text_or_none(region),
                                    std::move(made.material)));
  });
}

extern "C" iso_status iso_set_density(iso_world* world, iso_body body, const char* region, double density) {
  return enter(world, "iso_set_density", [&] {
    need(world->world->set_density(body_of(*world->world, body), text_or_none(region), density));
  });
}
