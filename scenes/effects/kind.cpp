#include "scenes/effects/kind.h"

#include <algorithm>
#include <iterator>

namespace isochor {

std::vector<const EffectKind*> kinds_by_phase() {
  std::vector<const EffectKind*> kinds(std::begin(effect_kinds), std::end(effect_kinds));
  std::stable_sort(kinds.begin(), kinds.end(),
                   [](const EffectKind* a, const EffectKind* b) { return a->phase < b->phase; });
  return kinds;
}

}  // namespace isochor
