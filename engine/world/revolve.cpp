#include "engine/world/revolve.h"

#include <algorithm>
#include <cstdint>

namespace isochor {

namespace {

// How many steps can be reversed with `kept` states, the first included, when none is made more than `times`
// times: (kept + times)! / (kept! times!), or more than anybody asks.
std::int64_t reach(std::int64_t kept, std::int64_t times) {
  constexpr std::int64_t enough = std::int64_t{1} << 31;
  if (kept < 0 || times < 0) return 0;
  std::int64_t product = 1;
  for (std::int64_t k = 1; k <= std::min(kept, times); ++k) {
    product = product * (std::max(kept, times) + k) / k;
    if (product > enough) return enough;
  }
  return product;
}

}  // namespace

// With r the least number of times that does, both parts are to be within reach: the one ahead with a state
// less, the one behind with a time less; and neither of them so short that the other pays for it.
Index steps_to_keep(Index steps, Index free) {
  const std::int64_t kept = std::int64_t{free} + 1;
  std::int64_t times = 1;
  while (reach(kept, times) < steps) ++times;
  const std::int64_t least = std::max(reach(kept, times - 2), steps - reach(kept - 1, times));
  return static_cast<Index>(std::clamp<std::int64_t>(least, 1, steps - 1));
}

}  // namespace isochor
