#include "constraints/layer/shell_rows.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "engine/base/text.h"

namespace isochor {

namespace {

// An edge, ends ascending, and the corner across it in each of two faces: the one that runs along it from the
// smaller end, and the one that runs against that. All angles then count alike as seen from the upper side.
struct Edge {
  Index along = -1, against = -1;
  int faces = 0;
  Index row = -1;
};
using Edges = std::map<std::array<Index, 2>, Edge>;

std::array<Index, 2> ends(Index a, Index b) {
  return {std::min(a, b), std::max(a, b)};
}

Result<Edges> edges_of(const BentSheet& sheet, std::span<const Vec3> rest) {
  Edges edges;
  for (std::size_t t = 0; t < sheet.triangles.size(); t += 3) {
    const Index* n = &sheet.triangles[t];
    for (std::size_t k = 0; k < 3; ++k) {
      Edge& edge = edges[ends(n[k], n[(k + 1) % 3])];
      (n[k] < n[(k + 1) % 3] ? edge.along : edge.against) = n[(k + 2) % 3];
      ++edge.faces;
    }
  }
  for (const auto& [end, edge] : edges) {
    const bool crowded = edge.faces > 2;
    if (!crowded && (edge.faces == 1 || (edge.along >= 0 && edge.against >= 0))) continue;
    const Vec3 middle = 0.5 * (rest[at(end[0])] + rest[at(end[1])]);
    const std::string where =
        "the edge around (" + number(middle.x) + ", " + number(middle.y) + ", " + number(middle.z) + ") m ";
    if (!crowded)
      return Error{where +
                   "has faces that go round opposite ways, so that the sheet has no upper side; turn "
                   "one of them over"};
    return Error{
        where + "belongs to " + std::to_string(edge.faces) +
        " faces, and a sheet that bends has one or two at an edge; make each of the sheets that meet "
        "there a shell of its own"};
  }
  return edges;
}

using Rows = std::vector<std::map<Index, double>>;  // [row][column], symmetric

// What moments cost: the integral of sigma : S : sigma, S the compliance of the plate. On a triangle sigma is
// the sum over its edges of their moment times the tensor that bends this edge alone, t t' / ((n.t)(n.t'))
// with the tangents t, t' of the other two edges, symmetric, and n across this one in the plane.
void add_triangle(const Index* nodes, const Index* row, std::span<const Vec3> rest, double bending, double nu,
                  Rows& compliance) {
  const double area =
      0.5 * norm(cross(rest[at(nodes[1])] - rest[at(nodes[0])], rest[at(nodes[2])] - rest[at(nodes[0])]));
  const std::array<EdgeMoment, 3> edge = edge_moments(nodes, rest);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      if (row[i] < 0 || row[j] < 0) continue;
      const Vec3 &a = edge[i].t, &b = edge[i].u, &c = edge[j].t, &d = edge[j].u;
      const double both =
          0.5 * edge[i].scale * edge[j].scale * (dot(a, c) * dot(b, d) + dot(a, d) * dot(b, c));
      const double traces = edge[i].scale * dot(a, b) * (edge[j].scale * dot(c, d));
      compliance[at(row[i])][row[j]] += area / (bending * (1 - nu * nu)) * ((1 + nu) * both - nu * traces);
    }
  }
}

// Part of the bending is put into energies of single hinges, so that the stiffness has it and is definite by
// itself: with a diagonal H below C^-1,
//   phi C^-1 phi / 2 = phi H phi / 2 + max over lambda of lambda (1 - C H) phi - lambda (C - C H C) lambda /
//   2,
// which is exact. A triangle has three edges, so that C is at most three times its diagonal.
constexpr double kHingeShare = 0.25;

