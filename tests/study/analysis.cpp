// Fronts, orders, profiles and costs against cases worked out by hand.
#include "studies/analysis.h"

#include <cmath>
#include <limits>

#include "catch.h"
#include "studies/page.h"

using namespace isochor::studies;

namespace {

Measured point(double unknowns, double seconds, double error) {
  Measured m;
  m.status = "converged";
  m.displacements = static_cast<std::int64_t>(unknowns);
  m.seconds = seconds;
  m.error = error;
  return m;
}

}  // namespace

TEST_CASE("the Pareto front holds what nobody beats in both") {
  const double nan = std::nan("");
  const std::vector<double> cost{3, 1, 2, 2, 5, 4, nan}, error{0.1, 0.5, 0.2, 0.3, 0.1, 0.05, 0};
  CHECK(pareto_front(cost, error) == std::vector<std::size_t>{1, 2, 0, 5});
  CHECK(pareto_front(std::vector<double>{}, std::vector<double>{}).empty());
}

TEST_CASE("the observed order is that of the error in the mesh size") {
  // Error h^2 on n^3 unknowns.
  CHECK(observed_order(8, 0.25, 64, 0.0625, 3).value() == Approx(2));
  CHECK(observed_order(4, 0.25, 16, 0.0625, 2).value() == Approx(2));
  CHECK_FALSE(observed_order(8, 0.25, 8, 0.0625, 3));
  CHECK_FALSE(observed_order(8, 0.25, 64, 0, 3));
}

TEST_CASE("performance profiles count problems within a factor of the best") {
  const double nan = std::nan("");
  // Problem 2 is solved by the second alone, problem 3 by nobody.
  const auto profiles = performance_profiles({{1, 4, nan, nan}, {2, 2, 10, nan}});
  REQUIRE(profiles.size() == 2);
  CHECK(profiles[0].factor == std::vector<double>{1, 2});
  CHECK(profiles[0].share[0] == Approx(1.0 / 3));
  CHECK(profiles[0].share[1] == Approx(2.0 / 3));
  CHECK(profiles[1].factor == std::vector<double>{1, 2});
  CHECK(profiles[1].share[0] == Approx(2.0 / 3));
  CHECK(profiles[1].share[1] == Approx(1));
  CHECK(performance_profiles({{nan}, {nan}})[0].factor.empty());
}

TEST_CASE("the cost of an error is read off the line between two meshes") {
  const Measured coarse = point(100, 1, 0.1), fine = point(1000, 10, 0.001);
  const std::vector<const Measured*> cells{&coarse, &fine};
  CHECK(seconds_at(cells, 0.01).value() == Approx(std::sqrt(10.0)));
  CHECK(seconds_at(cells, 0.2).value() == 1);
  CHECK_FALSE(seconds_at(cells, 1e-4));
  CHECK(cheapest(cells, 0.01) == &fine);
  CHECK(cheapest(cells, 1e-4) == nullptr);
  // Two decades of error for one of time, and another one of error beyond.
  CHECK(extrapolated_seconds(cells, 1e-4).value() == Approx(10 * std::sqrt(10.0)));
  CHECK_FALSE(extrapolated_seconds(cells, 0.01));
  Measured stuck = point(5000, 100, 0.002);
  const std::vector<const Measured*> stuck_cells{&coarse, &fine, &stuck};
  CHECK_FALSE(extrapolated_seconds(stuck_cells, 1e-4));
  // The middle mesh is right by luck: the finest is not.
  const Measured lucky = point(500, 5, 1e-5);
  const std::vector<const Measured*> lucky_cells{&coarse, &lucky, &fine};
  CHECK(lasting(lucky_cells, 1e-4).size() == 2);
  CHECK(cheapest(lasting(lucky_cells, 1e-4), 1e-4) == nullptr);
  CHECK(cheapest(lasting(lucky_cells, 0.01), 0.01) == &lucky);
  stuck.cpu_seconds = 7;
  CHECK(seconds_at(std::vector<const Measured*>{&stuck}, 0.01, processor_seconds).value() == 7);
}

TEST_CASE("a page keeps what JSON cannot say out of its lines") {
  Page page;
  page.title = "a </script> title";
  Diagram d;
  d.lines = {{"line", {1, 2, 3}, {1, std::nan(""), 3}}};
  page.sections = {{"s", "", {d}}};
  const std::string json = page_json(page);
  CHECK(json.find("\"x\":[1.0,3.0]") != std::string::npos);
  const auto html = page_html(page);
  if (html) {
    CHECK(html.value().find("</script> title") == std::string::npos);
    CHECK(html.value().find("\\u003c/script> title") != std::string::npos);
  }
}
