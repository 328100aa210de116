// Names of what a world holds, as World hands them out.
#pragma once

#include <compare>
#include <cstdint>
#include <type_traits>

#include "isochor/types.h"

namespace isochor {

struct WorldNumbers;  // engine-side: hands ids out and looks them up

// Says which body (or effect) of which world. Made by World::add_body and World::add; that of another world,
// or of something that is no longer there, is refused with a sentence that says so. Scenes that are written
// down before there is a world say "the second body" by number: BodyId{1}. One that says nothing, BodyId{},
// is refused by the calls of a world with several bodies; in a definition it stands for the first body.
template <class What>
class Id {
 public:
  constexpr Id() = default;
  // The n-th that a world is given, from 0, whatever the world.
  template <class T>
  requires std::is_integral_v<T>
  constexpr explicit Id(T number) : number_(static_cast<Index>(number)), generation_(kByNumber) {}

  constexpr Index number() const { return number_; }
  template <class T>
  requires std::is_integral_v<T>
  constexpr explicit operator T() const { return static_cast<T>(number_); }
  // In the order in which a world was given them; whose they are does not count.
  friend constexpr bool operator==(const Id& a, const Id& b) { return a.number_ == b.number_; }
  friend constexpr std::strong_ordering operator<=>(const Id& a, const Id& b) {
    return a.number_ <=> b.number_;
  }

 private:
  friend struct WorldNumbers;
  static constexpr std::uint32_t kByNumber = ~std::uint32_t{0};

  Index number_ = 0;
  std::uint32_t generation_ = 0;  // 0: says nothing; else how often the place was given away
  std::uint64_t world_ = 0;       // 0: of whatever world
};

using BodyId = Id<struct BodyTag>;
using EffectId = Id<struct EffectTag>;

}  // namespace isochor
