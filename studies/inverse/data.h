// What was measured of a scene, or is wanted of it: numbers over its time.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scenes/scene.h"

namespace isochor::inverse {

// A number that a scene shows.
struct Quantity {
  enum class Kind : std::uint8_t {
    position,
    volume,
    pressure,
    length,
    tension,
    force,            // of a support
    moment,           // of a support
    contact,          // force of a contact on its body, friction included
    surface_contact,  // likewise
  };
  std::string name;  // of its column: "tip.x", "chamber.volume", "wall.force.z"
  Kind kind = Kind::position;
  std::size_t of = 0;  // in the list of probes, cavities, cables, supports or contacts; of a marker the body
  int component = 0;   // of vectors
  std::optional<Vec3> marker = {};  // a material point that is no probe, at rest [m]
};
const char* unit_of(Quantity::Kind kind);

struct Datum {
  std::size_t step = 0, quantity = 0;
  double value = 0;  // in SI units
};

struct Data {
  std::string source;  // for messages
  std::vector<Quantity> quantities;
  std::vector<double> time;   // of the scene [s], or load factor; ascending, above 0
  std::vector<Datum> values;  // in the order of time
};

// A CSV file in one of two forms. Columns: "time", and PROBE.x, PROBE.y, PROBE.z [m], CAVITY.volume [m^3],
// CAVITY.pressure [Pa], CABLE.length [m], CABLE.tension [N], SUPPORT.force.x [N], SUPPORT.moment.x [N m],
// CONTACT.force.x [N]; an empty cell was not measured. Markers: columns "time", "X", "Y", "Z" (where the
// point is at rest), "x", "y", "z" (where it was seen), and "body" where the scene has several; a line a
// marker and time. Errors name file, line and remedy.
Result<Data> read_data(const std::string& path, const SceneDef& scene);
Result<Data> parse_data(const std::string& text, const std::string& source, const SceneDef& scene);

// The quantity that a column of a scene means.
Result<Quantity> quantity_of(const std::string& column, const SceneDef& scene, const std::string& who);
Result<double> number_in(const std::string& cell, const std::string& who);

}  // namespace isochor::inverse
