#include "engine/scene_checks.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

namespace isochor {

namespace {

// Connected parts of all bodies: a part number for every node. Stencils of any pool connect, so bodies that
// are tied together count as one.
std::vector<Index> connected_parts(const SceneFacts& facts, Index& count) {
  std::vector<Index> root(facts.parts.rest.size());
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](Index i) {
    while (root[at(i)] != i) i = root[at(i)] = root[at(root[at(i)])];
    return i;
  };
  for (const BodyData& body : facts.bodies) {
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

const BodyData& body_of(const SceneFacts& facts, Index node) {
  const BodyData* found = &facts.bodies.front();
  for (const BodyData& b : facts.bodies) {
    if (node >= b.first_node) found = &b;
  }
  return *found;
}

// Words for a free rigid motion, the first three components being the translation at the center.
std::string describe(const Eigen::Matrix<double, 6, 1>& mode) {
  static const char* const kName[6] = {"translation along x", "translation along y", "translation along z",
                                       "rotation about x",    "rotation about y",    "rotation about z"};
  int best = 0;
  mode.cwiseAbs().maxCoeff(&best);
  return kName[best];
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
    const Eigen::SelfAdjointEigenSolver<Mat6> eigen(gram[at(c)]);
    const double largest = std::max(eigen.eigenvalues()(5), 1e-300);
    std::string modes;
    for (int k = 0; k < 6; ++k) {
      if (eigen.eigenvalues()(k) > 1e-8 * largest) continue;
      modes += (modes.empty() ? "" : ", ") + describe(eigen.eigenvectors().col(k));
    }
    if (modes.empty()) continue;
    const BodyData& body = body_of(facts, sample[at(c)]);
    return Error{"body \"" + body.name + "\": nothing holds " +
                 (count > static_cast<Index>(facts.bodies.size()) ? "one of its parts" : "it") + " against " +
                 modes +
                 ", so statics has no unique answer; add a dirichlet support or use a dynamic scheme"};
  }
  return {};
}

namespace {

struct HardPool {
  std::size_t pool;
  Index first;  // number of its first row among the hard rows of one stencil pool
};

bool is_hard(const RowPool& pool) {
  if (pool.law != RowLaw::compliant || pool.rows() == 0 || pool.has_law()) return false;
  if (!pool.lower.empty() || !pool.upper.empty()) return false;  // gives way where it would contradict
  // A compliance whose rows sum to zero (a stabilization) leaves the total hard.
  std::vector<double> sum(at(pool.rows()), 0), size(at(pool.rows()), 0);
  for (const ComplianceEntry& e : pool.compliance) {
    sum[at(e.row)] += e.value;
    size[at(e.row)] += std::abs(e.value);
    if (e.row == e.col) continue;
    sum[at(e.col)] += e.value;
    size[at(e.col)] += std::abs(e.value);
  }
  for (std::size_t r = 0; r < sum.size(); ++r) {
    if (std::abs(sum[r]) > 1e-9 * size[r]) return false;
  }
  return true;
}

// Rows of the map that depend on each other whatever the positions: zero pivots of W W^T + C.
Result<void> check_repeated_rows(const SceneFacts& facts, const std::vector<HardPool>& pools, Index rows) {
  std::vector<Eigen::Triplet<double>> w, c;
  double scale = 0;
  for (const HardPool& h : pools) {
    const RowPool& pool = *facts.parts.row_pools[h.pool];
    for (Index r = 0; r < pool.rows(); ++r) {
      double norm = 0;
      for (Index k = pool.map.offset[at(r)]; k < pool.map.offset[at(r) + 1]; ++k) {
        norm += pool.weight[at(k)] * pool.weight[at(k)];
      }
      norm = std::sqrt(norm);
      scale = std::max(scale, norm);
      for (Index k = pool.map.offset[at(r)]; k < pool.map.offset[at(r) + 1]; ++k) {
        w.emplace_back(h.first + r, pool.map.item[at(k)], pool.weight[at(k)]);
      }
    }
    double largest = 1e-300;
    for (const ComplianceEntry& e : pool.compliance) largest = std::max(largest, std::abs(e.value));
    for (const ComplianceEntry& e : pool.compliance) {
      c.emplace_back(h.first + e.row, h.first + e.col, e.value / largest);
      if (e.row != e.col) c.emplace_back(h.first + e.col, h.first + e.row, e.value / largest);
    }
  }
  Index functions = 0;
  for (const auto& t : w) functions = std::max(functions, static_cast<Index>(t.col()) + 1);
  Eigen::SparseMatrix<double> W(rows, functions), C(rows, rows);
  W.setFromTriplets(w.begin(), w.end());
  C.setFromTriplets(c.begin(), c.end());
  const Eigen::SparseMatrix<double> S = Eigen::SparseMatrix<double>(W * W.transpose()) + C;
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> ldlt(S);
  const auto D = ldlt.vectorD();
  if (ldlt.info() == Eigen::Success && D.minCoeff() > 1e-10 * D.maxCoeff()) return {};
  std::string names;
  for (const HardPool& h : pools) {
    names += (names.empty() ? "\"" : ", \"") + std::string(facts.parts.row_pools[h.pool]->name()) + "\"";
  }
  return Error{"hard rows repeat or contradict each other: " + names +
               " constrain the same volumes with zero compliance (their sums coincide); drop one of them, or "
               "give one a "
               "compliance (nu < 0.5)"};
}

// A body whose whole boundary is held: its volume cannot change, so hard rows leave its mean pressure open.
Result<void> check_enclosed(const SceneFacts& facts, const std::set<Index>& hard_pools) {
  Index count = 0;
  const std::vector<Index> part = connected_parts(facts, count);
  std::vector<bool> all_hard(at(count), true), any(at(count), false);
  std::vector<Vec3> area(facts.parts.rest.size());
  std::vector<double> scale(at(count), 0);
  for (const BodyData& body : facts.bodies) {
    for (const RegionData& region : body.regions) {
      const bool hard = (region.volume_pool[0] >= 0 && hard_pools.count(region.volume_pool[0]) > 0) ||
                        (region.volume_pool[1] >= 0 && hard_pools.count(region.volume_pool[1]) > 0);
      const auto data = solid_data(*body.reference, facts.parts.rest, body.global_cells, region.cells,
                                   VolumeFunctions::none);
      if (!data) continue;
      const SolidData& d = data.value();
      for (Index s = 0; s < d.nodes.count(); ++s) {
        const auto nodes = d.nodes[s];
        any[at(part[at(nodes[0])])] = true;
        if (!hard) all_hard[at(part[at(nodes[0])])] = false;
        for (int q = 0; q < d.points; ++q) {
          for (std::size_t a = 0; a < nodes.size(); ++a) {
            const Vec3 g =
                d.weight[at(s * d.points + q)] * d.gradient[at(s * d.points + q) * nodes.size() + a];
            area[at(nodes[a])] += g;
            scale[at(part[at(nodes[a])])] = std::max(scale[at(part[at(nodes[a])])], std::sqrt(dot(g, g)));
          }
        }
      }
    }
  }
  std::vector<const PrescribedNode*> given(facts.parts.rest.size(), nullptr);
  for (const PrescribedNode& p : facts.supports.nodes) given[at(p.node)] = &p;
  std::vector<bool> open(at(count), false);
  for (std::size_t i = 0; i < area.size(); ++i) {
    Vec3 free = area[i];
    for (int k = 0; given[i] && k < given[i]->directions; ++k) {
      const Vec3& d = given[i]->direction[static_cast<std::size_t>(k)];
      free -= dot(free, d) * d;
    }
    if (std::sqrt(dot(free, free)) > 1e-7 * scale[at(part[i])]) open[at(part[i])] = true;
  }
  for (Index c = 0; c < count; ++c) {
    if (!any[at(c)] || !all_hard[at(c)] || open[at(c)]) continue;
    Index node = 0;
    while (part[at(node)] != c) ++node;
    return Error{
        "body \"" + body_of(facts, node).name +
        "\" is enclosed: every boundary node is held in the direction of its surface, so hard volume rows "
        "leave the mean pressure undetermined; free part of the boundary, or take nu < 0.5"};
  }
  return {};
}

}  // namespace

Result<void> check_hard_rows(const SceneFacts& facts) {
  std::map<Index, std::vector<HardPool>> by_stencils;
  std::map<Index, Index> rows;
  std::set<Index> hard_pools;
  Index hard_total = 0;
  std::string names;
  for (std::size_t p = 0; p < facts.parts.row_pools.size(); ++p) {
    const RowPool& pool = *facts.parts.row_pools[p];
    if (!is_hard(pool)) continue;
    by_stencils[pool.stencil_pool].push_back({p, rows[pool.stencil_pool]});
    rows[pool.stencil_pool] += pool.rows();
    hard_pools.insert(pool.stencil_pool);
    bool stabilized = false;
    for (const ComplianceEntry& e : pool.compliance) stabilized = stabilized || e.value != 0;
    if (!stabilized) {
      hard_total += pool.rows();
      names += (names.empty() ? "\"" : ", \"") + std::string(pool.name()) + "\"";
    }
  }
  Index free = 3 * static_cast<Index>(facts.parts.rest.size());
  for (const PrescribedNode& p : facts.supports.nodes) free -= p.directions;
  if (hard_total > free) {
    return Error{"there are " + std::to_string(hard_total) + " rows without compliance (" + names +
                 ") but only " + std::to_string(free) +
                 " free displacements: the constraints lock or contradict each other; use rows per node or "
                 "per body, or "
                 "nu < 0.5"};
  }
  for (const auto& [pool, list] : by_stencils) {
    if (list.size() < 2) continue;
    if (auto r = check_repeated_rows(facts, list, rows[pool]); !r) return r;
  }
  return check_enclosed(facts, hard_pools);
}

}  // namespace isochor
