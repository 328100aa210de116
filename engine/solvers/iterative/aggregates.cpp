#include "engine/solvers/iterative/aggregates.h"

namespace isochor {

Index aggregate_nodes(const BlockMatrix& pattern, std::vector<Index>& aggregate) {
  const auto neighbors = [&](Index i) {
    return std::span<const Index>(pattern.column)
        .subspan(static_cast<std::size_t>(pattern.start[at(i)]),
                 static_cast<std::size_t>(pattern.start[at(i) + 1] - pattern.start[at(i)]));
  };
  aggregate.assign(at(pattern.rows), -1);
  std::vector<Index> size;
  for (Index i = 0; i < pattern.rows; ++i) {
    bool free = true;
    for (const Index j : neighbors(i)) free = free && aggregate[at(j)] < 0;
    if (!free) continue;
    for (const Index j : neighbors(i)) aggregate[at(j)] = static_cast<Index>(size.size());
    size.push_back(static_cast<Index>(neighbors(i).size()));
  }
  // Only aggregates of the first pass are joined, so that none grows into a chain.
  const auto seeds = static_cast<Index>(size.size());
  std::vector<Index> joined(aggregate);
  for (Index i = 0; i < pattern.rows; ++i) {
    if (aggregate[at(i)] >= 0) continue;
    Index best = -1;
    for (const Index j : neighbors(i)) {
      const Index a = aggregate[at(j)];
      if (a >= 0 && (best < 0 || size[at(a)] < size[at(best)])) best = a;
    }
    if (best < 0) continue;
    joined[at(i)] = best;
    ++size[at(best)];
  }
  aggregate = std::move(joined);
  Index count = seeds;
  for (Index i = 0; i < pattern.rows; ++i) {
    if (aggregate[at(i)] >= 0) continue;
    for (const Index j : neighbors(i)) {
      if (aggregate[at(j)] < 0) aggregate[at(j)] = count;
    }
    aggregate[at(i)] = count++;
  }
  return count;
}

}  // namespace isochor
