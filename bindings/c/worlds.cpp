// Worlds: made, freed, copied, saved.
#include <array>
#include <cmath>

#include "engine/step/time_scheme.h"
#include "handles.h"
#include "scenes/json/parse.h"

using namespace isochor;
using namespace isochor::c;

namespace {

// Members of iso_options go into the keys that say the same.
class Keys {
 public:
  explicit Keys(const char* text)
      : json_(
            need(scene_json::parse_object(text == nullptr ? "{}" : text, "options", "what describes them"))) {
  }

  void refuse_both(const char* member, const char* key) const {
    if (json_.contains(key))
      refuse("options->" + std::string(member) + " is given and so is the key \"" + key +
             "\"; give one of them");
  }
  template <class T>
  void put(const char* member, const char* key, const T& value) {
    refuse_both(member, key);
    json_[key] = value;
  }
  std::string text() const { return json_.dump(); }

 private:
  scene_json::Json json_;
};

void put_scheme(std::int32_t scheme, Keys& keys) {
  static constexpr const char* words[] = {"implicit_euler", "bdf2", "generalized_alpha", "newmark",
                                          "implicit_midpoint"};
  if (scheme < ISO_SCHEME_BY_KEYS || scheme > ISO_IMPLICIT_MIDPOINT)
    refuse("options->scheme = " + std::to_string(scheme) +
           " is none; take ISO_STATICS or one of those below it");
  if (scheme == ISO_SCHEME_BY_KEYS) return;
  const bool still = scheme == ISO_STATICS || scheme == ISO_CONTINUATION;
  for (const char* key : {"scheme", "follow"}) keys.refuse_both("scheme", key);
  keys.put("scheme", "type", still ? "static" : "dynamic");
  if (!still) keys.put("scheme", "scheme", words[scheme - ISO_IMPLICIT_EULER]);
  if (scheme == ISO_CONTINUATION) keys.put("scheme", "follow", true);
}

WorldOptions options_of(const iso_options& o, Keyring& ring) {
  Keys keys(o.keys);
  put_scheme(o.scheme, keys);
  if (o.threads != 0) keys.put("threads", "threads", o.threads);
  const Vec3 g = vector(o.gravity, "options->gravity");
  if (!(g == Vec3{})) {
    if (!std::isfinite(dot(g, g))) refuse("options->gravity has a number that is not finite");
    keys.put("gravity", "gravity", std::array<double, 3>{g.x, g.y, g.z});
  }
  WorldOptions options = need(options_from_keys(keys.text()));
  ring.analysis = options.scheme->has_inertia() ? AnalysisType::dynamics : AnalysisType::statics;
  if (o.log != nullptr) {
    options.log = [log = o.log, user = o.log_user](const std::string& line) { log(user, line.c_str()); };
  }
  ring.gravity = options.gravity;
  ring.gravity_curve = options.gravity_curve;
  ring.folder = text_or_none(o.folder);
  return options;
}

}  // namespace

extern "C" iso_status iso_world_create(const iso_options* options, iso_world** out, char* message,
                                       size_t message_size) {
  Buffer said(message, message_size);
  return caught("iso_world_create", said, [&] {
    (void)given(out, "out");
    iso_options defaults{};
    defaults.size = sizeof defaults;
    Keyring keys;
    WorldOptions made = options_of(options == nullptr ? defaults : taken(options, "options"), keys);
    *out = new iso_world(need(World::create(std::move(made))), std::move(keys));
  });
}

extern "C" iso_status iso_world_free(iso_world* world) {
  if (world == nullptr) return ISO_OK;
  const iso_status status = enter(world, "iso_world_free", [&] {
    if (!world->own) refuse("the world belongs to a batch and ends with it; free the batch");
  });
  if (status != ISO_OK) return status;
  world->kind = Kind{};
  delete world;
  return ISO_OK;
}

extern "C" const char* iso_last_error(const iso_world* world) {
  if (world == nullptr) return kNoWorld;
  return good(world) ? world->said.get() : kNotAWorld;
}

extern "C" iso_status iso_world_clone(iso_world* world, int32_t threads, iso_world** out) {
  return enter(world, "iso_world_clone", [&] {
    (void)given(out, "out");
    if (threads < 0)
      refuse("threads = " + std::to_string(threads) +
             "; it must be positive, or 0 for as many as the world has");
    *out = new iso_world(need(world->world->clone(threads)), world->keys);
  });
}

extern "C" iso_status iso_reset(iso_world* world) {
  return enter(world, "iso_reset", [&] { need(world->world->reset()); });
}

extern "C" iso_status iso_save(iso_world* world, const void** bytes, size_t* count) {
  return enter(world, "iso_save", [&] {
    (void)given(bytes, "bytes");
    (void)given(count, "count");
    need(world->world->compile());
    world->answers.saved = world->world->save();
    *bytes = world->answers.saved.data();
    *count = world->answers.saved.size();
  });
}

extern "C" iso_status iso_load(iso_world* world, const void* bytes, size_t count) {
  return enter(world, "iso_load", [&] {
    if (count > 0) (void)given(static_cast<const std::byte*>(bytes), "bytes");
    need(world->world->load({static_cast<const std::byte*>(bytes), count}));
  });
}

extern "C" iso_status iso_state_hash(iso_world* world, uint64_t* out) {
  return enter(world, "iso_state_hash", [&] {
    (void)given(out, "out");
    need(world->world->compile());
    *out = world->world->state_hash();
  });
}
