// Parameters of World::gradients() that are numbers among the keys of a material or an effect: for hosts that
// say parts as text, as in parts_by_keys.h.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "isochor/gradients.h"
#include "scenes/parts_by_keys.h"

namespace isochor {

// Keys where a number has some value: one object of JSON, or why there is none.
struct NumberInKeys {
  double value = 0;  // where it is now
  std::function<Result<std::string>(double)> keys;
};

// The number at a path in `json`: "young", "terms[0].mu".
Result<NumberInKeys> number_in_keys(std::string_view json, const std::string& path);

// `keys` of a material, as in material_from_keys(); those of a region, of the whole body where it is empty.
// What does not depend on the number is refused when it is asked, as a density is, which is a parameter of
// its own.
Parameter material_by_keys(BodyId body, std::string region, NumberInKeys number, std::string folder);

// `keys` of an effect, as in effect_from_keys().
Parameter constant_by_keys(EffectId effect, std::string kind, NumberInKeys number, PartContext context);

}  // namespace isochor
