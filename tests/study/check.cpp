// The regression guard finds what changed and forgives what may.
#include "studies/check.h"

#include <cmath>

#include "catch.h"

using namespace isochor::studies;

TEST_CASE("differences beyond tolerance are named") {
  const Expectation e{"converged", {{"tip", -0.5}, {"volume error", 1e-13}}, 20};
  CHECK(differences(e, e).empty());
  Expectation f = e;
  f.values["tip"] = -0.5 * (1 + 5e-7);
  f.values["volume error"] = 1e-11;
  f.iterations = 25;
  CHECK(differences(e, f).empty());
  f.values["tip"] = -0.5 * (1 + 5e-6);
  CHECK(differences(e, f).size() == 1);
  f.iterations = 26;
  CHECK(differences(e, f).size() == 2);
  f.values.erase("tip");
  CHECK(differences(e, f).size() == 2);
  f = e;
  f.values["tip"] = std::nan("");
  CHECK(differences(e, f).size() == 1);
  f = e;
  f.values["another"] = 1;
  CHECK(differences(e, f).size() == 1);
  f.status = "not_converged";
  CHECK(differences(e, f).size() == 1);
}

TEST_CASE("the committed expectations are read, and written the same") {
  const auto read = read_expectations(expectations_file());
  INFO((read ? std::string() : read.error()));
  REQUIRE(read.ok());
  CHECK(read.value().size() >= 20);
  CHECK(expectations_json(read.value()).size() > 1000);
  CHECK_FALSE(read_expectations("/no/such/file").ok());
}

TEST_CASE("an expectation without a cell and a cell without an expectation are wrong") {
  CheckOptions options;
  options.threads = {};  // measures nothing
  std::size_t asked = 0;
  options.on_cell = [&](const std::string& id, const std::vector<std::string>& findings) {
    if (id == "no/such/cell") asked += findings.size();
  };
  const CheckResult r = check_studies({{"no/such/cell", {}}}, options);
  CHECK(asked == 1);
  CHECK(r.wrong == 1);
  CHECK(r.cells >= 20);
}
