// What is expected of runs that have not been made: their errors and their cost, from those that have.
#pragma once

#include <optional>
#include <vector>

#include "scenes/run/error_evidence.h"
#include "scenes/run/run_cost.h"

namespace isochor {

// Runs of one element on finer and finer meshes, from that of the scene.
struct ErrorLadder {
  std::optional<Element> element;
  std::vector<std::vector<Answer>> answers;  // by level
  std::vector<RunCost> costs;
  // Every mesh is the one before with some cells refined, in place of all; its first run is that of this
  // ladder.
  std::optional<std::size_t> local_of = {};
  double growth = 8;  // so many times the cells on the next mesh

  int levels() const { return static_cast<int>(costs.size()); }
};

// How an element gets within an error.
struct ErrorPlan {
  int level = 0;                 // of the mesh whose answer is known to be good enough
  RunCost cost;                  // of that run
  double seconds = 0, work = 0;  // of it and of those before it that have not been made; see RunCost
};

class ErrorForecast {
 public:
  explicit ErrorForecast(CostModel model = {}) : model_(std::move(model)) {}

  // From the cheapest element to the best, with all cells refined; then those with some, whose first level is
  // there when the first of `local_of` is.
  std::vector<ErrorLadder> ladders;

  // What is known of the error of the last run of a ladder: by its own meshes where it has two or three, by
  // the next worse element on the same mesh; whichever says more.
  std::optional<Evidence> evidence(std::size_t ladder) const;
  // Nothing where no run tells.
  std::optional<RunCost> cost(std::size_t ladder, int level) const;
  // Of the last run of a ladder, or of its first where there is none yet; relative. Not what is certain but
  // what is likely.
  double error(std::size_t ladder) const;
  // Until a run is expected to be known to be within the error; none within so many levels.
  std::optional<ErrorPlan> plan(std::size_t ladder, double error, int most_levels) const;

 private:
  bool of_all(std::size_t ladder) const { return !ladders[ladder].local_of; }
  double error_of_first(std::size_t ladder) const;

  CostModel model_;
};

}  // namespace isochor
