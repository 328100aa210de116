// Who has what of a state: nodes of bodies and effects, rows, and the numbers that pools keep. By it the
// state of a scene becomes that of the scene after a change.
#pragma once

#include "engine/step/state_layout.h"
#include "engine/step/time_scheme.h"
#include "engine/world/description.h"

namespace isochor {

// Consecutive numbers of a list.
struct Stretch {
  std::size_t first = 0, count = 0;
};

struct Inventory {
  struct Of {
    bool present = false;
    std::uint32_t generation = 0;
    std::vector<Stretch> nodes, rows, memory;
  };
  std::vector<Of> bodies, effects;  // by place; bodies have nodes alone
  std::size_t rows = 0;             // of the whole scene
};

Inventory take_inventory(const Description& said, const SystemParts& parts, const SystemFacets& facets);

// Where the numbers of a state go when a scene changes: what is there before and after, and of one size,
// keeps its numbers, bit for bit.
class Moving {
 public:
  Moving(const Inventory& before, const Inventory& after);

  // `rest`: positions of the nodes after the change, `memory` what its pools begin with, `layout` and
  // `scheme` what else the extra numbers are.
  struct After {
    std::span<const Vec3> rest;
    std::span<const double> memory;
    StateLayout layout;
    const TimeScheme& scheme;
  };
  State moved(const State& state, const StateLayout& layout, const After& after) const;

 private:
  struct Way {
    std::size_t from = 0, to = 0, count = 0;
  };
  static void match(const std::vector<Stretch>& from, const std::vector<Stretch>& to, std::vector<Way>& ways);
  template <class T>
  static void carry(const std::vector<Way>& ways, std::span<const T> from, std::span<T> to);
  void carry_scheme(const State& before, std::span<const double> from, State& state, std::span<double> to,
                    const TimeScheme& scheme) const;
  void carry_error(std::span<const double> from, std::span<double> to) const;

  std::vector<Way> nodes_, rows_, memory_;
  std::size_t rows_after_ = 0;
};

}  // namespace isochor
