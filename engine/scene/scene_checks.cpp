#include "engine/scene/scene_checks.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "engine/scene/free_motions.h"

namespace isochor {

std::vector<Index> connected_parts(const SceneFacts& facts, Index& count) {
  std::vector<Index> root(facts.parts.rest.size());
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](Index i) {
    while (root[at(i)] != i) i = root[at(i)] = root[at(root[at(i)])];
    return i;
  };
  for (const BodyData& body : facts.bodies) {
    if (!body.present()) continue;
    const auto per = static_cast<std::size_t>(nodes_per_cell(body.mesh.cell_type));
    for (std::size_t c = 0; c < body.global_cells.size(); c += per) {
      for (std::size_t k = 1; k < per; ++k)
        root[at(find(body.global_cells[c + k]))] = find(body.global_cells[c]);
    }
  }
  for (const auto& pool : facts.parts.stencil_pools) {
    for (Index s = 0; s < pool->stencils(); ++s) {
      const auto nodes = pool->nodes()[s];
      for (std::size_t k = 1; k < nodes.size(); ++k) root[at(find(nodes[k]))] = find(nodes[0]);
    }
  }
  std::vector<Index> part(root.size(), -1);
  count = 0;
  for (Index i = 0; i < static_cast<Index>(root.size()); ++i) {
    const Index r = find(i);
    if (part[at(r)] < 0) part[at(r)] = count++;
    part[at(i)] = part[at(r)];
  }
  return part;
}

namespace {

const BodyData& body_of(const SceneFacts& facts, Index node) {
  const BodyData* found = &facts.bodies.front();
  for (const BodyData& b : facts.bodies) {
    if (!b.present()) continue;
    if (node >= b.first_node) found = &b;
  }
  return *found;
}

// "support "base" holds 1 node", of a part.
std::string what_holds(const SceneFacts& facts, std::span<const Index> part, Index which) {
  std::string text;
  for (const auto& [name, nodes] : facts.held_by) {
    const auto count =
        std::count_if(nodes.begin(), nodes.end(), [&](Index n) { return part[at(n)] == which; });
    if (count == 0) continue;
    text += (text.empty() ? "" : ", ") + ("support \"" + name + "\" holds " + std::to_string(count)) +
            (count == 1 ? " node" : " nodes") + " of it";
  }
  return text.empty() ? "no support holds a node of it" : text;
}

// Which part of a body a part is, by number of nodes and box, where there are several.
std::string which_part(const SceneFacts& facts, std::span<const Index> part, Index which, Index parts) {
  if (parts <= static_cast<Index>(facts.bodies.size())) return "it";
  constexpr double far = std::numeric_limits<double>::infinity();
  Vec3 low{far, far, far}, high{-far, -far, -far};
  Index nodes = 0;
  for (std::size_t i = 0; i < part.size(); ++i) {
    if (part[i] != which) continue;
    const Vec3& x = facts.parts.rest[i];
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], x[k]);
      high[k] = std::max(high[k], x[k]);
    }
    ++nodes;
  }
  return "one of its parts (" + std::to_string(nodes) + " nodes from " + point_text(low) + " to " +
         point_text(high) + " m)";
}

}  // namespace

namespace {

using RigidGram = Eigen::Matrix<double, 6, 6>;

// What the rigid motions of a part do to the functions and the energy of a pool that is not blind to them, at
// rest and each stencil relative to its own size.
void add_rigid_response(const SceneFacts& facts, const StencilPool& pool, std::span<const Index> part,
                        std::span<const Vec3> center, std::span<const double> size,
                        std::vector<RigidGram>& gram) {
  const auto functions = at(pool.functions());
  const auto stencils = at(pool.stencils()), entries = pool.nodes().item.size();
  std::vector<double> energy(stencils), value(stencils * functions), none(stencils * functions, 0.0);
  std::vector<Vec3> gradient(entries), jacobian(entries * functions);
  std::vector<Mat3> hessian(static_cast<std::size_t>(pool.hessian_offset().back()));
  const std::span<const Vec3> rest = facts.parts.rest;
  pool.evaluate({Want::hessian, Definiteness::exact, 0, pool.stencils(), rest, rest, none},
                {energy, value, gradient, jacobian, hessian});
  for (Index s = 0; s < pool.stencils(); ++s) {
    const auto nodes = pool.nodes()[s];
    const auto n = static_cast<Eigen::Index>(nodes.size());
    if (n == 0) continue;
    const Index c = part[at(nodes[0])];
    Eigen::MatrixXd modes(3 * n, 6);
    for (Eigen::Index a = 0; a < n; ++a) {
      const Vec3 arm = (1 / size[at(c)]) * (rest[at(nodes[static_cast<std::size_t>(a)])] - center[at(c)]);
      modes.block<3, 3>(3 * a, 0).setIdentity();
      modes.block<3, 3>(3 * a, 3) << 0, arm.z, -arm.y, -arm.z, 0, arm.x, arm.y, -arm.x, 0;
    }
    const auto first = at(pool.nodes().offset[at(s)]);
    for (std::size_t k = 0; k < functions; ++k) {
      Eigen::RowVectorXd row(3 * n);
      for (Eigen::Index a = 0; a < n; ++a) {
        const Vec3& g = jacobian[first * functions + k * nodes.size() + static_cast<std::size_t>(a)];
        row.segment<3>(3 * a) << g.x, g.y, g.z;
      }
      const double norm = row.norm();
      if (!(norm > 0) || !std::isfinite(norm)) continue;
      const Eigen::Matrix<double, 1, 6> response = row * modes / norm;
      gram[at(c)] += response.transpose() * response;
    }
    if (!pool.has_energy()) continue;
    Eigen::MatrixXd h(3 * n, 3 * n);
    auto slot = static_cast<std::size_t>(pool.hessian_offset()[at(s)]);
    for (Eigen::Index a = 0; a < n; ++a) {
      for (Eigen::Index b = 0; b <= a; ++b, ++slot) {
        for (int i = 0; i < 3; ++i) {
          for (int j = 0; j < 3; ++j) {
            h(3 * a + i, 3 * b + j) = hessian[slot](i, j);
            h(3 * b + j, 3 * a + i) = hessian[slot](i, j);
          }
        }
      }
    }
    const double norm = h.norm();
    if (norm > 0 && std::isfinite(norm)) gram[at(c)] += modes.transpose() * h * modes / norm;
  }
}

}  // namespace

