// Cases of the papers: each by a name of its own, on scenes that a run takes, with numbers that it measures.
#include <algorithm>
#include <set>

#include "catch.h"
#include "studies/paper_cases.h"

using namespace isochor;
using namespace isochor::studies;

namespace {

std::vector<PaperCase> all_cases(bool quick) {
  std::vector<PaperCase> out;
  for (PaperPart& part : paper_parts(quick)) {
    CHECK_FALSE(part.differs.empty());
    for (PaperCase& one : part.cases) out.push_back(std::move(one));
  }
  return out;
}

Numbers probed(const std::string& id) {
  for (const PaperCase& one : all_cases(true)) {
    if (one.cell.id != id) continue;
    auto numbers = one.cell.probe(one.cell.scene, 1);
    INFO((numbers ? std::string() : numbers.failure().message));
    REQUIRE(numbers);
    return numbers.value();
  }
  FAIL("no case " << id);
  return {};
}

}  // namespace

TEST_CASE("every case of the papers is a scene that runs take, and shows what it measures") {
  const std::vector<PaperCase> quick = all_cases(true), full = all_cases(false);
  REQUIRE(quick.size() == full.size());
  std::set<std::string> ids;
  for (std::size_t i = 0; i < full.size(); ++i) {
    CAPTURE(full[i].cell.id);
    CHECK(quick[i].cell.id == full[i].cell.id);
    CHECK(ids.insert(full[i].cell.id).second);
    CHECK_FALSE(full[i].shown.empty());
    for (const PaperCase& one : {quick[i], full[i]}) {
      if (one.cell.probe) continue;
      const auto checked = check_scene(one.cell.scene);
      INFO((checked ? std::string() : checked.failure().message));
      CHECK(checked);
      for (const ShownNumber& shown : one.shown) {
        CAPTURE(shown.metric);
        CHECK(std::any_of(one.cell.scene.metrics.begin(), one.cell.scene.metrics.end(),
                          [&](const MetricDef& m) { return m.name == shown.metric; }));
      }
    }
  }
}

TEST_CASE("a tet that is pressed flat hands its volume to the other where both are one zone") {
  const Numbers free = probed("two_tets/none"), zone = probed("two_tets/zone");
  CHECK(free.at("all") < 0.6);
  CHECK(zone.at("all") == Approx(1).margin(1e-8));
  CHECK(zone.at("right") == Approx(2).margin(1e-8));
}

TEST_CASE("a cube that settles by implicit Euler gains no energy, whatever keeps its volume") {
  for (const char* id : {"settling/tet4_node_plain", "settling/tet4_zone", "settling/edge_node"}) {
    CAPTURE(id);
    const Numbers n = probed(id);
    CHECK(n.at("largest rise") <= 1e-9);
    CHECK(n.at("volume least") > 0.9);
    CHECK(n.at("deflection most") > 0);
  }
}
