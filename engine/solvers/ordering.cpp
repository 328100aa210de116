#include "engine/solvers/ordering.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <mutex>
#include <numeric>

#include "engine/base/base.h"
#include "engine/solvers/foreign/mumps_solver.h"

#ifdef ISOCHOR_HAVE_METIS
#include <metis.h>
#endif

namespace isochor {
namespace {

// Adjacency of the groups without self loops, both directions, rows sorted.
struct Graph {
  std::vector<Index> start, neighbor, weight;
  Index size() const { return static_cast<Index>(start.size()) - 1; }
};

using Pair = std::pair<Index, Index>;

// A row is dense when it touches a large part of the groups, beyond what any mesh neighborhood does.
Index dense_limit(Index groups) {
  return std::max<Index>(100, static_cast<Index>(10 * std::sqrt(groups)));
}

// How many groups each unknown touches: an upper bound that is cheap, made exact only for those above the
// limit.
std::vector<std::uint8_t> find_dense(const SymmetricPattern& p, std::span<const Index> group, Index groups) {
  const Index limit = dense_limit(groups);
  std::vector<std::uint8_t> dense(at(p.size), 0);
  if (groups <= limit) return dense;
  std::vector<Index> degree(at(p.size), 0);
  for (Index c = 0; c < p.size; ++c) {
    for (auto k = p.column_start[at(c)]; k < p.column_start[at(c) + 1]; ++k) {
      ++degree[at(p.row[static_cast<std::size_t>(k)])];
      ++degree[at(c)];
    }
  }
  std::vector<Index> candidates;
  for (Index i = 0; i < p.size; ++i) {
    if (degree[at(i)] > limit) candidates.push_back(i);
  }
  if (candidates.empty()) return dense;
  // (candidate, group) pairs, sorted and made unique.
  std::vector<std::uint8_t> is_candidate(at(p.size), 0);
  for (const Index i : candidates) is_candidate[at(i)] = 1;
  std::vector<Pair> touched;
  for (Index c = 0; c < p.size; ++c) {
    for (auto k = p.column_start[at(c)]; k < p.column_start[at(c) + 1]; ++k) {
      const Index r = p.row[static_cast<std::size_t>(k)];
      if (is_candidate[at(r)]) touched.emplace_back(r, group[at(c)]);
      if (is_candidate[at(c)]) touched.emplace_back(c, group[at(r)]);
    }
  }
  std::sort(touched.begin(), touched.end());
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  for (const Index i : candidates) degree[at(i)] = 0;
  for (const auto& [i, g] : touched) ++degree[at(i)];
  for (const Index i : candidates) dense[at(i)] = degree[at(i)] > limit;
  return dense;
}

// The unknowns of each group, ascending, but those that are dense.
struct Members {
  std::vector<Index> start, unknown;
};

Members members_of(std::span<const Index> group, Index groups, std::span<const std::uint8_t> dense) {
  Members m;
  m.start.assign(at(groups) + 1, 0);
  for (std::size_t i = 0; i < group.size(); ++i) m.start[at(group[i]) + 1] += dense[i] == 0;
  std::partial_sum(m.start.begin(), m.start.end(), m.start.begin());
  m.unknown.resize(at(m.start.back()));
  std::vector<Index> next(m.start.begin(), m.start.end() - 1);
  for (std::size_t i = 0; i < group.size(); ++i) {
    if (!dense[i]) m.unknown[at(next[at(group[i])]++)] = static_cast<Index>(i);
  }
  return m;
}

// The lists of who lists each vertex. They come out ascending, whatever the sequence in those of `from`.
Graph transposed(const Graph& from) {
  Graph to;
  to.start.assign(from.start.size(), 0);
  for (const Index b : from.neighbor) ++to.start[at(b) + 1];
  std::partial_sum(to.start.begin(), to.start.end(), to.start.begin());
  to.neighbor.resize(from.neighbor.size());
  std::vector<Index> next(to.start.begin(), to.start.end() - 1);
  for (Index a = 0; a < from.size(); ++a) {
    for (Index k = from.start[at(a)]; k < from.start[at(a) + 1]; ++k)
      to.neighbor[at(next[at(from.neighbor[at(k)])]++)] = a;
  }
  return to;
}

// In time linear in the entries: each list is made unique by marks, and sorted by transposing.
Graph quotient_graph(const SymmetricPattern& p, std::span<const Index> group, const Members& members,
                     std::span<const std::uint8_t> dense) {
  const auto groups = static_cast<Index>(members.start.size()) - 1;
  std::vector<Index> mark(at(groups), -1);
  Graph below;  // from the group of a column to those of its rows
  below.start = {0};
  for (Index g = 0; g < groups; ++g) {
    mark[at(g)] = g;
    for (Index m = members.start[at(g)]; m < members.start[at(g) + 1]; ++m) {
      const Index c = members.unknown[at(m)];
      for (auto k = p.column_start[at(c)]; k < p.column_start[at(c) + 1]; ++k) {
        const Index r = p.row[static_cast<std::size_t>(k)], h = group[at(r)];
        if (mark[at(h)] == g || dense[at(r)]) continue;
        mark[at(h)] = g;
        below.neighbor.push_back(h);
      }
    }
    below.start.push_back(static_cast<Index>(below.neighbor.size()));
  }
  const Graph above = transposed(below);
  Graph both;
  both.start = {0};
  both.neighbor.reserve(2 * below.neighbor.size());
  std::fill(mark.begin(), mark.end(), -1);
  for (Index g = 0; g < groups; ++g) {
    for (const Graph* half : std::array<const Graph*, 2>{&below, &above}) {
      for (Index k = half->start[at(g)]; k < half->start[at(g) + 1]; ++k) {
        const Index h = half->neighbor[at(k)];
        if (mark[at(h)] == g) continue;
        mark[at(h)] = g;
        both.neighbor.push_back(h);
      }
    }
    both.start.push_back(static_cast<Index>(both.neighbor.size()));
  }
  Graph graph = transposed(both);
  graph.weight.resize(at(groups));
  // A group whose unknowns are all dense has no edges; the libraries want positive weights.
  for (std::size_t g = 0; g < at(groups); ++g)
    graph.weight[g] = std::max<Index>(members.start[g + 1] - members.start[g], 1);
  return graph;
}

#ifdef ISOCHOR_HAVE_METIS
// METIS draws from the C library's rand(), hence the lock for ourselves and, with glibc, a generator state of
// its own so that the host's sequence is left alone. A host that calls rand() in another thread at that very
// moment may still change the ordering, and with it the last bits of a solution.
bool metis_position(const Graph& graph, std::vector<Index>& position) {
  static_assert(sizeof(idx_t) == sizeof(Index), "METIS with 32-bit indices is needed");
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  idx_t options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_NUMBERING] = 0;
  options[METIS_OPTION_SEED] = 1;
  options[METIS_OPTION_COMPRESS] = 0;  // the groups are the compressed graph
  options[METIS_OPTION_CCORDER] = 0;
  std::vector<Index> order(at(graph.size()));
  position.resize(at(graph.size()));
  idx_t n = graph.size();
  auto* const start = const_cast<idx_t*>(graph.start.data());
  auto* const neighbor = const_cast<idx_t*>(graph.neighbor.data());
  auto* const weight = const_cast<idx_t*>(graph.weight.data());
#ifdef __GLIBC__
  char state[128];
  char* const host_state = initstate(1, state, sizeof state);
#endif
  const int status = METIS_NodeND(&n, start, neighbor, weight, options, order.data(), position.data());
#ifdef __GLIBC__
  if (host_state != nullptr) setstate(host_state);
#endif
  return status == METIS_OK;
}
#endif

void amd_position(const Graph& graph, std::vector<Index>& position) {
  const Index n = graph.size();
  Eigen::SparseMatrix<double, Eigen::ColMajor, Index> matrix(n, n);
  matrix.resizeNonZeros(static_cast<Eigen::Index>(graph.neighbor.size()));
  std::copy(graph.start.begin(), graph.start.end(), matrix.outerIndexPtr());
  std::copy(graph.neighbor.begin(), graph.neighbor.end(), matrix.innerIndexPtr());
  std::fill_n(matrix.valuePtr(), graph.neighbor.size(), 1.0);
  Eigen::AMDOrdering<Index>::PermutationType order;
  Eigen::AMDOrdering<Index>()(matrix, order);
  position.resize(at(n));
  for (Index k = 0; k < n; ++k) position[at(order.indices()[k])] = k;
}

// Moves each group that holds nothing but multiplier rows behind the first group with another unknown beside
// it.
std::vector<Index> order_groups(const SymmetricPattern& p, std::span<const Index> group, const Graph& graph,
                                std::span<const Index> position) {
  const Index n = graph.size();
  std::vector<Index> key(position.begin(), position.end());
  std::vector<std::uint8_t> moved(at(n), 0);
  if (!p.multiplier.empty()) {
    std::vector<std::uint8_t> primal(at(n), 0);
    for (Index i = 0; i < p.size; ++i) {
      if (!p.multiplier[at(i)]) primal[at(group[at(i)])] = 1;
    }
    for (Index g = 0; g < n; ++g) {
      if (primal[at(g)]) continue;
      Index first = n;
      for (Index k = graph.start[at(g)]; k < graph.start[at(g) + 1]; ++k) {
        const Index neighbor = graph.neighbor[at(k)];
        if (primal[at(neighbor)]) first = std::min(first, position[at(neighbor)]);
      }
      if (first < n && first > position[at(g)]) {
        key[at(g)] = first;
        moved[at(g)] = 1;
      }
    }
  }
  std::vector<Index> order(at(n));
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](Index a, Index b) {
    if (key[at(a)] != key[at(b)]) return key[at(a)] < key[at(b)];
    if (moved[at(a)] != moved[at(b)]) return moved[at(a)] < moved[at(b)];
    return position[at(a)] < position[at(b)];
  });
  return order;
}