Result<void> check_thin_bodies(const SceneFacts& facts) {
  for (const BodyData& body : facts.bodies) {
    if (!body.thin()) continue;
    const auto mass =
        std::span<const double>(facts.parts.mass).subspan(at(body.first_node), body.mesh.nodes.size());
    const auto bare = std::count_if(mass.begin(), mass.end(), [](double m) { return !(m > 0); });
    if (bare == 0) continue;
    const bool all = bare == static_cast<std::ptrdiff_t>(mass.size());
    return Error{
        "body \"" + body.name + "\": it is thin, and " +
        (all ? std::string("no shell is") : std::to_string(bare) + " of its nodes are without a shell") +
        " on it; add a shell, on all of its surfaces"};
  }
  return {};
}

Result<void> check_anchored(const SceneFacts& facts) {
  Index count = 0;
  const std::vector<Index> part = connected_parts(facts, count);
  std::vector<Vec3> center(at(count));
  std::vector<double> nodes(at(count), 0), size(at(count), 0);
  std::vector<Index> sample(at(count), 0);
  for (std::size_t i = 0; i < part.size(); ++i) {
    center[at(part[i])] += facts.parts.rest[i];
    nodes[at(part[i])] += 1;
    sample[at(part[i])] = static_cast<Index>(i);
  }
  for (std::size_t p = 0; p < center.size(); ++p) center[p] = (1 / nodes[p]) * center[p];
  for (std::size_t i = 0; i < part.size(); ++i) {
    const Vec3 d = facts.parts.rest[i] - center[at(part[i])];
    size[at(part[i])] = std::max(size[at(part[i])], std::sqrt(dot(d, d)));
  }
  using Mat6 = RigidGram;
  std::vector<Mat6> gram(at(count), Mat6::Zero());
  for (const PrescribedNode& p : facts.supports.nodes) {
    const Index c = part[at(p.node)];
    const Vec3 arm = (1 / size[at(c)]) * (facts.parts.rest[at(p.node)] - center[at(c)]);
    for (int k = 0; k < p.directions; ++k) {
      const Vec3& d = p.direction[static_cast<std::size_t>(k)];
      const Vec3 m = cross(arm, d);
      Eigen::Matrix<double, 6, 1> row;
      row << d.x, d.y, d.z, m.x, m.y, m.z;
      gram[at(c)] += row * row.transpose();
    }
  }
  for (const auto& pool : facts.parts.stencil_pools) {
    if (pool->sees_rigid_motion()) add_rigid_response(facts, *pool, part, center, size, gram);
  }
  for (Index c = 0; c < count; ++c) {
    std::array<double, 36> resisted{};
    std::copy_n(gram[at(c)].data(), 36, resisted.begin());
    const std::vector<double> free = free_motions(resisted);
    if (free.empty()) continue;
    const std::string motions = describe_motions(free, center[at(c)], size[at(c)]);
    const BodyData& body = body_of(facts, sample[at(c)]);
    return Error{"body \"" + body.name + "\": nothing holds " + which_part(facts, part, c, count) +
                 " against " + motions + ", so statics has no unique answer: " + what_holds(facts, part, c) +
                 "; add a dirichlet support, let one hold more nodes, or use a dynamic scheme"};
  }
  return {};
}

}  // namespace isochor
