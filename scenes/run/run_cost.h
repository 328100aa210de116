// What a run takes, and what it would take with another element or on a finer mesh.
#pragma once

#include <array>
#include <optional>

#include "scenes/run/run.h"

namespace isochor {

struct RunCost {
  double factor_s = 0, other_s = 0;  // of factorizations, and of all else [s]
  // The same as counted and not by the clock, in seconds of some machine: choices by it repeat themselves.
  double factor_work = 0, other_work = 0;
  double factor_bytes = 0, other_bytes = 0;  // of factors, and of the engine's arrays
  double unknowns = 0, cells = 0;
  double seconds() const { return factor_s + other_s; }
  double work() const { return factor_work + other_work; }
  double bytes() const { return factor_bytes + other_bytes; }
};

// As measured and counted.
RunCost cost_of(const RunResult& result, std::optional<Element> element);

// Evaluations, arrays and unknowns are counted by cells. The entries of the factor are not, and the seconds
// of a factorization follow its entries by a power that holds both the operations, entries^(3/2) for nested
// dissection in three dimensions, and the higher rate of larger fronts.
class CostModel {
 public:
  struct OfElement {
    double entries_growth = 15;  // of the factor, when every cell is cut into eight
    double seconds_power = 1.4;  // seconds of a factorization ~ entries^power
    // Against edge-smoothed Tet4 on the same mesh of tets.
    double factor_s = 1, other_s = 1, factor_bytes = 1, other_bytes = 1, unknowns = 1;
  };

  CostModel();  // as measured on one machine, where nothing better is known
  OfElement& of(std::optional<Element> element) { return elements_[index(element)]; }
  const OfElement& of(std::optional<Element> element) const { return elements_[index(element)]; }

  // With every cell cut into eight, `levels` times; a part of a level for meshes that grow by less.
  RunCost refined(const RunCost& cost, std::optional<Element> element, double levels) const;
  // With so many times the cells.
  RunCost grown(const RunCost& cost, std::optional<Element> element, double cells) const;
  // From one element to another on the same mesh of tets.
  RunCost with_element(const RunCost& cost, Element from, Element to) const;

 private:
  // Bodies of several elements are taken for edge-smoothed ones.
  static std::size_t index(std::optional<Element> element) {
    return static_cast<std::size_t>(element.value_or(Element::tet4_edge_smoothed));
  }
  std::array<OfElement, 4> elements_;
};

}  // namespace isochor
