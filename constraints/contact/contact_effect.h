// What the effects of contact share: checks of what an author gives, overlap at the start, and gauges.
#pragma once

#include "constraints/contact/contact_rows.h"
#include "engine/scene/builder.h"

namespace isochor {

// What must be zero or positive: key, value and unit of an effect.
struct ContactNumber {
  const char* key;
  double value;
  const char* unit;
};
// `who` begins the message.
Result<void> check_numbers(const std::string& who, std::span<const ContactNumber> numbers);
Result<void> check_static_friction(const std::string& who, double friction, double static_friction);
Result<void> check_resolve_time(const std::string& who, double resolve_time);

// Of rows that are closer at the start than they may be.
struct Overlap {
  Index worst = -1, count = 0;  // row of the deepest, and how many; -1: none
  double deepest = 0;           // gap [m]
};
// From the gaps at rest, infinite where there is none. What is no deeper than `groove` stays, as the grooves
// between flat faces of one body; the rest becomes the overlap of the rows, to be resolved or refused.
Overlap take_overlap(std::span<const double> gap, double groove, double length, ContactRows& rows);

struct ContactTotals {
  Vec3 force{};                                          // on the body [N]
  double normal = 0, tangential = 0;                     // sums of magnitudes [N]
  double area = 0;                                       // [m^2]
  double pressure = 0;                                   // largest [Pa]
  double gap = std::numeric_limits<double>::infinity();  // smallest [m]
  double depth = 0;  // how far a layer gives way, over the size of a face [-]
};
void add_gauges(std::string_view effect, const ContactTotals& totals, std::vector<Gauge>& out);

}  // namespace isochor
