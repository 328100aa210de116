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
  switch (system_.parts_.treatment) {
    case RowTreatment::automatic:
      break;
    case RowTreatment::condensed:
      if (!bounded(pool) && few_wide_rows(pool))
        return system_.couples() ? RowTreatment::saddle : RowTreatment::bordered;
      return check_condensed(pool, "") ? RowTreatment::condensed : RowTreatment::saddle;
    case RowTreatment::dual:
    case RowTreatment::augmented:
      if (!system_.parts_.border_wide_rows || !few_wide_rows(pool)) return system_.parts_.treatment;
      return bounded(pool) ? RowTreatment::dual : RowTreatment::bordered;
    case RowTreatment::saddle:
    case RowTreatment::bordered:
      return RowTreatment::saddle;
  }
  if (pool.rows() == 0 || !check_condensed(pool, "")) return RowTreatment::saddle;
  const Index functions = system_.parts_.stencil_pools[at(pool.stencil_pool)]->functions();
  for (Index r = 0; r < pool.rows(); ++r) {
    for (const Index f : pool.map[r]) {
      if (f / functions != pool.map[r][0] / functions) return RowTreatment::saddle;
    }
  }
  for (const ComplianceEntry& e : pool.compliance) {
    if (e.value < smallest * pool.metric[at(e.row)]) return RowTreatment::saddle;
  }
  return RowTreatment::condensed;
}

bool RowTreatments::couples(const RowPool& pool) const {
  if (!system_.couples()) return false;
  const LaggedStencils* lagged = system_.parts_.stencil_pools[at(pool.stencil_pool)]->facets().lagged;
  return lagged && lagged->couples();
}

// Rows over whole bodies: bordered where the matrix is that of the stiffness.
bool RowTreatments::few_wide_rows(const RowPool& pool) const {
  constexpr Index few = 16;
  if (pool.rows() == 0 || pool.rows() > few) return false;
  const Index first = system_.first_row_[at(index_of(pool))];
  for (Index r = first; r < first + pool.rows(); ++r) {
    if (nodes_of_row(r) > local_row_nodes) return true;
  }
  return false;
}

Index RowTreatments::index_of(const RowPool& pool) const {
  const auto& pools = system_.parts_.row_pools;
  return static_cast<Index>(
      std::find_if(pools.begin(), pools.end(), [&](const auto& p) { return p.get() == &pool; }) -
      pools.begin());
}

std::size_t RowTreatments::nodes_of_row(Index row) const {
  return system_.row_jacobian_begin_[at(row) + 1] - system_.row_jacobian_begin_[at(row)];
}

// Which rows are unknowns of the matrix.
Result<void> RowTreatments::sort() {
  constexpr Index border_limit = 64;
  system_.row_unknown_.assign(at(system_.rows_), -1);
  system_.diagonal_compliance_.assign(at(system_.rows_), 0);
  for (std::size_t k = 0; k < system_.compliance_.size(); ++k) {
    const ComplianceEntry& e = system_.compliance_[k];
    if (e.row == e.col) system_.diagonal_compliance_[at(e.row)] = k;
  }
  system_.row_jacobian_begin_.assign(at(system_.rows_) + 1, 0);
  std::vector<Index> augmented;
  for (const auto& [row, node] : system_.jacobian_ends_) ++system_.row_jacobian_begin_[at(row) + 1];
  for (std::size_t r = 0; r < at(system_.rows_); ++r)
    system_.row_jacobian_begin_[r + 1] += system_.row_jacobian_begin_[r];
  for (std::size_t p = 0; p < system_.parts_.row_pools.size(); ++p) {
    const RowPool& pool = *system_.parts_.row_pools[p];
    if (pool.law != RowLaw::compliant) continue;
    const std::string who = "rows \"" + std::string(pool.name()) + "\": ";
    if (couples(pool) && pool.treatment != RowTreatment::automatic &&
        pool.treatment != RowTreatment::saddle) {
      return Error{
          who +
          "their part of the matrix is unsymmetric (they are coupled), so they are unknowns of it; use "
          "treatment saddle or automatic"};
    }
    if (system_.couples() && pool.treatment == RowTreatment::bordered) {
      return Error{who +
                   "bordered rows want a symmetric matrix, and an effect of this scene is coupled; use "
                   "treatment saddle for them, or that effect lagged"};
    }
    if (pool.treatment == RowTreatment::bordered && bounded(pool)) {
      return Error{who +
                   "rows with bounds change between free and held, so they are not bordered; use treatment "
                   "saddle or automatic"};
    }
    if (pool.treatment == RowTreatment::condensed) {
      if (auto r = check_condensed(pool, who); !r) return r;
    }
    if (pool.treatment == RowTreatment::bordered &&
        static_cast<Index>(system_.bordered_rows_.size()) + pool.rows() > border_limit) {
      return Error{who + std::to_string(pool.rows()) +
                   " rows to border; each costs a solve a factorization, so " + std::to_string(border_limit) +
                   " in a scene are the limit; use treatment saddle"};
    }
    const RowTreatment treatment = choose(pool);
    auto& list = list_of(treatment);
    for (Index r = 0; r < pool.rows(); ++r) {
      const Index row = system_.first_row_[p] + r;
      list.push_back(row);
      if (treatment == RowTreatment::augmented && nodes_of_row(row) <= local_row_nodes)
        augmented.push_back(row);
    }
  }
  system_.filled_rows_ = system_.condensed_rows_;
  system_.filled_rows_.insert(system_.filled_rows_.end(), augmented.begin(), augmented.end());
  for (std::size_t k = 0; k < system_.kept_rows_.size(); ++k) {
    system_.row_unknown_[at(system_.kept_rows_[k])] = system_.free_unknowns() + static_cast<Index>(k);
  }
  std::vector<Index> border(at(system_.rows_), -1);
  for (std::size_t k = 0; k < system_.bordered_rows_.size(); ++k)
    border[at(system_.bordered_rows_[k])] = static_cast<Index>(k);
  for (std::size_t k = 0; k < system_.compliance_.size(); ++k) {
    const ComplianceEntry& e = system_.compliance_[k];
    if (border[at(e.row)] >= 0)
      system_.border_compliance_.push_back({k, border[at(e.row)], border[at(e.col)]});
  }
  std::vector<bool> dual(at(system_.rows_), false);
  for (const Index r : system_.dual_rows_) dual[at(r)] = true;
  for (std::size_t k = 0; k < system_.compliance_.size(); ++k) {
    if (dual[at(system_.compliance_[k].row)]) system_.dual_compliance_.push_back(k);
  }
  return {};
}

std::vector<Index>& RowTreatments::list_of(RowTreatment treatment) {
  switch (treatment) {
    case RowTreatment::condensed:
      return system_.condensed_rows_;
    case RowTreatment::bordered:
      return system_.bordered_rows_;
    case RowTreatment::dual:
    case RowTreatment::augmented:
      return system_.dual_rows_;
    case RowTreatment::automatic:
    case RowTreatment::saddle:
      break;
  }
  return system_.kept_rows_;
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
