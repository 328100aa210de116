// Ids of bodies and effects: made and checked here alone.
#pragma once

#include <string>

#include "engine/scene/slots.h"
#include "isochor/ids.h"

namespace isochor {

struct WorldNumbers {
  // A number that no other world of this process has.
  static std::uint64_t next_world();

  template <class What>
  static Id<What> make(Index number, std::uint64_t world, std::uint32_t generation) {
    Id<What> id(number);
    id.generation_ = generation;
    id.world_ = world;
    return id;
  }

  // Where an id leads among the things of a world.
  enum class Found : std::uint8_t { here, unsaid, no_such_number, other_world, removed };
  template <class What>
  static Found look_up(const Id<What>& id, const Slots& places, std::uint64_t world) {
    if (id.generation_ == 0) return places.size() == 1 && places.holds(0) ? Found::here : Found::unsaid;
    if (id.world_ != 0 && id.world_ != world) return Found::other_world;
    if (id.number_ < 0 || id.number_ >= places.size()) return Found::no_such_number;
    if (!places.holds(id.number_)) return Found::removed;
    const bool same =
        id.generation_ == Id<What>::kByNumber || id.generation_ == places.generation(id.number_);
    return same ? Found::here : Found::removed;
  }
};

// The end of a sentence on an id that leads nowhere; `thing` is "body" or "effect".
std::string why_not(WorldNumbers::Found found, const std::string& thing, Index number, Index count);

}  // namespace isochor
