// What a viewer may ask for, as a message says it.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "isochor/types.h"

namespace isochor::live {

enum class Action : std::uint8_t {
  take,  // to drive, in the place of whoever does
  play,
  pause,
  step,
  reset,
  speed,    // value: the most that is made of real time
  set,      // control, value
  pull,     // triangle, weights: a spring at a point of a surface
  pin,      // likewise: held where it is
  push,     // likewise: a sphere in front of the point
  move,     // handle, to
  release,  // handle
  record,
  stop_recording,
};

struct Command {
  Action action = Action::pause;
  double value = 0;
  int control = -1, handle = -1;
  Index triangle = -1;
  std::array<double, 3> weights{};  // of the corners of the triangle, of sum one
  Vec3 to{};                        // [m]
};

inline constexpr std::size_t largest_message = 2048;  // bytes

// {"do": "set", "control": 2, "value": 8000}. Exactly the keys of the action, numbers finite; the sentence
// says what is wrong.
Result<Command> parse_command(std::string_view text);

// Whether a later command of the same target makes this one pointless.
bool replaces(const Command& later, const Command& earlier);

}  // namespace isochor::live
