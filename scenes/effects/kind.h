// What the rest of scenes/ knows of an effect: an entry of the table in list.h.
#pragma once

#include <functional>
#include <type_traits>

#include "scenes/check_values.h"
#include "scenes/explain.h"
#include "scenes/keys/keys.h"
#include "scenes/obstacle_files.h"

namespace isochor {

// When the effects of a scene are added. A later one sees the rows and supports of earlier ones; within a
// phase they come in the order of the table.
enum class EffectPhase : std::uint8_t {
  volume_rows,
  supports,  // before the chambers, whose caps they hold
  loads,
  chambers,
  valves,  // between chambers that are there
  lines,
  ties,
  contact,  // after all supports: what they hold wholly has no contact
};

// Where the effects of a scene go when they are made: into a world, or to whom asks for one.
class EffectAdder {
 public:
  using Add = std::function<Result<void>(const EffectKind&, EffectPtr)>;
  EffectAdder(const SceneDef& scene, Add add) : scene_(scene), add_(std::move(add)), solids_(scene.folder) {}

  const SceneDef& scene() const { return scene_; }
  SolidFiles& solids() { return solids_; }  // each file is read once
  Result<void> add(const EffectKind& kind, EffectPtr effect) { return add_(kind, std::move(effect)); }

  // By contact and by rigid body, with what their files hold.
  std::vector<Obstacle> obstacles, rigid_shapes;

 private:
  const SceneDef& scene_;
  Add add_;
  SolidFiles solids_;
};

struct EffectKind {
  const char* key;      // of the list in a scene file
  const char* meaning;  // of the list, where there is more to say than its entries do
  const char* word;     // before a name, in --explain
  EffectPhase phase;
  std::size_t (*size)(const SceneDef&);
  const std::string& (*name)(const SceneDef&, std::size_t);
  void (*keys)(const EffectKind&, keys::Visitor&, SceneDef&);
  Result<void> (*check)(const EffectKind&, const SceneDef&);  // without a look at meshes
  Result<void> (*add)(const EffectKind&, EffectAdder&);
  void (*explain)(const EffectKind&, const SceneDef&, std::vector<EffectNote>&);
};

// In the order in which they are added.
std::vector<const EffectKind*> kinds_by_phase();

namespace effect_lists {

template <auto list>
std::size_t size(const SceneDef& s) {
  return (s.*list).size();
}
template <auto list>
const std::string& name(const SceneDef& s, std::size_t i) {
  return (s.*list)[i].name;
}
template <auto list>
void keys(const EffectKind& kind, isochor::keys::Visitor& io, SceneDef& s) {
  io.list({kind.key, "", kind.meaning}, s.*list);
}
template <auto list>
Result<void> check(const EffectKind& kind, const SceneDef& s) {
  for (std::size_t i = 0; i < (s.*list).size(); ++i) {
    const auto& def = (s.*list)[i];
    if constexpr (requires { def.amount; }) {
      if (auto r = check_curve(place(kind.key, i) + ".amount", def.amount); !r) return r;
    }
  }
  return {};
}
template <auto list, auto make>
Result<void> add(const EffectKind& kind, EffectAdder& adder) {
  const auto& all = adder.scene().*list;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if constexpr (std::is_invocable_v<decltype(make), decltype(all[i])>) {
      if (auto r = adder.add(kind, make(all[i])); !r) return r;
    } else {
      Result<EffectPtr> effect = make(all[i], place(kind.key, i), adder);
      if (!effect) return effect.failure();
      if (auto r = adder.add(kind, effect.value()); !r) return r;
    }
  }
  return {};
}
template <auto list>
void explain(const EffectKind& kind, const SceneDef& s, std::vector<EffectNote>& notes) {
  for (const auto& def : s.*list)
    notes.push_back({std::string(kind.word) + " \"" + def.name + "\"", "of the scene"});
}

}  // namespace effect_lists

// An effect with a list of its own in SceneEffects, whose entries have names. `make` is the function of
// <isochor/effects.h>, or one that reads files first: Result<EffectPtr>(def, place, EffectAdder&).
template <auto list, auto make>
constexpr EffectKind effect_kind(const char* key, const char* word, EffectPhase phase,
                                 const char* meaning = "") {
  namespace l = effect_lists;
  return {key,
          meaning,
          word,
          phase,
          l::size<list>,
          l::name<list>,
          l::keys<list>,
          l::check<list>,
          l::add<list, make>,
          l::explain<list>};
}

}  // namespace isochor
