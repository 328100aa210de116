#include "constraints/contact/surface/pairing.h"

#include <algorithm>
#include <cmath>

#include "engine/base/text.h"

namespace isochor {

std::shared_ptr<ContactRows> pair_rows(const Builder& builder, const SurfaceContactDef& def, std::string name,
                                       const ContactLayer& layer, std::span<const double> area, double size,
                                       PairSetup& setup) {
  setup.name = std::move(name);
  setup.offset = def.thickness;
  setup.friction = {def.friction, def.static_friction};
  setup.coupled = def.coupling == FrictionCoupling::coupled;
  setup.open = builder.length();
  auto rows = std::make_shared<ContactRows>(setup.name, def.resolve_time);
  for (const double a : area) {
    // Both of a pair carry half of the force.
    rows->add(layer.modulus, a, builder.length(), 2 * layer.compliance);
    if (std::isfinite(layer.knee)) rows->knee.push_back(0.5 * a * layer.knee);
    setup.stick.push_back(def.stick_stiffness > 0 ? 0.5 * def.stick_stiffness * a
                                                  : 50 * layer.modulus * a / size);
  }
  rows->largest_overshoot = 0.25 * size;
  return rows;
}

std::vector<Index> pairs_in_memory(std::span<const double> memory, int per) {
  const auto step = static_cast<std::size_t>(per);
  std::vector<Index> pairs(memory.size() / step);
  for (std::size_t s = 0; s < pairs.size(); ++s)
    pairs[s] = std::max(static_cast<Index>(memory[step * s]) - 1, Index{-1});
  return pairs;
}

void keep_pairs(std::span<const Index> pairs, int per, std::span<double> memory) {
  for (std::size_t s = 0; s < pairs.size(); ++s)
    memory[static_cast<std::size_t>(per) * s] = pairs[s] < 0 ? -1 : pairs[s] + 1;
}

Result<std::vector<Index>> checked_pairs(std::span<const double> memory, int per, Index choices,
                                         const std::string& name, const char* what) {
  const auto step = static_cast<std::size_t>(per);
  for (std::size_t first = 0; first < memory.size(); first += step) {
    const double kept = memory[first];
    if (kept >= -1 && kept <= choices && kept == std::floor(kept)) continue;
    return Error{"contact \"" + name + "\" is said to be close to " + what + " number " + number(kept - 1) +
                 " of " + std::to_string(choices)};
  }
  return pairs_in_memory(memory, per);
}

}  // namespace isochor
