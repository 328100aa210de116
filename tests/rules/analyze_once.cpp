// Rule: pattern once, values many.
#include "catch.h"
#include "rules/instruments.h"

using namespace isochor;
using namespace test;

TEST_CASE("ordering and symbolic work happen once") {
  for (const Element element : {Element::tet4, Element::tet4_edge_smoothed, Element::tet10}) {
    auto calls = std::make_shared<DenseSolver::Calls>();
    SmallProblem p(element, 900, std::make_unique<DenseSolver>(calls));
    int iterations = 0;
    for (int step = 1; step <= 6; ++step) {
      const SaddleReport r = p.solve(step / 6.0);
      REQUIRE(r.status == SaddleStatus::converged);
      iterations += r.iterations;
    }
    CHECK(iterations > 6);
    CHECK(calls->analyze == 1);
    CHECK(p.newton->analyses() == 1);
    CHECK(calls->factor > 1);
  }
}
