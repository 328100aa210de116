#include "scenes/effects/kind.h"

#include <algorithm>
#include <iterator>

namespace isochor {

Result<void> EffectAdder::add(const EffectKind& kind, EffectPtr effect) {
  if (parts_) parts_->effects.push_back(effect);
  auto id = built_.world.add(std::move(effect));
  if (!id) return Error{id.error()};
  built_.effects[&kind].push_back(id.value());
  return {};
}

std::vector<const EffectKind*> kinds_by_phase() {
  std::vector<const EffectKind*> kinds(std::begin(effect_kinds), std::end(effect_kinds));
  std::stable_sort(kinds.begin(), kinds.end(),
                   [](const EffectKind* a, const EffectKind* b) { return a->phase < b->phase; });
  return kinds;
}

}  // namespace isochor
