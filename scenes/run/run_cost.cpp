#include "scenes/run/run_cost.h"

#include <algorithm>
#include <cmath>

namespace isochor {

namespace {

constexpr double kCells = 8;
// A value of a factor with its share of indices.
constexpr double kBytesPerEntry = 10;

// Of one factorization, and of one iteration without it, as measured on one machine; only their ratios count.
constexpr double kSecondsPerEntry = 1.2e-10, kEntriesPower = 1.4;
double seconds_per_cell(std::optional<Element> element) {
  switch (element.value_or(Element::tet4_edge_smoothed)) {
    case Element::tet4:
      return 1.2e-5;
    case Element::tet10:
      return 1.5e-4;
    case Element::hex8:
      return 6e-5;
    default:
      return 3e-5;
  }
}

}  // namespace

RunCost cost_of(const RunResult& r, std::optional<Element> element) {
  RunCost c;
  const double cells = r.elements, entries = static_cast<double>(r.size.factor_nonzeros);
  c.factor_work = r.work.factorizations * kSecondsPerEntry * std::pow(entries, kEntriesPower);
  c.other_work = r.work.iterations * cells * seconds_per_cell(element);
  c.factor_s = r.stages.factor;
  c.other_s = std::max(0.0, r.wall_s - r.stages.factor);
  c.factor_bytes = kBytesPerEntry * static_cast<double>(r.size.factor_nonzeros);
  c.other_bytes = static_cast<double>(r.size.engine_bytes + r.size.table_bytes);
  c.unknowns = static_cast<double>(r.size.displacement_unknowns) + r.size.multipliers;
  c.cells = r.elements;
  return c;
}

CostModel::CostModel() {
  of(Element::tet4) = {15, 1.4, 0.6, 0.4, 0.7, 0.4, 1};
  of(Element::tet10) = {15, 1.4, 25, 5, 9, 5, 6};
}

RunCost CostModel::refined(const RunCost& cost, std::optional<Element> element, double levels) const {
  const OfElement& e = of(element);
  RunCost c = cost;
  for (double* counted : {&c.factor_s, &c.factor_work})
    *counted *= std::pow(e.entries_growth, e.seconds_power * levels);
  c.factor_bytes *= std::pow(e.entries_growth, levels);
  for (double* counted : {&c.other_s, &c.other_work, &c.other_bytes, &c.unknowns, &c.cells})
    *counted *= std::pow(kCells, levels);
  return c;
}

RunCost CostModel::grown(const RunCost& cost, std::optional<Element> element, double cells) const {
  return refined(cost, element, std::log(cells) / std::log(kCells));
}

RunCost CostModel::with_element(const RunCost& cost, Element from, Element to) const {
  const OfElement &a = of(from), &b = of(to);
  RunCost c = cost;
  for (double* counted : {&c.factor_s, &c.factor_work}) *counted *= b.factor_s / a.factor_s;
  for (double* counted : {&c.other_s, &c.other_work}) *counted *= b.other_s / a.other_s;
  c.factor_bytes *= b.factor_bytes / a.factor_bytes;
  c.other_bytes *= b.other_bytes / a.other_bytes;
  c.unknowns *= b.unknowns / a.unknowns;
  return c;
}

}  // namespace isochor