void fill_rows(const Rows& compliance, const HingePool& hinges, std::span<const double> stiffness,
               ShellRows& rows) {
  const auto count = static_cast<Index>(compliance.size());
  std::vector<Index> items;
  for (Index r = 0; r < count; ++r) {
    const auto& own = compliance[at(r)];
    items.clear();
    for (const auto& [e, c] : own) {
      items.push_back(e);
      rows.weight.push_back((e == r ? 1.0 : 0.0) - c * stiffness[at(e)]);
    }
    rows.map.push(items);
    std::map<Index, double> left(own.begin(), own.upper_bound(r));
    for (const auto& [e, c] : own) {
      for (const auto& [s, d] : compliance[at(e)]) {
        if (s <= r) left[s] -= c * stiffness[at(e)] * d;
      }
    }
    for (const auto& [s, c] : left) rows.compliance.push_back({r, s, c});
    rows.metric.push_back(left.at(r));
    rows.measure.push_back(hinges.rest_length(r));
  }
}

}  // namespace

std::array<EdgeMoment, 3> edge_moments(const Index* triangle, std::span<const Vec3> rest) {
  const Vec3 x[3] = {rest[at(triangle[0])], rest[at(triangle[1])], rest[at(triangle[2])]};
  const Vec3 up = direction(cross(x[1] - x[0], x[2] - x[0]));
  Vec3 tangent[3];
  for (std::size_t k = 0; k < 3; ++k) tangent[k] = direction(x[(k + 1) % 3] - x[k]);
  std::array<EdgeMoment, 3> out;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 across = cross(tangent[k], up), &t = tangent[(k + 1) % 3], &u = tangent[(k + 2) % 3];
    out[k] = {t, u, 1 / (dot(across, t) * dot(across, u))};
  }
  return out;
}

// m = H phi + (1 - H C) lambda; the rows hold 1 - C H.
std::vector<double> moments_of(const Bending& bending, std::span<const Vec3> x,
                               std::span<const double> lambda) {
  const ShellRows& rows = *bending.rows;
  const HingePool& hinges = *bending.hinges;
  std::vector<double> out;
  for (Index r = 0; r < rows.rows(); ++r) {
    double sum = 0;
    for (Index k = rows.map.offset[at(r)]; k < rows.map.offset[at(r) + 1]; ++k) {
      const Index e = rows.map.item[at(k)];
      const double share = ((e == r ? 1.0 : 0.0) - rows.weight[at(k)]) / hinges.stiffness(e);
      sum += share * lambda[at(e)];
    }
    out.push_back(hinges.stiffness(r) * (hinges.turned(r, x) - sum) + lambda[at(r)]);
  }
  return out;
}

Result<Bending> make_bending(const std::string& name, const BentSheet& sheet, std::span<const Vec3> rest) {
  auto found = edges_of(sheet, rest);
  if (!found) return found.failure();
  Edges& edges = found.value();
  Bending out;
  const auto hinges = std::make_shared<HingePool>(name);
  Index count = 0;
  for (auto& [end, edge] : edges) {
    if (edge.faces == 2) {
      const std::array<Index, 4> nodes{end[0], end[1], edge.along, edge.against};
      if (sheet.flat)
        hinges->add(nodes, rest, 0);
      else
        hinges->add(nodes, rest);
      edge.row = count++;
    } else if (sheet.clamped.contains(end[0]) && sheet.clamped.contains(end[1])) {
      if (edge.along >= 0)
        hinges->add_clamped({end[0], end[1], edge.along}, rest);
      else
        hinges->add_clamped({end[1], end[0], edge.against}, rest);
      edge.row = count++;
      ++out.clamped_edges;
    }
  }
  Rows compliance(at(count));
  for (std::size_t t = 0; t < sheet.triangles.size(); t += 3) {
    const Index* n = &sheet.triangles[t];
    Index row[3];
    for (std::size_t k = 0; k < 3; ++k) row[k] = edges.at(ends(n[k], n[(k + 1) % 3])).row;
    out.row_of.push_back({row[0], row[1], row[2]});
    add_triangle(n, row, rest, sheet.bending, sheet.poisson, compliance);
  }
  std::vector<double> stiffness;
  for (Index r = 0; r < count; ++r) stiffness.push_back(kHingeShare / compliance[at(r)].at(r));
  out.rows = std::make_shared<ShellRows>(name);
  fill_rows(compliance, *hinges, stiffness, *out.rows);
  hinges->set_stiffness(std::move(stiffness));
  hinges->finish();
  out.hinges = hinges;
  return out;
}

}  // namespace isochor
