#include "engine/solvers/front/front_tree.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <utility>

#include "engine/base/base.h"

namespace isochor {
namespace {

// The lower triangle by columns, or its transpose, in the sequence of elimination.
struct Columns {
  std::vector<std::int64_t> start;
  std::vector<Index> row;
};

// below: rows behind the pivot of each column; otherwise those before it.
Columns permuted(const SymmetricPattern& p, std::span<const Index> position, bool below) {
  Columns c;
  c.start.assign(at(p.size) + 1, 0);
  const auto each = [&](auto&& visit) {
    for (Index j = 0; j < p.size; ++j) {
      for (auto k = p.column_start[at(j)]; k < p.column_start[at(j) + 1]; ++k) {
        const Index a = position[at(j)], b = position[at(p.row[static_cast<std::size_t>(k)])];
        if (a != b) visit(below ? std::min(a, b) : std::max(a, b), below ? std::max(a, b) : std::min(a, b));
      }
    }
  };
  each([&](Index column, Index) { ++c.start[at(column) + 1]; });
  std::partial_sum(c.start.begin(), c.start.end(), c.start.begin());
  c.row.resize(static_cast<std::size_t>(c.start.back()));
  std::vector<std::int64_t> next(c.start.begin(), c.start.end() - 1);
  each([&](Index column, Index row) { c.row[static_cast<std::size_t>(next[at(column)]++)] = row; });
  return c;
}

// Elimination tree (Liu 1986).
std::vector<Index> elimination_tree(const Columns& before) {
  const auto n = before.start.size() - 1;
  std::vector<Index> parent(n, -1), ancestor(n, -1);
  for (std::size_t j = 0; j < n; ++j) {
    for (auto k = before.start[j]; k < before.start[j + 1]; ++k) {
      for (Index i = before.row[static_cast<std::size_t>(k)]; i != -1 && i < static_cast<Index>(j);) {
        const Index next = ancestor[at(i)];
        ancestor[at(i)] = static_cast<Index>(j);
        if (next == -1) parent[at(i)] = static_cast<Index>(j);
        i = next;
      }
    }
  }
  return parent;
}

// Children before parents, the child with the longest column last: it is the one to merge with.
std::vector<Index> postorder(std::span<const Index> parent, std::span<const Index> weight) {
  const auto n = static_cast<Index>(parent.size());
  std::vector<Index> by_weight(at(n)), first(at(n), -1), next(at(n), -1), order, stack;
  std::iota(by_weight.begin(), by_weight.end(), 0);
  if (!weight.empty()) {
    std::stable_sort(by_weight.begin(), by_weight.end(),
                     [&](Index a, Index b) { return weight[at(a)] > weight[at(b)]; });
  } else {
    std::reverse(by_weight.begin(), by_weight.end());
  }
  for (const Index j : by_weight) {
    if (parent[at(j)] < 0) continue;
    next[at(j)] = first[at(parent[at(j)])];
    first[at(parent[at(j)])] = j;
  }
  order.reserve(at(n));
  for (Index root = 0; root < n; ++root) {
    if (parent[at(root)] >= 0) continue;
    stack.push_back(root);
    while (!stack.empty()) {
      const Index j = stack.back(), child = first[at(j)];
      if (child >= 0) {
        first[at(j)] = next[at(child)];
        stack.push_back(child);
      } else {
        order.push_back(j);
        stack.pop_back();
      }
    }
  }
  return order;
}

// Entries of each column of L, diagonal included (Gilbert, Ng & Peyton 1994).
std::vector<Index> column_counts(const Columns& below, std::span<const Index> parent,
                                 std::span<const Index> post) {
  const auto n = static_cast<Index>(parent.size());
  std::vector<Index> count(at(n), 0), first(at(n), -1), largest_first(at(n), -1), previous_leaf(at(n), -1),
      ancestor(at(n));
  std::iota(ancestor.begin(), ancestor.end(), 0);
  for (Index k = 0; k < n; ++k) {
    Index j = post[at(k)];
    count[at(j)] = first[at(j)] == -1 ? 1 : 0;
    for (; j != -1 && first[at(j)] == -1; j = parent[at(j)]) first[at(j)] = k;
  }
  for (Index k = 0; k < n; ++k) {
    const Index j = post[at(k)];
    if (parent[at(j)] >= 0) --count[at(parent[at(j)])];
    for (auto e = below.start[at(j)]; e < below.start[at(j) + 1]; ++e) {
      const Index i = below.row[static_cast<std::size_t>(e)];
      if (first[at(j)] <= largest_first[at(i)]) continue;  // j is no leaf of the row subtree of i
      largest_first[at(i)] = first[at(j)];
      const Index previous = previous_leaf[at(i)];
      previous_leaf[at(i)] = j;
      ++count[at(j)];
      if (previous < 0) continue;
      // Both leaves counted the path from their lowest common ancestor upward.
      Index q = previous;
      while (q != ancestor[at(q)]) q = ancestor[at(q)];
      for (Index s = previous; s != q;) {
        const Index up = ancestor[at(s)];
        ancestor[at(s)] = q;
        s = up;
      }
      --count[at(q)];
    }
    if (parent[at(j)] >= 0) ancestor[at(j)] = parent[at(j)];
  }
  for (Index k = 0; k < n; ++k) {
    const Index j = post[at(k)];
    if (parent[at(j)] >= 0) count[at(parent[at(j)])] += count[at(j)];
  }
  return count;
}

double operations_of_counts(std::span<const Index> count) {
  double sum = 0;
  for (const Index c : count) sum += 0.5 * (c - 1.0) * (c + 2.0);
  return sum;
}

// Zeros that a merger may add, by the number of its columns (as CHOLMOD has it).
bool worth_merging(double columns, double zeros, double entries) {
  if (columns <= 4) return true;
  const double share = zeros / entries;
  return columns <= 16 ? share < 0.8 : (columns <= 48 ? share < 0.1 : share < 0.05);
}

struct Supernodes {
  std::vector<Index> first;  // pivots, one more at the end
  std::vector<Index> parent, count;
};

// Columns with the same structure, then neighbors with almost the same.
Supernodes supernodes(std::span<const Index> parent, std::span<const Index> count) {
  const auto n = static_cast<Index>(parent.size());
  Supernodes s;
  std::vector<Index> of(at(n));
  for (Index j = 0; j < n; ++j) {
    const bool same = j > 0 && parent[at(j) - 1] == j && count[at(j) - 1] == count[at(j)] + 1;
    if (!same) {
      s.first.push_back(j);
      s.count.push_back(count[at(j)]);
    }
    of[at(j)] = static_cast<Index>(s.first.size()) - 1;
  }
  s.first.push_back(n);
  const auto m = static_cast<Index>(s.count.size());
  s.parent.assign(at(m), -1);
  for (Index f = 0; f < m; ++f) {
    const Index up = parent[at(s.first[at(f) + 1]) - 1];
    if (up >= 0) s.parent[at(f)] = of[at(up)];
  }
  // From the end: each may join what is right behind it when its parent is there. `head` leads to the first
  // of those that have merged.
  std::vector<Index> end(at(m)), head(at(m)), rows(s.count);
  const auto head_of = [&](Index f) {
    while (head[at(f)] != f) f = head[at(f)] = head[at(head[at(f)])];
    return f;
  };
  std::vector<double> zeros(at(m), 0);
  std::vector<std::uint8_t> gone(at(m), 0);
  std::iota(head.begin(), head.end(), 0);
  for (Index f = 0; f < m; ++f) end[at(f)] = s.first[at(f) + 1];
  for (Index f = m - 2; f >= 0; --f) {
    if (s.parent[at(f)] < 0 || head_of(s.parent[at(f)]) != f + 1) continue;
    const double k0 = end[at(f)] - s.first[at(f)], k1 = end[at(f) + 1] - s.first[at(f) + 1];
    const double m0 = rows[at(f)], m1 = rows[at(f) + 1];
    const double columns = k0 + k1;
    const double added = k0 * (k0 + m1 - m0);
    const double z = added + zeros[at(f)] + zeros[at(f) + 1];
    const double entries = 0.5 * columns * (columns + 1) + columns * (m1 - k1);
    if (!worth_merging(columns, z, entries)) continue;
    zeros[at(f)] = z;
    end[at(f)] = end[at(f) + 1];
    rows[at(f)] = static_cast<Index>(k0 + m1);
    s.parent[at(f)] = s.parent[at(f) + 1];
    gone[at(f) + 1] = 1;
    head[at(f) + 1] = f;
  }
  Supernodes merged;
  std::vector<Index> number(at(m));
  for (Index f = 0; f < m; ++f) {
    if (!gone[at(f)]) {
      merged.first.push_back(s.first[at(f)]);
      merged.count.push_back(rows[at(f)]);
      merged.parent.push_back(s.parent[at(f)]);
    }
    number[at(f)] = static_cast<Index>(merged.count.size()) - 1;
  }
  merged.first.push_back(n);
  for (Index& p : merged.parent) p = p < 0 ? -1 : number[at(p)];
  return merged;
}

struct Analysis {
  std::vector<Index> unknown, position, parent, count;
};

// The ordering, its tree and counts, renumbered by a postorder.
Analysis analysis_of(const SymmetricPattern& pattern, const Ordering& ordering) {
  Analysis a;
  const auto n = at(pattern.size);
  std::vector<Index> parent = elimination_tree(permuted(pattern, ordering.position, false));
  const Columns below = permuted(pattern, ordering.position, true);
  std::vector<Index> count = column_counts(below, parent, postorder(parent, {}));
  const std::vector<Index> post = postorder(parent, count);
  std::vector<Index> rank(n);
  for (std::size_t k = 0; k < n; ++k) rank[at(post[k])] = static_cast<Index>(k);
  a.unknown.resize(n);
  a.position.resize(n);
  a.parent.resize(n);
  a.count.resize(n);
  for (std::size_t k = 0; k < n; ++k) {
    const Index j = post[k];
    a.unknown[k] = ordering.unknown[at(j)];
    a.position[at(a.unknown[k])] = static_cast<Index>(k);
    a.parent[k] = parent[at(j)] < 0 ? -1 : rank[at(parent[at(j)])];
    a.count[k] = count[at(j)];
  }
  return a;
}

void find_rows(FrontTree& t, const Columns& below) {
  const Index m = t.fronts();
  std::vector<Index> mark(at(t.size), -1);
  t.row_start = {0};
  for (Index f = 0; f < m; ++f) {
    const Index end = t.first_pivot[at(f) + 1];
    const auto begin = t.row.size();
    const auto take = [&](Index i) {
      if (i < end || mark[at(i)] == f) return;
      mark[at(i)] = f;
      t.row.push_back(i);
    };
    for (Index j = t.first_pivot[at(f)]; j < end; ++j) {
      for (auto k = below.start[at(j)]; k < below.start[at(j) + 1]; ++k)
        take(below.row[static_cast<std::size_t>(k)]);
    }
    for (Index c = t.child_start[at(f)]; c < t.child_start[at(f) + 1]; ++c) {
      const Index child = t.child[at(c)];
      for (auto k = t.row_start[at(child)]; k < t.row_start[at(child) + 1]; ++k)
        take(t.row[static_cast<std::size_t>(k)]);
    }
    std::sort(t.row.begin() + static_cast<std::ptrdiff_t>(begin), t.row.end());
    t.row_start.push_back(static_cast<std::int64_t>(t.row.size()));
  }
  t.place_in_parent.resize(t.row.size());
  for (Index f = 0; f < m; ++f) {
    const Index up = t.parent[at(f)];
    if (up < 0) continue;
    const Index first = t.first_pivot[at(up)], end = t.first_pivot[at(up) + 1];
    auto q = t.row_start[at(up)];
    for (auto k = t.row_start[at(f)]; k < t.row_start[at(f) + 1]; ++k) {
      const Index i = t.row[static_cast<std::size_t>(k)];
      if (i >= end) {
        while (t.row[static_cast<std::size_t>(q)] < i) ++q;
      }
      t.place_in_parent[static_cast<std::size_t>(k)] =
          i < end ? i - first : end - first + static_cast<Index>(q - t.row_start[at(up)]);
    }
  }
}

void find_entries(FrontTree& t, const SymmetricPattern& p) {
  std::vector<Index> front_of(at(t.size));
  for (Index f = 0; f < t.fronts(); ++f) {
    for (Index j = t.first_pivot[at(f)]; j < t.first_pivot[at(f) + 1]; ++j) front_of[at(j)] = f;
  }
  const auto each = [&](auto&& visit) {
    for (Index c = 0; c < p.size; ++c) {
      for (auto k = p.column_start[at(c)]; k < p.column_start[at(c) + 1]; ++k) {
        const Index a = t.position[at(c)], b = t.position[at(p.row[static_cast<std::size_t>(k)])];
        visit(k, std::min(a, b), std::max(a, b));
      }
    }
  };
  t.entry_start.assign(at(t.fronts()) + 1, 0);
  each([&](std::int64_t, Index column, Index) { ++t.entry_start[at(front_of[at(column)]) + 1]; });
  std::partial_sum(t.entry_start.begin(), t.entry_start.end(), t.entry_start.begin());
  t.entry.resize(p.row.size());
  t.entry_place.resize(p.row.size());
  std::vector<std::int64_t> next(t.entry_start.begin(), t.entry_start.end() - 1);
  each([&](std::int64_t k, Index column, Index row) {
    const Index f = front_of[at(column)], first = t.first_pivot[at(f)], end = t.first_pivot[at(f) + 1];
    Index r = row - first;
    if (row >= end) {
      const auto begin = t.row.begin() + t.row_start[at(f)], last = t.row.begin() + t.row_start[at(f) + 1];
      r = end - first + static_cast<Index>(std::lower_bound(begin, last, row) - begin);
    }
    const auto to = static_cast<std::size_t>(next[at(f)]++);
    t.entry[to] = k;
    t.entry_place[to] = static_cast<std::uint32_t>(at(column - first) * at(t.height(f)) + at(r));
  });
}

// Subtrees of at most a sixteenth of the work are jobs, so that a few threads find enough to do. They do not
// depend on how many there are.
void find_jobs(FrontTree& t) {
  constexpr double share = 1.0 / 16;
  const Index m = t.fronts();
  std::vector<double> work(at(m), 0);
  std::vector<Index> first(at(m));
  double total = 0;
  for (Index f = 0; f < m; ++f) {
    const double k = t.pivots(f), h = t.height(f);
    const double own = k * h * h + 20 * h;
    total += own;
    work[at(f)] += own;
    first[at(f)] =
        t.child_start[at(f)] < t.child_start[at(f) + 1] ? first[at(t.child[at(t.child_start[at(f)])])] : f;
    if (t.parent[at(f)] >= 0) work[at(t.parent[at(f)])] += work[at(f)];
  }
  for (Index f = 0; f < m; ++f) {
    if (work[at(f)] > share * total) {
      t.above.push_back(f);
    } else if (t.parent[at(f)] < 0 || work[at(t.parent[at(f)])] > share * total) {
      t.job_start.push_back(first[at(f)]);
      t.job_end.push_back(f + 1);
    }
  }
}

// Where the updates live. Within a job, and above, they form two stacks that take turns from one level of the
// tree to the next, so that a front never writes over what it reads. What a job leaves has a place of its
// own.
void place_updates(FrontTree& t) {
  const Index m = t.fronts();
  t.update_start.assign(at(m), 0);
  std::vector<Index> depth(at(m), 0);
  for (Index f = m - 1; f >= 0; --f) depth[at(f)] = t.parent[at(f)] < 0 ? 0 : 1 - depth[at(t.parent[at(f)])];
  std::vector<std::uint8_t> in_stack(at(m), 1);
  const auto square = [&](Index f) { return std::int64_t{t.updates(f)} * t.updates(f); };
  for (const Index end : t.job_end) {
    in_stack[at(end) - 1] = 0;
    t.update_start[at(end) - 1] = t.workspace;
    t.workspace += square(end - 1);
  }
  const auto run = [&](auto begin, auto end) {
    std::int64_t top[2] = {0, 0}, peak[2] = {0, 0};
    for (auto f = begin; f != end; ++f) {
      const int side = depth[at(*f)];
      for (Index c = t.child_start[at(*f)]; c < t.child_start[at(*f) + 1]; ++c) {
        if (in_stack[at(t.child[at(c)])]) top[1 - side] -= square(t.child[at(c)]);
      }
      if (!in_stack[at(*f)]) continue;
      t.update_start[at(*f)] = top[side];
      top[side] += square(*f);
      peak[side] = std::max(peak[side], top[side]);
    }
    for (auto f = begin; f != end; ++f) {
      if (in_stack[at(*f)]) t.update_start[at(*f)] += t.workspace + (depth[at(*f)] == 0 ? 0 : peak[0]);
    }
    t.workspace += peak[0] + peak[1];
  };
  std::vector<Index> job;
  for (std::size_t j = 0; j < t.job_end.size(); ++j) {
    job.resize(at(t.job_end[j] - t.job_start[j]));
    std::iota(job.begin(), job.end(), t.job_start[j]);
    run(job.begin(), job.end());
  }
  run(t.above.begin(), t.above.end());
}

}  // namespace

double operations_of(const SymmetricPattern& pattern, const Ordering& ordering) {
  const std::vector<Index> parent = elimination_tree(permuted(pattern, ordering.position, false));
  const std::vector<Index> count =
      column_counts(permuted(pattern, ordering.position, true), parent, postorder(parent, {}));
  return operations_of_counts(count);
}

static Ordering best_of_all(const SymmetricPattern& pattern, double& fewest) {
  constexpr std::array kCandidates{OrderingMethod::metis, OrderingMethod::amf, OrderingMethod::amd};
  Ordering best;
  fewest = std::numeric_limits<double>::infinity();
  for (Ordering& ordering : order_unknowns(pattern, kCandidates)) {
    const double operations = operations_of(pattern, ordering);
    if (operations >= fewest) continue;
    fewest = operations;
    best = std::move(ordering);
  }
  return best;
}

static bool same_unknowns(const SymmetricPattern& a, const SymmetricPattern& b) {
  return a.size == b.size && a.groups == b.groups && a.group == b.group && a.multiplier == b.multiplier;
}

Ordering best_ordering(const SymmetricPattern& pattern, OrderingMethod method) {
  constexpr double little_more = 1.15;
  if (method != OrderingMethod::best) return order_unknowns(pattern, method);
  if (pattern.base && pattern.base->pattern.size > 0 && same_unknowns(pattern, pattern.base->pattern)) {
    OrderingBase& base = *pattern.base;
    const std::lock_guard lock(base.mutex);
    if (base.operations == 0) {
      double operations = 0;
      base.ordering = best_of_all(base.pattern, operations);
      base.operations = operations;  // once the ordering is there: memory may run out on the way
    }
    if (operations_of(pattern, base.ordering) <= little_more * base.operations) return base.ordering;
  }
  double operations = 0;
  return best_of_all(pattern, operations);
}

FrontTree front_tree(const SymmetricPattern& pattern, const Ordering& ordering) {
  Analysis a = analysis_of(pattern, ordering);
  FrontTree t;
  t.size = pattern.size;
  t.operations = operations_of_counts(a.count);
  t.factor_nonzeros = std::accumulate(a.count.begin(), a.count.end(), std::int64_t{0});
  Supernodes s = supernodes(a.parent, a.count);
  t.unknown = std::move(a.unknown);
  t.position = std::move(a.position);
  t.first_pivot = std::move(s.first);
  t.parent = std::move(s.parent);
  const Index m = t.fronts();
  t.child_start.assign(at(m) + 1, 0);
  for (const Index p : t.parent) {
    if (p >= 0) ++t.child_start[at(p) + 1];
  }
  std::partial_sum(t.child_start.begin(), t.child_start.end(), t.child_start.begin());
  t.child.resize(at(t.child_start.back()));
  std::vector<Index> next(t.child_start.begin(), t.child_start.end() - 1);
  for (Index f = 0; f < m; ++f) {
    if (t.parent[at(f)] >= 0) t.child[at(next[at(t.parent[at(f)])]++)] = f;
  }
  find_rows(t, permuted(pattern, t.position, true));
  find_entries(t, pattern);
  t.panel_start = {0};
  for (Index f = 0; f < m; ++f) {
    t.panel_start.push_back(t.panel_start.back() + std::int64_t{t.pivots(f)} * t.height(f));
    t.largest_panel = std::max(t.largest_panel, t.height(f));
  }
  find_jobs(t);
  place_updates(t);
  return t;
}

std::shared_ptr<const FrontTree> shared_front_tree(const SymmetricPattern& pattern, OrderingMethod method) {
  const auto made = [&] {
    return std::make_shared<const FrontTree>(front_tree(pattern, best_ordering(pattern, method)));
  };
  if (!pattern.analysis) return made();
  SharedAnalysis& shared = *pattern.analysis;
  const std::lock_guard lock(shared.mutex);
  if (!shared.tree || shared.method != method) {
    shared.tree = made();
    shared.method = method;
  }
  return shared.tree;
}

}  // namespace isochor
