// Rule: an unused effect costs nothing.
#include "rules/instruments.h"
#include "support/allocations.h"
#include "support/worlds.h"

using namespace isochor;
using namespace test;

TEST_CASE("an effect without stencils leaves rows, non-zeros, bits and allocations alone") {
  SmallProblem plain(Element::tet4_edge_smoothed, 900, std::make_unique<DenseSolver>());
  SmallProblem with(Element::tet4_edge_smoothed, 900, std::make_unique<DenseSolver>(), nullptr, true);
  const System &a = *plain.scene.system, &b = *with.scene.system;
  CHECK(b.parts().stencil_pools.size() == a.parts().stencil_pools.size() + 1);
  CHECK(a.rows() == b.rows());
  CHECK(a.kkt().nonzeros() == b.kkt().nonzeros());
  CHECK(a.kkt().row == b.kkt().row);
  CHECK(a.layout() == b.layout());
  for (const double t : {0.3, 0.6, 1.0}) {
    const AllocationCount first;
    REQUIRE(plain.solve(t).status == SaddleStatus::converged);
    const long by_plain = first.count();
    const AllocationCount second;
    REQUIRE(with.solve(t).status == SaddleStatus::converged);
    const long by_with = second.count();
    if (t > 0.3) CHECK(by_with == by_plain);
    CHECK(with.x == plain.x);
    CHECK(with.lambda == plain.lambda);
  }
}

TEST_CASE("rows without a bulk modulus to carry are left out") {
  // nu = 0 with the neo-Hookean energy: kappa = 0.
  const auto size = [](bool rows) {
    World world = make_world(static_options());
    const BodyId body = add_body(world, box({2, 2, 2}), Element::tet4, neo_hookean(1e5, 0));
    if (rows) add_volume(world, body);
    hold(world, body, {"x0"});
    return world.size();
  };
  CHECK(size(true).multipliers == 0);
  CHECK(size(true).matrix_nonzeros == size(false).matrix_nonzeros);
}
