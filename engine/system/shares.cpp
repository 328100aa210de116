#include "engine/system/shares.h"

#include <algorithm>
#include <numeric>

namespace isochor {

Shares::Shares(std::shared_ptr<const Ranks> ranks, std::vector<Index> node_owner)
    : ranks_(std::move(ranks)), rank_(static_cast<Index>(ranks_->rank())) {
  nodes_ = plan(std::move(node_owner));
}

void Shares::share_unknowns(std::span<const Index> first) {
  std::vector<Index> owner(at(first.back()));
  for (std::size_t i = 0; i + 1 < first.size(); ++i)
    std::fill(owner.begin() + first[i], owner.begin() + first[i + 1], nodes_.owner[i]);
  unknowns_ = plan(std::move(owner));
}

void Shares::share_rows(std::vector<Index> row_owner) {
  rows_ = plan(std::move(row_owner));
}

std::span<const Index> Shares::Plan::of(Index rank) const {
  const auto from = static_cast<std::size_t>(begin[at(rank)]),
             to = static_cast<std::size_t>(begin[at(rank) + 1]);
  return std::span(item).subspan(from, to - from);
}

Shares::Plan Shares::plan(std::vector<Index> owner) const {
  Plan p;
  p.begin.assign(static_cast<std::size_t>(ranks_->size()) + 1, 0);
  for (const Index r : owner) ++p.begin[at(r) + 1];
  std::partial_sum(p.begin.begin(), p.begin.end(), p.begin.begin());
  p.item.resize(owner.size());
  std::vector<std::int64_t> next(p.begin.begin(), p.begin.end() - 1);
  for (std::size_t i = 0; i < owner.size(); ++i)
    p.item[static_cast<std::size_t>(next[at(owner[i])]++)] = static_cast<Index>(i);
  p.owner = std::move(owner);
  return p;
}

void Shares::gather(const Plan& plan, double* values, std::size_t numbers) const {
  std::vector<double> packed(numbers * plan.item.size());
  std::vector<std::int64_t> begin(plan.begin);
  for (std::int64_t& b : begin) b *= static_cast<std::int64_t>(numbers);
  auto to = packed.begin() + begin[at(rank_)];
  for (const Index i : plan.of(rank_)) to = std::copy_n(values + numbers * at(i), numbers, to);
  ranks_->gather(packed, begin);
  const double* from = packed.data();
  for (const Index i : plan.item) {
    std::copy_n(from, numbers, values + numbers * at(i));
    from += numbers;
  }
}

void Shares::gather_nodes(std::span<Vec3> values) const {
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  if (!values.empty()) gather(nodes_, &values.data()->x, 3);
}

void Shares::gather_nodes(std::span<double> values, std::size_t numbers_a_node) const {
  gather(nodes_, values.data(), numbers_a_node);
}

void Shares::gather_unknowns(std::span<double> values) const {
  gather(unknowns_, values.data(), 1);
}

void Shares::gather_rows(std::span<double> values) const {
  gather(rows_, values.data(), 1);
}

std::size_t Shares::bytes() const {
  std::size_t sum = 0;
  for (const Plan* p : {&nodes_, &unknowns_, &rows_})
    sum += (p->owner.size() + p->item.size()) * sizeof(Index);
  return sum;
}

}  // namespace isochor
