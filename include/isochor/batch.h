// Many worlds of one scene, side by side: for learning, identification and sampling.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "isochor/world.h"

namespace isochor {

// Each world has one thread and the bits that it has alone; the batch works on as many at once as it has
// threads. Tables of the system and the ordering of the factors are shared until a world changes its
// structure. Numbers of worlds come first in all arrays.
class ISOCHOR_API WorldBatch {
 public:
  // `count` clones of a world, at its present state. `threads`: 0: all the machine has.
  static Result<WorldBatch> create(const World& world, Index count, int threads = 0);
  WorldBatch(WorldBatch&&) noexcept;
  WorldBatch& operator=(WorldBatch&&) noexcept;
  ~WorldBatch();

  Index size() const;
  int threads() const;
  // For everything that is set or asked of one alone. A number out of range: the last one.
  World& operator[](Index number);
  const World& operator[](Index number) const;

  // As World::advance() and World::step(), of all worlds; one report each, in their order. A world that fails
  // does not keep the others from going on.
  std::vector<StepReport> advance(double h);
  std::vector<StepReport> step(double h, const StepBudget& budget = {});
  // The worlds that are marked, or all of them, go back to the beginning; marks: one a world, or none.
  Result<void> reset(std::span<const std::uint8_t> marked = {});

  // One amount a world.
  Result<void> set_amounts(EffectId effect, std::span<const double> amounts);
  // Positions or velocities of a body in all worlds: worlds * nodes vectors, copied to `out`. Refused where
  // that is of another size, as in worlds whose bodies differ.
  Result<void> positions(BodyId body, std::span<Vec3> out) const;
  Result<void> velocities(BodyId body, std::span<Vec3> out) const;

  // What each world takes for itself, on average, and what all of them share [bytes].
  struct Memory {
    std::size_t each = 0, shared = 0;
  };
  Memory memory() const;

 private:
  struct Impl;
  explicit WorldBatch(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace isochor
