#include "engine/system/row_treatment.h"

#include <algorithm>

#include "engine/base/text.h"

namespace isochor {

static bool bounded(const RowPool& pool) {
  return !pool.lower.empty() || !pool.upper.empty();
}

// A pool that is left to us is condensed when that fills no new place and loses no digits: every row lies
// within one stencil and has a compliance of its own that is not tiny. Everything else is kept; the
// ordering puts rows over everything last, which costs what a border does.
RowTreatment RowTreatments::choose(const RowPool& pool) const {
  constexpr double smallest = 1e-6;  // compliance against the row metric: mu / kappa for volume rows
  if (pool.treatment != RowTreatment::automatic) return pool.treatment;
  if (couples(pool)) return RowTreatment::saddle;
  switch (system_.parts().treatment) {
    case RowTreatment::automatic:
      break;
    case RowTreatment::condensed:
      if (!bounded(pool) && few_wide_rows(pool))
        return system_.couples() ? RowTreatment::saddle : RowTreatment::bordered;
      return check_condensed(pool, "") ? RowTreatment::condensed : RowTreatment::saddle;
    case RowTreatment::dual:
    case RowTreatment::augmented:
      if (!system_.parts().border_wide_rows || !few_wide_rows(pool)) return system_.parts().treatment;
      return bounded(pool) ? RowTreatment::dual : RowTreatment::bordered;
    case RowTreatment::saddle:
    case RowTreatment::bordered:
      return RowTreatment::saddle;
  }
  if (pool.rows() == 0 || !check_condensed(pool, "")) return RowTreatment::saddle;
  if (over_several_stencils(pool)) return RowTreatment::saddle;
  for (const ComplianceEntry& e : pool.compliance) {
    if (e.value < smallest * pool.metric[at(e.row)]) return RowTreatment::saddle;
  }
  return RowTreatment::condensed;
}

bool RowTreatments::over_several_stencils(const RowPool& pool) const {
  const Index functions = system_.parts().stencil_pools[at(pool.stencil_pool)]->functions();
  for (Index r = 0; r < pool.rows(); ++r) {
    for (const Index f : pool.map[r]) {
      if (f / functions != pool.map[r][0] / functions) return true;
    }
  }
  return false;
}

bool RowTreatments::couples(const RowPool& pool) const {
  if (!system_.couples()) return false;
  const LaggedStencils* lagged = system_.parts().stencil_pools[at(pool.stencil_pool)]->facets().lagged;
  return lagged && lagged->couples();
}

// Rows over whole bodies: bordered where the matrix is that of the stiffness.
bool RowTreatments::few_wide_rows(const RowPool& pool) const {
  constexpr Index few = 16;
  if (pool.rows() == 0 || pool.rows() > few) return false;
  const Index first = system_.row_data().first[at(index_of(pool))];
  for (Index r = first; r < first + pool.rows(); ++r) {
    if (nodes_of_row(r) > local_row_nodes) return true;
  }
  return false;
}

Index RowTreatments::index_of(const RowPool& pool) const {
  const auto& pools = system_.parts().row_pools;
  return static_cast<Index>(
      std::find_if(pools.begin(), pools.end(), [&](const auto& p) { return p.get() == &pool; }) -
      pools.begin());
}

std::size_t RowTreatments::nodes_of_row(Index row) const {
  return system_.gathers().row_begin[at(row) + 1] - system_.gathers().row_begin[at(row)];
}

Result<void> RowTreatments::sort() {
  const auto& pools = system_.parts().row_pools;
  for (std::size_t p = 0; p < pools.size(); ++p) {
    const RowPool& pool = *pools[p];
    if (pool.law != RowLaw::compliant) continue;
    if (auto r = check_wish(pool); !r) return r;
    RowTreatment treatment = choose(pool);
    // Of rows over several stencils each rank has a part alone, and condensing one takes all of it. As an
    // unknown of the matrix it has the same solution.
    if (treatment == RowTreatment::condensed && system_.shares() && over_several_stencils(pool))
      treatment = RowTreatment::saddle;
    auto& list = list_of(treatment);
    for (Index r = 0; r < pool.rows(); ++r) {
      const Index row = system_.row_data().first[p] + r;
      list.push_back(row);
      if (treatment == RowTreatment::augmented && nodes_of_row(row) <= local_row_nodes)
        rows_.augmented.row.push_back(row);
    }
  }
  rows_.unknown.assign(at(system_.rows()), -1);
  for (std::size_t k = 0; k < rows_.kept.size(); ++k)
    rows_.unknown[at(rows_.kept[k])] = system_.free_unknowns() + static_cast<Index>(k);
  collect_compliance();
  return {};
}

// What a pool asks for and cannot have.
Result<void> RowTreatments::check_wish(const RowPool& pool) const {
  const std::string who = "rows \"" + std::string(pool.name()) + "\": ";
  if (couples(pool) && pool.treatment != RowTreatment::automatic && pool.treatment != RowTreatment::saddle) {
    return Error{
        who +
        "their part of the matrix is unsymmetric (they are coupled), so they are unknowns of it; use "
        "treatment saddle or automatic"};
  }
  if (pool.treatment == RowTreatment::condensed) return check_condensed(pool, who);
  if (pool.treatment != RowTreatment::bordered) return {};
  if (system_.couples()) {
    return Error{who +
                 "bordered rows want a symmetric matrix, and an effect of this scene is coupled; use "
                 "treatment saddle for them, or that effect lagged"};
  }
  if (bounded(pool)) {
    return Error{who +
                 "rows with bounds change between free and held, so they are not bordered; use treatment "
                 "saddle or automatic"};
  }
  if (static_cast<Index>(rows_.bordered.size()) + pool.rows() > most_bordered_rows) {
    return Error{who + std::to_string(pool.rows()) +
                 " rows to border; each costs a solve a factorization, so " +
                 std::to_string(most_bordered_rows) + " in a scene are the limit; use treatment saddle"};
  }
  return {};
}

// The compliance entries of bordered and of dual rows. Those of one entry are of one pool, and treated alike.
void RowTreatments::collect_compliance() {
  std::vector<Index> border(at(system_.rows()), -1);
  for (std::size_t k = 0; k < rows_.bordered.size(); ++k)
    border[at(rows_.bordered[k])] = static_cast<Index>(k);
  std::vector<bool> dual(at(system_.rows()), false);
  for (const Index r : rows_.dual) dual[at(r)] = true;
  const auto entries = system_.compliance();
  for (std::size_t k = 0; k < entries.size(); ++k) {
    const ComplianceEntry& e = entries[k];
    if (border[at(e.row)] >= 0) rows_.border_compliance.push_back({k, border[at(e.row)], border[at(e.col)]});
    if (dual[at(e.row)]) rows_.dual_compliance.push_back(k);
  }
}

std::vector<Index>& RowTreatments::list_of(RowTreatment treatment) {
  switch (treatment) {
    case RowTreatment::condensed:
      return rows_.condensed.row;
    case RowTreatment::bordered:
      return rows_.bordered;
    case RowTreatment::dual:
    case RowTreatment::augmented:
      return rows_.dual;
    case RowTreatment::automatic:
    case RowTreatment::saddle:
      break;
  }
  return rows_.kept;
}

Result<void> RowTreatments::check_condensed(const RowPool& pool, const std::string& who) {
  if (const LawRows* law = pool.facets().law; law && !law->local()) {
    return Error{who + "a row with a law of its own is not condensed; use treatment saddle or bordered"};
  }
  std::vector<double> diagonal(at(pool.rows()), 0);
  for (const ComplianceEntry& e : pool.compliance) {
    if (e.row == e.col) diagonal[at(e.row)] += e.value;
    if (e.row != e.col && e.value != 0) {
      return Error{
          who + "their compliance couples rows " + std::to_string(e.col) + " and " + std::to_string(e.row) +
          " (a consistent or stabilized one does), so they cannot be condensed one by one; use treatment "
          "saddle, or a lumped compliance, which is another model"};
    }
  }
  for (Index r = 0; r < pool.rows(); ++r) {
    if (diagonal[at(r)] > 0) continue;
    return Error{who + "row " + std::to_string(r) + " is hard (compliance " + number(diagonal[at(r)]) +
                 "), so there is nothing to condense it with: K + G^T G / C needs C > 0; use treatment "
                 "saddle, or nu < "
                 "0.5"};
  }
  return {};
}

}  // namespace isochor