// The same elimination with every subtree of the elimination tree contiguous: the fill is the same, but a
// multifrontal solver that is handed the sequence finds its fronts only when they are neighbors in it.
std::vector<Index> postorder(const Graph& graph, std::span<const Index> order) {
  const Index n = graph.size();
  std::vector<Index> rank(at(n)), parent(at(n), -1), ancestor(at(n), -1);
  for (Index k = 0; k < n; ++k) rank[at(order[at(k)])] = k;
  for (Index k = 0; k < n; ++k) {
    const Index g = order[at(k)];
    for (Index e = graph.start[at(g)]; e < graph.start[at(g) + 1]; ++e) {
      // Climb from each earlier neighbor to its root so far, whose parent is k; shorten the way for those to
      // come.
      for (Index i = rank[at(graph.neighbor[at(e)])]; i != -1 && i < k;) {
        const Index next = ancestor[at(i)];
        ancestor[at(i)] = k;
        if (next == -1) parent[at(i)] = k;
        i = next;
      }
    }
  }
  std::vector<Index> child(at(n), -1), sibling(at(n), -1), result, stack;
  result.reserve(at(n));
  for (Index k = n - 1; k >= 0; --k) {
    if (parent[at(k)] == -1) continue;
    sibling[at(k)] = child[at(parent[at(k)])];
    child[at(parent[at(k)])] = k;
  }
  for (Index root = 0; root < n; ++root) {
    if (parent[at(root)] != -1) continue;
    stack.push_back(root);
    while (!stack.empty()) {
      const Index top = stack.back(), next = child[at(top)];
      if (next != -1) {
        child[at(top)] = sibling[at(next)];
        stack.push_back(next);
      } else {
        result.push_back(order[at(top)]);
        stack.pop_back();
      }
    }
  }
  return result;
}

}  // namespace

