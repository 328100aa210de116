// How much of the error of an answer is that of the length of the steps: the same mesh with steps cut in two,
// again and again.
#pragma once

#include <vector>

#include "scenes/run/error_evidence.h"
#include "scenes/scene.h"

namespace isochor {

// Whether steps of another length have another answer: dynamics, and statics of what remembers its past
// (friction, relaxation in seconds, softening). Not along a path of equilibria, whose steps have no time.
bool steps_matter(const SceneDef& scene);

class StepErrors {
 public:
  // Of the steps of the scene, then of half of them, of a quarter...
  void add(std::vector<Answer> answers) { runs_.push_back(std::move(answers)); }
  int runs() const { return static_cast<int>(runs_.size()); }
  const std::vector<Answer>& run(int halved) const { return runs_[static_cast<std::size_t>(halved)]; }
  // Of the run with steps halved so often, of at least two: that of the shortest by two of them as of first
  // order, by three as for meshes; that of longer ones by their difference to it besides.
  Evidence evidence(int halved) const;
  // The longest steps within an error; none so far.
  std::optional<int> within(double error) const;
  // Halvings that are expected to be missing, as of first order.
  int missing(double error) const;

 private:
  std::vector<std::vector<Answer>> runs_;
};

// A run with another mesh and other steps than those that tell of both: what it answers beside what the two
// together let expect. Where that is much, mesh and steps do not add up.
Evidence from_interplay(std::span<const Answer> mesh, std::span<const Answer> steps_before,
                        std::span<const Answer> steps_after, std::span<const Answer> both);

}  // namespace isochor
