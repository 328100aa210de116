#include "scenes/run/error_forecast.h"

#include <cmath>
#include <limits>

#include "scenes/run/setting.h"

namespace isochor {

namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

// What errors do where little is known: cells of half the size leave a quarter, the next better element a
// fourth, and what has been compared with a worse element is half as wrong as the difference. Where the cells
// that hold three quarters of an error are halved alone, the other quarter stays.
constexpr double kOrderTwo = 4, kBetterElement = 0.25, kBetterOfTwo = 0.5;
constexpr double kLocal = 1 / (0.25 + 0.75 / kOrderTwo);

}  // namespace

std::optional<RunCost> ErrorForecast::cost(std::size_t l, int level) const {
  const ErrorLadder& ladder = ladders[l];
  if (level < ladder.levels()) return ladder.costs[static_cast<std::size_t>(level)];
  if (ladder.levels() > 0) {
    return model_.grown(ladder.costs.back(), ladder.element,
                        std::pow(ladder.growth, level - (ladder.levels() - 1)));
  }
  // From the nearest element below that has been run.
  for (std::size_t other = l; of_all(l) && other-- > 0;) {
    if (ladders[other].levels() == 0 || !ladder.element || !ladders[other].element) continue;
    return model_.refined(
        model_.with_element(ladders[other].costs[0], *ladders[other].element, *ladder.element),
        ladder.element, level);
  }
  return {};
}

// By what other elements say on the mesh of the scene.
double ErrorForecast::error_of_first(std::size_t l) const {
  const auto& runs = ladders[l].answers;
  for (std::size_t better = ladders.size(); better-- > l + 1;) {
    if (of_all(better) && ladders[better].levels() > 0)
      return largest_difference(runs[0], ladders[better].answers[0]);
  }
  for (std::size_t worse = l; worse-- > 0;) {
    if (ladders[worse].levels() > 0)
      return kBetterOfTwo * largest_difference(ladders[worse].answers[0], runs[0]);
  }
  return kNever;
}

double ErrorForecast::error(std::size_t l) const {
  const auto& runs = ladders[l].answers;
  if (runs.size() >= 2) {
    const double ratio = of_all(l) ? kOrderTwo : kLocal;
    return largest_difference(runs[runs.size() - 2], runs.back()) / (ratio - 1);
  }
  if (!of_all(l)) return runs.empty() ? kNever : error_of_first(*ladders[l].local_of);
  if (runs.empty()) return l > 0 ? kBetterElement * error(l - 1) : kNever;
  return error_of_first(l);
}

// Of the last run of a ladder: by its own meshes where it has two or three, by the next worse element on the
// same mesh; whichever says more.
std::optional<Evidence> ErrorForecast::evidence(std::size_t l) const {
  const auto& runs = ladders[l].answers;
  if (runs.empty()) return {};
  const std::size_t level = runs.size() - 1;
  std::optional<Evidence> best;
  if (level >= 2)
    best = (of_all(l) ? from_three_meshes : from_three_local_meshes)(runs[level - 2], runs[level - 1],
                                                                     runs[level]);
  else if (level == 1)
    best = (of_all(l) ? from_two_meshes : from_two_local_meshes)(runs[0], runs[1]);
  for (std::size_t worse = l; of_all(l) && worse-- > 0;) {
    const ErrorLadder& other = ladders[worse];
    if (other.answers.size() <= level) continue;
    Evidence evidence = from_two_elements(other.answers[level], runs[level], element_text(other.element));
    if (!best || evidence.largest < best->largest) best = std::move(evidence);
    break;
  }
  return best;
}

std::optional<ErrorPlan> ErrorForecast::plan(std::size_t l, double wanted, int most_levels) const {
  double left = error(l);
  ErrorPlan plan;
  if (const auto known = evidence(l); known && known->largest <= wanted) {
    plan.level = ladders[l].levels() - 1;
    plan.cost = ladders[l].costs.back();
    return plan;
  }
  for (int level = ladders[l].levels(); level <= most_levels; ++level) {
    const auto next = cost(l, level);
    plan.level = level;
    plan.cost = next.value_or(RunCost{});
    plan.seconds += plan.cost.seconds();
    plan.work += plan.cost.work();
    // The indicator that this run will have: of two elements, of two meshes, of three.
    double expected = kNever;
    if (level == 0 && l > 0) expected = kElementSafety * error(l - 1);
    if (level > 0) {
      const double ratio = of_all(l) ? kOrderTwo : kLocal;
      const double safety = of_all(l) ? 1 : kLocalSafety;
      expected = level == 1 ? safety * (1 - 1 / ratio) * left : 1.25 * left / ratio;
      left /= ratio;
    }
    if (expected <= wanted) return plan;
  }
  return {};
}

}  // namespace isochor
