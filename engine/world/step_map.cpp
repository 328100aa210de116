#include "engine/world/step_map.h"

#include <algorithm>

namespace isochor {

// Asks the scheme about a single node whose lists are zero but for one.
StepMap step_map(const TimeScheme& scheme, std::span<const double> memory, double t, double h) {
  const SchemeMemory kept = scheme.memory();
  const std::size_t lists = 2 + kept.vectors;
  StepMap map;
  map.predicted.resize(lists);
  map.found.resize(lists);
  map.before.assign(lists, std::vector<double>(lists));
  std::vector<double> numbers(kept.numbers(1), 0.0);
  const auto take = [&](std::size_t one, double found) {
    State node;
    node.t = t;
    node.x.resize(1);
    node.v.resize(1);
    std::fill(numbers.begin(), numbers.end(), 0.0);
    std::copy_n(memory.begin(), kept.before, numbers.begin());
    std::copy_n(memory.end() - static_cast<std::ptrdiff_t>(kept.after), kept.after,
                numbers.end() - static_cast<std::ptrdiff_t>(kept.after));
    if (one == 0) node.x[0].x = 1;
    if (one == 1) node.v[0].x = 1;
    if (one > 1 && one < lists) numbers[kept.before + 3 * (one - 2)] = 1;
    std::vector<Vec3> predicted(1);
    map.mass_scale = scheme.begin(node, numbers, h, predicted);
    if (one < lists) map.predicted[one] = predicted[0].x;
    const std::vector<Vec3> x{{found, 0, 0}};
    scheme.finish(h, x, predicted, node, numbers);
    std::vector<double> after{node.x[0].x, node.v[0].x};
    for (std::size_t k = 0; k < kept.vectors; ++k) after.push_back(numbers[kept.before + 3 * k]);
    return after;
  };
  for (std::size_t one = 0; one < lists; ++one) {
    const auto after = take(one, 0);
    for (std::size_t k = 0; k < lists; ++k) map.before[k][one] = after[k];
  }
  map.found = take(lists, 1);
  return map;
}

}  // namespace isochor
