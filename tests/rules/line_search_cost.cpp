// Rule: ask for what you need. A line search never computes a Hessian.
#include "catch.h"
#include "rules/instruments.h"

using namespace isochor;
using namespace test;

TEST_CASE("a line search never computes a Hessian") {
  for (const Element element : {Element::tet4, Element::tet4_edge_smoothed}) {
    auto counts = std::make_shared<Evaluations>();
    // Soft and hard pulled: several trials are needed.
    SmallProblem p(element, 2e4, std::make_unique<DenseSolver>(), counts);
    const auto pools = static_cast<int>(p.scene.system->parts().stencil_pools.size());
    const int before = counts->hessian;  // the stiffness at rest
    CHECK(before <= pools);
    const SaddleReport r = p.solve(1);
    INFO(to_string(r.status) << ", " << r.iterations << " iterations, " << r.trials << " trials");
    CHECK(r.trials > r.iterations);
    CHECK(counts->gradient + counts->value >= pools * r.trials);
    // One for each factorization that is not a mere shift, and one to look at the start.
    CHECK(counts->hessian - before <= pools * (r.iterations + r.projected + 1));
  }
}
