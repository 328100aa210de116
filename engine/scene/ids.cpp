#include "engine/scene/ids.h"

#include <atomic>

namespace isochor {

std::uint64_t WorldNumbers::next_world() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

std::string why_not(WorldNumbers::Found found, const std::string& thing, Index number, Index count) {
  const std::string numbered = thing + " number " + std::to_string(number);
  switch (found) {
    case WorldNumbers::Found::here:
      return {};
    case WorldNumbers::Found::unsaid:
      return "no " + thing + " is named, and there are " + std::to_string(count) +
             " in this world; say which one";
    case WorldNumbers::Found::other_world:
      return numbered + " belongs to another world; give an id that this one handed out";
    case WorldNumbers::Found::removed:
      return numbered + " was removed";
    case WorldNumbers::Found::no_such_number:
      return "there is no " + numbered;
  }
  return {};
}

}  // namespace isochor
