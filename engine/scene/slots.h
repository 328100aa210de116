// Numbered places for what a world holds. A place that became free is given away again, as one of the next
// generation, so that ids of what was there before are refused.
#pragma once

#include <vector>

#include "engine/base/base.h"

namespace isochor {

class Slots {
 public:
  // A free place, or a new one. Where memory runs out, here and in release(), all stays as it was.
  Index take() {
    if (free_.empty()) {
      taken_.reserve(taken_.size() + 1);
      generation_.push_back(1);
      taken_.push_back(1);
      return size() - 1;
    }
    const Index place = free_.back();
    free_.pop_back();
    ++generation_[at(place)];
    taken_[at(place)] = 1;
    return place;
  }
  void release(Index place) {
    free_.push_back(place);
    taken_[at(place)] = 0;
  }
  Index size() const { return static_cast<Index>(taken_.size()); }
  Index taken() const { return size() - static_cast<Index>(free_.size()); }
  bool holds(Index place) const { return place >= 0 && place < size() && taken_[at(place)] != 0; }
  std::uint32_t generation(Index place) const { return generation_[at(place)]; }
  // Whether the same things are in the same places.
  friend bool operator==(const Slots&, const Slots&) = default;

 private:
  std::vector<std::uint32_t> generation_;
  std::vector<std::uint8_t> taken_;
  std::vector<Index> free_;
};

}  // namespace isochor
