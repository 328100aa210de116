// Pivot sequences: permutations that keep multiplier rows behind what they constrain.
#include <algorithm>
#include <numeric>

#include "catch.h"
#include "engine/solvers/ordering.h"
#include "solver/linear_support.h"

namespace {

using namespace isochor;

constexpr OrderingMethod kMethods[] = {OrderingMethod::best, OrderingMethod::metis, OrderingMethod::pord,
                                       OrderingMethod::amf,  OrderingMethod::amd,   OrderingMethod::as_given};

}  // namespace

TEST_CASE("every ordering is a permutation with rows behind an unknown that they constrain") {
  const test::Matrix m = test::saddle({150, 50, true, 0, 0});
  const Eigen::MatrixXd a = m.dense();
  for (const OrderingMethod method : kMethods) {
    INFO("method " << static_cast<int>(method));
    const Ordering o = order_unknowns(m.pattern, method);
    std::vector<Index> sorted = o.position;
    std::sort(sorted.begin(), sorted.end());
    for (Index i = 0; i < m.pattern.size; ++i) {
      CHECK(sorted[at(i)] == i);
      CHECK(o.unknown[at(o.position[at(i)])] == i);
    }
    for (Index i = 0; i < m.pattern.size; ++i) {
      if (!m.pattern.multiplier[at(i)]) continue;
      Index earliest = m.pattern.size;
      for (Index j = 0; j < m.pattern.size; ++j) {
        if (a(i, j) != 0 && i != j && !m.pattern.multiplier[at(j)])
          earliest = std::min(earliest, o.position[at(j)]);
      }
      CHECK(earliest < o.position[at(i)]);
    }
    CHECK(o.dense == 1);
    CHECK(o.position[at(m.pattern.size - 1)] == m.pattern.size - 1);  // the dense row goes last
  }
}

TEST_CASE("an ordering does not depend on what was ordered before") {
  const test::Matrix m = test::saddle({150, 50, false, 0, 0}), other = test::saddle({90, 10, true, 0, 0});
  for (const OrderingMethod method : kMethods) {
    const Ordering first = order_unknowns(m.pattern, method);
    order_unknowns(other.pattern, method);
    CHECK(order_unknowns(m.pattern, method).position == first.position);
  }
}
