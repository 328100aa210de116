#include "engine/scene/embedding.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "engine/base/text.h"
#include "engine/mesh/cell_shape.h"

namespace isochor {

namespace {

std::array<double, 4> barycentric(std::span<const Vec3> rest, const Index* cell, const Vec3& point) {
  const Vec3& o = rest[at(cell[0])];
  const Vec3 a = rest[at(cell[1])] - o, b = rest[at(cell[2])] - o, c = rest[at(cell[3])] - o, p = point - o;
  const double volume = dot(a, cross(b, c));
  const double u = dot(p, cross(b, c)) / volume, v = dot(a, cross(p, c)) / volume,
               w = dot(a, cross(b, p)) / volume;
  return {1 - u - v - w, u, v, w};
}

// Where the trilinear map of a hexahedron takes the point from, by Newton's method, and whether it settles.
bool place_in_hex(std::span<const Vec3> rest, const Index* cell, const Vec3& point, Vec3& xi) {
  xi = {};
  for (int i = 0; i < 50; ++i) {
    Vec3 there{};
    std::array<Vec3, 3> rate{};
    for (std::size_t a = 0; a < 8; ++a) {
      const Vec3& x = rest[at(cell[a])];
      const Vec3 g = hex_gradient(a, xi);
      there += hex_function(a, xi) * x;
      for (int k = 0; k < 3; ++k) rate[static_cast<std::size_t>(k)] += g[k] * x;
    }
    const Vec3 left = point - there;
    const double volume = dot(rate[0], cross(rate[1], rate[2]));
    if (!(volume > 0)) return false;
    const Vec3 step{dot(left, cross(rate[1], rate[2])) / volume, dot(rate[0], cross(left, rate[2])) / volume,
                    dot(rate[0], cross(rate[1], left)) / volume};
    xi += step;
    const double most = std::max({std::abs(xi.x), std::abs(xi.y), std::abs(xi.z)});
    if (!(most < 10)) return false;
    if (dot(step, step) < 1e-28) return true;
  }
  return false;
}

PointInBody sorted(const std::map<Index, double>& terms) {
  PointInBody p;
  for (const auto& [node, weight] : terms) {
    if (weight == 0) continue;
    p.nodes.push_back(node);
    p.weight.push_back(weight);
  }
  return p;
}

}  // namespace

Vec3 PointInBody::at(std::span<const Vec3> x) const {
  Vec3 sum{};
  for (std::size_t a = 0; a < nodes.size(); ++a) sum += weight[a] * x[isochor::at(nodes[a])];
  return sum;
}

namespace {

Error not_in_body(const BodyData& body, const Vec3& point, const std::string& who) {
  return Error{who + ": the point (" + number(point.x) + ", " + number(point.y) + ", " + number(point.z) +
               ") is not in body \"" + body.name + "\"; give points in or on the body, in meters"};
}

// As embed(), of hexahedra. Cells whose corners are far away are not asked.
Result<PointInBody> embed_in_hexahedra(const BodyData& body, std::span<const Vec3> rest, const Vec3& point,
                                       const std::string& who) {
  double least = 3;  // one cell beyond a side
  std::map<Index, double> terms;
  for (std::size_t c = 0; c + 8 <= body.global_cells.size(); c += 8) {
    const Index* cell = body.global_cells.data() + c;
    Vec3 low = rest[at(cell[0])], high = low;
    for (std::size_t a = 1; a < 8; ++a) {
      for (int k = 0; k < 3; ++k) {
        low[k] = std::min(low[k], rest[at(cell[a])][k]);
        high[k] = std::max(high[k], rest[at(cell[a])][k]);
      }
    }
    bool near = true;
    for (int k = 0; k < 3; ++k) {
      const double reach = high[k] - low[k];
      near = near && point[k] >= low[k] - reach && point[k] <= high[k] + reach;
    }
    Vec3 xi;
    if (!near || !place_in_hex(rest, cell, point, xi)) continue;
    const double farthest = std::max({std::abs(xi.x), std::abs(xi.y), std::abs(xi.z)});
    if (!(farthest < least - 1e-12)) continue;
    least = farthest;
    terms.clear();
    for (std::size_t a = 0; a < 8; ++a) {
      const double weight = hex_function(a, xi);
      if (std::abs(weight) > 1e-12) terms[cell[a]] = weight;
    }
    if (least <= 1) break;
  }
  if (terms.empty()) return not_in_body(body, point, who);
  return sorted(terms);
}

}  // namespace

namespace {

// As embed(), of a thin body: on the triangle that the point is least off, above or beside it, and at most by
// a twentieth of an edge.
Result<PointInBody> embed_in_sheet(const BodyData& body, std::span<const Vec3> rest, const Vec3& point,
                                   const std::string& who) {
  double least = 0.05;
  std::map<Index, double> terms;
  for (std::size_t c = 0; c + 3 <= body.global_cells.size(); c += 3) {
    const Index* n = body.global_cells.data() + c;
    const Vec3& o = rest[at(n[0])];
    const Vec3 a = rest[at(n[1])] - o, b = rest[at(n[2])] - o, p = point - o, normal = cross(a, b);
    const double square = dot(normal, normal), edge = std::max({norm(a), norm(b), norm(b - a)});
    const double u = dot(cross(p, b), normal) / square, v = dot(cross(a, p), normal) / square;
    const double above = std::abs(dot(p, normal)) / (std::sqrt(square) * edge);
    const double off = above + std::max({0.0, -u, -v, u + v - 1});
    if (!(off < least)) continue;
    least = off;
    terms.clear();
    const double weight[3] = {1 - u - v, u, v};
    for (std::size_t k = 0; k < 3; ++k) terms[n[k]] = std::abs(weight[k]) < 1e-12 ? 0 : weight[k];
  }
  if (terms.empty()) return not_in_body(body, point, who);
  return sorted(terms);
}

}  // namespace

Result<PointInBody> embed(const BodyData& body, std::span<const Vec3> rest, const Vec3& point,
                          const std::string& who) {
  const auto per = static_cast<std::size_t>(nodes_per_cell(body.mesh.cell_type));
  if (body.mesh.cell_type == CellType::hex8) return embed_in_hexahedra(body, rest, point, who);
  if (body.thin()) return embed_in_sheet(body, rest, point, who);
  double inside = -std::numeric_limits<double>::infinity();
  const Index* cell = nullptr;
  std::array<double, 4> l{};
  // A point on a face lies in two cells: only the nodes of the face weigh, so either will do.
  for (std::size_t c = 0; c + per <= body.global_cells.size(); c += per) {
    const auto trial = barycentric(rest, body.global_cells.data() + c, point);
    const double least = *std::min_element(trial.begin(), trial.end());
    if (!(least > inside)) continue;
    inside = least;
    cell = body.global_cells.data() + c;
    l = trial;
  }
  if (!cell || inside < -1) return not_in_body(body, point, who);
  // Rounding at a face or a node would only widen the stencil.
  for (double& v : l) {
    if (std::abs(v) < 1e-12) v = 0;
  }
  std::map<Index, double> terms;
  if (per == 4) {
    for (std::size_t i = 0; i < 4; ++i) terms[cell[i]] = l[i];
    return sorted(terms);
  }
  constexpr std::size_t kEdges[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
  for (std::size_t i = 0; i < 4; ++i) terms[cell[i]] = l[i] * (2 * l[i] - 1);
  for (std::size_t e = 0; e < 6; ++e) terms[cell[4 + e]] = 4 * l[kEdges[e][0]] * l[kEdges[e][1]];
  return sorted(terms);
}

PointInBody difference(const PointInBody& first, const PointInBody& second) {
  std::map<Index, double> terms;
  for (std::size_t a = 0; a < second.nodes.size(); ++a) terms[second.nodes[a]] += second.weight[a];
  for (std::size_t a = 0; a < first.nodes.size(); ++a) terms[first.nodes[a]] -= first.weight[a];
  return sorted(terms);
}

double stiffest(const BodyData& body) {
  double mu = body.lent_modulus;
  for (const RegionData& r : body.regions) mu = std::max(mu, r.material->shear_modulus());
  return mu;
}

}  // namespace isochor
