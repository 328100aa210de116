#include "engine/system/structure.h"

#include <algorithm>

namespace isochor {

namespace {

bool same(const Lists& a, const Lists& b) {
  return &a == &b || (a.offset == b.offset && a.item == b.item);
}

bool same(const StencilPool& a, const StencilPool& b) {
  const StencilShape p = a.shape(), q = b.shape();
  const StencilFacets f = a.facets(), g = b.facets();
  return p.energy == q.energy && p.functions == q.functions && p.hessian == q.hessian &&
         !f.lagged == !g.lagged && !f.remembering == !g.remembering && !f.barrier == !g.barrier &&
         !f.renewed == !g.renewed && same(a.nodes(), b.nodes());
}

bool same_places(const std::vector<ComplianceEntry>& a, const std::vector<ComplianceEntry>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const auto& p, const auto& q) { return p.row == q.row && p.col == q.col; });
}

bool same(const RowPool& a, const RowPool& b) {
  return a.law == b.law && a.stencil_pool == b.stencil_pool && a.treatment == b.treatment &&
         (a.facets().law != nullptr) == (b.facets().law != nullptr) && a.lower.empty() == b.lower.empty() &&
         a.upper.empty() == b.upper.empty() && same(a.map, b.map) && a.weight == b.weight &&
         same_places(a.compliance, b.compliance);
}

bool same(const Prescriber& a, const Prescriber& b) {
  return std::equal(a.nodes.begin(), a.nodes.end(), b.nodes.begin(), b.nodes.end(),
                    [](const PrescribedNode& p, const PrescribedNode& q) {
                      return p.node == q.node && p.directions == q.directions && p.direction == q.direction;
                    });
}

template <class T>
bool same_list(const std::vector<std::shared_ptr<const T>>& a,
               const std::vector<std::shared_ptr<const T>>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const auto& p, const auto& q) { return p == q || same(*p, *q); });
}

}  // namespace

namespace {

template <class T>
std::size_t bytes(const std::vector<T>& list) {
  return list.capacity() * sizeof(T);
}

std::size_t bytes(const Gather& g) {
  return bytes(g.offset) + bytes(g.source) + bytes(g.weight);
}

std::size_t bytes(const FilledRows& r) {
  return bytes(r.row) + bytes(r.place);
}

}  // namespace

std::size_t System::table_bytes() const {
  const auto& [unknowns, gathers, treated, matrix, pools, shares, layout] = *tables_;
  const auto& pattern = matrix.pattern;
  std::size_t shared = shares ? shares->bytes() + bytes(pattern.owner) : 0;
  for (const auto& runs : pools.runs) shared += bytes(runs);
  return bytes(unknowns.first) + bytes(unknowns.basis_of) + bytes(unknowns.bases) + bytes(gathers.row) +
         bytes(gathers.function) + bytes(gathers.residual) + bytes(gathers.block) + bytes(gathers.jacobian) +
         bytes(gathers.block_ends) + bytes(gathers.jacobian_ends) + bytes(gathers.row_begin) +
         bytes(treated.kept) + bytes(treated.unknown) + bytes(treated.condensed) + bytes(treated.augmented) +
         bytes(treated.bordered) + bytes(treated.dual) + bytes(matrix.block) + bytes(matrix.jacobian) +
         bytes(matrix.compliance) + bytes(matrix.diagonal) + bytes(pattern.column_start) +
         bytes(pattern.row) + bytes(pattern.group) + bytes(pools.slots) + shared;
}

bool same_structure(const SystemParts& a, const SystemParts& b) {
  return a.rest.size() == b.rest.size() && a.ranks == b.ranks && a.treatment == b.treatment &&
         a.border_wide_rows == b.border_wide_rows && same_list(a.stencil_pools, b.stencil_pools) &&
         same_list(a.row_pools, b.row_pools) && same_list(a.prescribers, b.prescribers);
}

bool same_treatment(const TreatedRows& a, const TreatedRows& b) {
  return a.kept == b.kept && a.condensed.row == b.condensed.row && a.bordered == b.bordered &&
         a.dual == b.dual && a.augmented.row == b.augmented.row && a.dual_compliance == b.dual_compliance;
}

}  // namespace isochor
