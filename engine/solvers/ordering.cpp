#include "engine/solvers/ordering.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <mutex>
#include <numeric>

#include "engine/base.h"
#include "engine/solvers/mumps_solver.h"

#ifdef ISOCHOR_HAVE_METIS
#include <metis.h>
#endif

namespace isochor {
namespace {

// Adjacency of the groups without self loops, both directions, rows sorted.
struct Graph {
  std::vector<Index> start, neighbour, weight;
  Index size() const { return static_cast<Index>(start.size()) - 1; }
};

using Pair = std::pair<Index, Index>;

// A row is dense when it touches a large part of the groups, beyond what any mesh neighbourhood does.
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

Graph quotient_graph(const SymmetricPattern& p, std::span<const Index> group, Index groups,
                     std::span<const std::uint8_t> dense) {
  std::vector<Pair> edges;
  for (Index c = 0; c < p.size; ++c) {
    if (dense[at(c)]) continue;
    Index last = -1;  // neighbouring entries of a column mostly belong to one group
    for (auto k = p.column_start[at(c)]; k < p.column_start[at(c) + 1]; ++k) {
      const Index r = p.row[static_cast<std::size_t>(k)];
      const Index g = group[at(r)];
      if (dense[at(r)] || g == group[at(c)] || g == last) continue;
      last = g;
      edges.emplace_back(group[at(c)], g);
      edges.emplace_back(g, group[at(c)]);
    }
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  Graph graph;
  graph.start.assign(at(groups) + 1, 0);
  graph.weight.assign(at(groups), 0);
  graph.neighbour.reserve(edges.size());
  for (const auto& [a, b] : edges) {
    ++graph.start[at(a) + 1];
    graph.neighbour.push_back(b);
  }
  std::partial_sum(graph.start.begin(), graph.start.end(), graph.start.begin());
  for (Index i = 0; i < p.size; ++i) {
    if (!dense[at(i)]) ++graph.weight[at(group[at(i)])];
  }
  // A group whose unknowns are all dense has no edges; the libraries want positive weights.
  for (Index& w : graph.weight) w = std::max<Index>(w, 1);
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
  auto* const neighbour = const_cast<idx_t*>(graph.neighbour.data());
  auto* const weight = const_cast<idx_t*>(graph.weight.data());
#ifdef __GLIBC__
  char state[128];
  char* const host_state = initstate(1, state, sizeof state);
#endif
  const int status = METIS_NodeND(&n, start, neighbour, weight, options, order.data(), position.data());
#ifdef __GLIBC__
  if (host_state != nullptr) setstate(host_state);
#endif
  return status == METIS_OK;
}
#endif

void amd_position(const Graph& graph, std::vector<Index>& position) {
  const Index n = graph.size();
  Eigen::SparseMatrix<double, Eigen::ColMajor, Index> matrix(n, n);
  matrix.resizeNonZeros(static_cast<Eigen::Index>(graph.neighbour.size()));
  std::copy(graph.start.begin(), graph.start.end(), matrix.outerIndexPtr());
  std::copy(graph.neighbour.begin(), graph.neighbour.end(), matrix.innerIndexPtr());
  std::fill_n(matrix.valuePtr(), graph.neighbour.size(), 1.0);
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
        const Index neighbour = graph.neighbour[at(k)];
        if (primal[at(neighbour)]) first = std::min(first, position[at(neighbour)]);
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
// multifrontal solver that is handed the sequence finds its fronts only when they are neighbours in it.
std::vector<Index> postorder(const Graph& graph, std::span<const Index> order) {
  const Index n = graph.size();
  std::vector<Index> rank(at(n)), parent(at(n), -1), ancestor(at(n), -1);
  for (Index k = 0; k < n; ++k) rank[at(order[at(k)])] = k;
  for (Index k = 0; k < n; ++k) {
    const Index g = order[at(k)];
    for (Index e = graph.start[at(g)]; e < graph.start[at(g) + 1]; ++e) {
      // Climb from each earlier neighbour to its root so far, whose parent is k; shorten the way for those to
      // come.
      for (Index i = rank[at(graph.neighbour[at(e)])]; i != -1 && i < k;) {
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

Ordering order_unknowns(const SymmetricPattern& pattern, OrderingMethod method) {
  const Index n = pattern.size;
  std::vector<Index> own_group;
  std::span<const Index> group = pattern.group;
  Index groups = pattern.groups;
  if (group.empty() || method == OrderingMethod::pord) {
    own_group.resize(at(n));
    std::iota(own_group.begin(), own_group.end(), 0);
    group = own_group;
    groups = n;
  }
  const std::vector<std::uint8_t> dense = find_dense(pattern, group, groups);
  const Graph graph = quotient_graph(pattern, group, groups, dense);

  Ordering result;
  std::vector<Index> position(at(groups));
  std::iota(position.begin(), position.end(), 0);
  if (method != OrderingMethod::as_given && !graph.neighbour.empty()) {
    const bool by_mumps = method == OrderingMethod::pord || method == OrderingMethod::amf;
    if (by_mumps && mumps_graph_ordering(graph.start, graph.neighbour, method, position))
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
  std::vector<Index> rank(at(groups));
  for (Index k = 0; k < groups; ++k) rank[at(group_order[at(k)])] = k;
  const auto late = [&](Index i) { return !pattern.multiplier.empty() && pattern.multiplier[at(i)] != 0; };
  result.unknown.resize(at(n));
  std::iota(result.unknown.begin(), result.unknown.end(), 0);
  std::sort(result.unknown.begin(), result.unknown.end(), [&](Index a, Index b) {
    if (dense[at(a)] != dense[at(b)]) return dense[at(a)] < dense[at(b)];
    if (!dense[at(a)] && group[at(a)] != group[at(b)]) return rank[at(group[at(a)])] < rank[at(group[at(b)])];
    if (late(a) != late(b)) return late(b);
    return a < b;
  });
  result.position.resize(at(n));
  for (Index k = 0; k < n; ++k) result.position[at(result.unknown[at(k)])] = k;
  result.dense = static_cast<Index>(std::count(dense.begin(), dense.end(), 1));
  return result;
}

}  // namespace isochor
