// What viewers are sent: the scene once, then pictures. Numbers are little-endian:
//   u32 bytes of JSON, the JSON with blanks up to a multiple of four, then arrays in the order of its counts.
#pragma once

#include <string>

#include "live/player.h"

namespace isochor::live {

// Vertices at rest (f32 x y z), triangles (u32), the part of each (u32), which of its sides are edges of the
// mesh (u32), values of maps that do not change (f32 a triangle).
std::string scene_message(const Simulation& simulation, bool readonly);

// What only one viewer is told.
struct Audience {
  bool drives = false;
  int viewers = 1;
  std::uint64_t refused = 0;  // messages, of all viewers together
};

// What a viewer wants beside the shape.
struct Wish {
  std::string field;    // one of the scene; any other name: none
  bool forces = false;  // of contacts
  bool fibers = false;
};

// Vertices (f32 x y z), values of the field (f32 a vertex of a body; NaN where there is none), points of
// lines, probes, contacts, forces (point, normal force, friction), both ends of fibers.
std::string picture_message(const Simulation& simulation, const Shown& shown, const Wish& wish,
                            const Audience& audience);

// Whether a field of this name has to be computed for its pictures: not displacements, nor maps.
bool is_computed(const Simulation& simulation, const std::string& field);

// {"error": "..."}
std::string error_message(const std::string& sentence);

}  // namespace isochor::live
