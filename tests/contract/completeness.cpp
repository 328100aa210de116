#include <algorithm>
#include <set>

#include "catch.h"
#include "contract/registry.h"

namespace {

// Written by the build from the files of materials/ and constraints/.
const std::vector<std::string> kUnits = {
#include "contract_units.inc"
};

}  // namespace

TEST_CASE("every material and effect of the build has a contract case") {
  REQUIRE(kUnits.size() >= 6);
  std::set<std::string> covered;
  const auto add = [&](const auto& cases) {
    for (const auto& c : cases) covered.insert(c.covers.begin(), c.covers.end());
  };
  add(test::material_cases());
  add(test::model_cases());
  add(test::scene_cases());
  for (const std::string& unit : kUnits) {
    INFO(unit << ".cpp has no case in tests/contract/registry_*.cpp");
    CHECK(covered.count(unit) == 1);
  }
  for (const std::string& unit : covered) {
    INFO("a contract case names " << unit << ", which is no file of the build");
    CHECK(std::find(kUnits.begin(), kUnits.end(), unit) != kUnits.end());
  }
}
