// No formulation invents vibrations: as many rigid motions as there are, and the lowest frequencies are those
// of Tet10 on the same nodes.
#include "studies/modes.h"

#include <algorithm>
#include <string>

#include "support/worlds.h"

namespace {

using namespace isochor;
using namespace isochor::studies;

Numbers modes(const char* name, double stretch) {
  auto r = modes_probe(formulation(name), 4, stretch)({}, 1);
  return test::value(std::move(r));
}

}  // namespace

TEST_CASE("no spurious modes, free and under load") {
  for (const double stretch : {0.0, 1.5, 0.85}) {
    const Numbers reference = modes("tet10_node", stretch);
    for (const char* name : {"tet4_node", "edge_node", "tet10_node"}) {
      const Numbers found = modes(name, stretch);
      double least = 1e9, most = 0;
      for (int k = 1; k <= 30; ++k) {
        std::string f = std::to_string(k);
        f.insert(0, 1, 'f');
        const double ratio = found.at(f) / reference.at(f);
        least = std::min(least, ratio);
        most = std::max(most, ratio);
      }
      UNSCOPED_INFO(name << " at " << stretch << ": frequencies over Tet10's " << least << " to " << most
                         << ", roughness " << found.at("rough") << ", zero modes " << found.at("zero modes")
                         << ", unstable " << found.at("unstable"));
      CHECK(found.at("zero modes") == (stretch > 0 ? 0 : 6));
      CHECK(found.at("unstable") == 0);
      CHECK(least > 0.8);
      CHECK(found.at("rough") < 0.9);
    }
  }
}
