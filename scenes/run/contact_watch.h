// What a run should say about its contacts when it ends.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "isochor/world.h"

namespace isochor {

// Looks at the gauges of contacts at the end of every step.
class ContactWatch {
 public:
  void look(double time, const std::vector<Gauge>& gauges);
  // Sentences for the user: contacts that never touched, and layers deep against the faces.
  std::vector<std::string> findings() const;

 private:
  struct Contact {
    bool touched = false;
    double smallest_gap = 0, gap_time = 0;  // over all steps [m], [s]
    double deepest = 0, depth_time = 0;     // of the layer over the size of a face, [s]
    double pressure = 0;                    // then [Pa]
  };
  std::map<std::string, Contact> contacts_;
};

}  // namespace isochor