bool have_metis() {
  return !metis_version().empty();
}

std::string_view metis_version() {
#ifdef ISOCHOR_HAVE_METIS
#define ISOCHOR_TEXT_OF(x) #x
#define ISOCHOR_TEXT(x) ISOCHOR_TEXT_OF(x)
  return ISOCHOR_TEXT(METIS_VER_MAJOR) "." ISOCHOR_TEXT(METIS_VER_MINOR) "." ISOCHOR_TEXT(METIS_VER_SUBMINOR);
#undef ISOCHOR_TEXT
#undef ISOCHOR_TEXT_OF
#else
  return {};
#endif
}

std::vector<Ordering> order_unknowns(const SymmetricPattern& pattern,
                                     std::span<const OrderingMethod> methods) {
  const Index n = pattern.size;
  std::vector<Index> own_group;
  std::span<const Index> group = pattern.group;
  Index groups = pattern.groups;
  const bool of_unknowns = std::find(methods.begin(), methods.end(), OrderingMethod::pord) != methods.end();
  if (group.empty() || of_unknowns) {
    own_group.resize(at(n));
    std::iota(own_group.begin(), own_group.end(), 0);
    group = own_group;
    groups = n;
  }
  const std::vector<std::uint8_t> dense = find_dense(pattern, group, groups);
  const Members members = members_of(group, groups, dense);
  const Graph graph = quotient_graph(pattern, group, members, dense);
  std::vector<Ordering> results;
  for (const OrderingMethod method : methods) {
    Ordering& result = results.emplace_back();
    std::vector<Index> position(at(groups));
    std::iota(position.begin(), position.end(), 0);
    if (method != OrderingMethod::as_given && !graph.neighbor.empty()) {
      const bool by_mumps = method == OrderingMethod::pord || method == OrderingMethod::amf;
      if (by_mumps && mumps_graph_ordering(graph.start, graph.neighbor, method, position))
        result.method = method;
#ifdef ISOCHOR_HAVE_METIS
      if (result.method == OrderingMethod::as_given && method != OrderingMethod::amd &&
          metis_position(graph, position)) {
        result.method = OrderingMethod::metis;
      }
#endif
      if (result.method == OrderingMethod::as_given) {
        amd_position(graph, position);
        result.method = OrderingMethod::amd;
      }
    }
    const std::vector<Index> group_order = postorder(graph, order_groups(pattern, group, graph, position));
    // Within a group, as at the dense end, the multiplier rows come after the unknowns they constrain.
    const auto late = [&](Index i) { return !pattern.multiplier.empty() && pattern.multiplier[at(i)] != 0; };
    result.unknown.reserve(at(n));
    for (const Index g : group_order) {
      const auto begin = members.unknown.begin() + members.start[at(g)],
                 end = members.unknown.begin() + members.start[at(g) + 1];
      std::copy_if(begin, end, std::back_inserter(result.unknown), [&](Index i) { return !late(i); });
      std::copy_if(begin, end, std::back_inserter(result.unknown), late);
    }
    result.dense = n - static_cast<Index>(result.unknown.size());
    for (const bool last : {false, true}) {
      for (Index i = 0; i < n; ++i) {
        if (dense[at(i)] && late(i) == last) result.unknown.push_back(i);
      }
    }
    result.position.resize(at(n));
    for (Index k = 0; k < n; ++k) result.position[at(result.unknown[at(k)])] = k;
  }
  return results;
}

Ordering order_unknowns(const SymmetricPattern& pattern, OrderingMethod method) {
  return std::move(order_unknowns(pattern, {&method, 1}).front());
}

}  // namespace isochor
