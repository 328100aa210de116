#include "engine/solvers/two_level/edge_nodes.h"

#include <algorithm>
#include <numeric>

namespace isochor {
namespace {

constexpr double most_off = 0.1;  // of the length of the edge

struct Guess {
  std::array<Index, 2> ends{-1, -1};
  double off = most_off * most_off;  // square
};

Guess nearest_edge(Index node, const BlockMatrix& k, std::span<const Vec3> place) {
  Guess best;
  const auto from = static_cast<std::size_t>(k.start[at(node)]),
             to = static_cast<std::size_t>(k.start[at(node) + 1]);
  const Vec3 here = place[at(node)];
  for (std::size_t a = from; a < to; ++a) {
    const Index i = k.column[a];
    if (i == node) continue;
    const Vec3 mirrored = here + (here - place[at(i)]);
    for (std::size_t b = a + 1; b < to; ++b) {
      const Index j = k.column[b];
      if (j == node) continue;
      const Vec3 off = place[at(j)] - mirrored, edge = place[at(j)] - place[at(i)];
      const double square = dot(off, off), length = dot(edge, edge);
      if (!(square < 4 * best.off * length)) continue;
      const auto connected = k.find(i, j);
      if (connected >= k.start[at(i) + 1] || k.column[static_cast<std::size_t>(connected)] != j) continue;
      best = {{i, j}, 0.25 * square / length};
    }
  }
  return best;
}

}  // namespace

EdgeNodes find_edge_nodes(const SaddleMatrix& matrix, const BlockMatrix& stiffness,
                          std::span<const UnknownGeometry> geometry) {
  EdgeNodes out;
  out.ends.assign(at(matrix.nodes()), {-1, -1});
  if (geometry.empty()) return out;
  std::vector<Vec3> place(at(matrix.nodes()));
  for (std::size_t u = 0; u < geometry.size(); ++u) place[at(matrix.place()[u] / 3)] = geometry[u].position;
  std::vector<Guess> guess;
  for (Index i = 0; i < matrix.nodes(); ++i) guess.push_back(nearest_edge(i, stiffness, place));
  // The surest first; of equal ones the lower number.
  std::vector<Index> order(guess.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](Index a, Index b) { return guess[at(a)].off < guess[at(b)].off; });
  std::vector<std::uint8_t> is_end(guess.size(), 0);
  for (const Index i : order) {
    const auto [a, b] = guess[at(i)].ends;
    if (a < 0 || is_end[at(i)] || out.ends[at(a)][0] >= 0 || out.ends[at(b)][0] >= 0) continue;
    out.ends[at(i)] = {a, b};
    is_end[at(a)] = is_end[at(b)] = 1;
    ++out.count;
  }
  return out;
}

}  // namespace isochor
