#include "engine/scene/scene_checks.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>

#include "engine/base/text.h"

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

const BodyData& body_of(const SceneFacts& facts, Index node) {
  const BodyData* found = &facts.bodies.front();
  for (const BodyData& b : facts.bodies) {
    if (!b.present()) continue;
    if (node >= b.first_node) found = &b;
  }
  return *found;
}

std::string shown(const Eigen::Vector3d& v) {
  return std::string("(") + number(v.x()) + ", " + number(v.y()) + ", " + number(v.z()) + ")";
}

// The directions of a space: axes where they span it, else vectors. Columns are orthonormal.
std::string directions(const Eigen::MatrixXd& space) {
  std::string axes, vectors;
  Eigen::Index found = 0;
  for (int k = 0; k < 3; ++k) {
    if (space.row(k).norm() < 1 - 1e-6) continue;
    axes += (found == 0 ? "" : (found + 1 == space.cols() ? " and " : ", ")) + std::string(1, "xyz"[k]);
    ++found;
  }
  if (found == space.cols()) return axes;
  for (Eigen::Index c = 0; c < space.cols(); ++c) {
    Eigen::Vector3d v = space.col(c);
    v = (v.array().abs() < 1e-9).select(0, v);
    vectors += (c == 0 ? "" : " and ") + shown(v);
  }
  return vectors;
}

// Words for the free rigid motions of a part. Columns of `modes` are orthonormal; the first three components
// are the translation at `center`, the others the rotation times `size`.
std::string describe(const Eigen::MatrixXd& modes, const Eigen::Vector3d& center, double size) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> turns(modes.bottomRows(3),
                                                Eigen::ComputeThinU | Eigen::ComputeFullV);
  const auto values = turns.singularValues();
  Eigen::Index rank = 0;
  while (rank < values.size() && values[rank] > 1e-6) ++rank;
  // What turns nothing is a translation.
  const Eigen::MatrixXd shifts = modes.topRows(3) * turns.matrixV().rightCols(modes.cols() - rank);
  std::string text;
  if (shifts.cols() > 0) text = "translation along " + directions(shifts);
  if (rank == 0) return text;
  text += (text.empty() ? "" : " and ") + ("rotation about " + directions(turns.matrixU().leftCols(rank)));
  if (shifts.cols() > 0) return text;
  // The point that all of them leave where it is: t + w x (p - center) = 0, w = rotation / size.
  Eigen::MatrixXd crosses(3 * modes.cols(), 3);
  Eigen::VectorXd shift(3 * modes.cols());
  for (Eigen::Index c = 0; c < modes.cols(); ++c) {
    const Eigen::Vector3d w = modes.col(c).tail(3) / size;
    crosses.middleRows(3 * c, 3) << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
    shift.segment(3 * c, 3) = -modes.col(c).head(3);
  }
  const Eigen::Vector3d arm = crosses.completeOrthogonalDecomposition().solve(shift);
  if ((crosses * arm - shift).norm() > 1e-6) return text;
  Eigen::Vector3d point = center + arm;
  for (int k = 0; k < 3; ++k) {
    if (std::abs(point[k]) < 1e-9 * size) point[k] = 0;
  }
  return text + " through " + shown(point) + " m";
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
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
  Index nodes = 0;
  for (std::size_t i = 0; i < part.size(); ++i) {
    if (part[i] != which) continue;
    const Vec3& x = facts.parts.rest[i];
    low = low.cwiseMin(Eigen::Vector3d(x.x, x.y, x.z));
    high = high.cwiseMax(Eigen::Vector3d(x.x, x.y, x.z));
    ++nodes;
  }
  return "one of its parts (" + std::to_string(nodes) + " nodes from " + shown(low) + " to " + shown(high) +
         " m)";
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
    Eigen::Index free = 0;
    while (free < 6 && eigen.eigenvalues()(free) <= 1e-8 * largest) ++free;
    if (free == 0) continue;
    const Vec3& middle = center[at(c)];
    const std::string motions =
        describe(eigen.eigenvectors().leftCols(free), {middle.x, middle.y, middle.z}, size[at(c)]);
    const BodyData& body = body_of(facts, sample[at(c)]);
    return Error{"body \"" + body.name + "\": nothing holds " + which_part(facts, part, c, count) +
                 " against " + motions + ", so statics has no unique answer: " + what_holds(facts, part, c) +
                 "; add a dirichlet support, let one hold more nodes, or use a dynamic scheme"};
  }
  return {};
}

namespace {

bool is_hard(const RowPool& pool) {
  if (pool.law != RowLaw::compliant || pool.rows() == 0 || pool.facets().law) return false;
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

// One hard row over functions that have the same number wherever they stand for the same cells.
struct HardRow {
  Index pool = -1;  // of parts.row_pools; -1: a volume that supports fix
  Index row = 0;
  Index part = -1;  // of a fixed volume
  std::vector<std::pair<std::int64_t, double>> terms;
};

// Numbers functions: those of solids by body, cell and place in it, so that pools over the same cells meet;
// others by pool.
class FunctionNumbers {
 public:
  explicit FunctionNumbers(const SceneFacts& facts) : facts_(facts) {
    for (const BodyData& b : facts.bodies) {
      if (!b.present()) continue;
      first_.push_back(next_);
      next_ += static_cast<std::int64_t>(b.mesh.cell_count()) * kMost;
    }
    for (std::size_t p = 0; p < facts.parts.stencil_pools.size(); ++p) {
      other_.push_back(next_);
      next_ += static_cast<std::int64_t>(facts.parts.stencil_pools[p]->stencils()) *
               facts.parts.stencil_pools[p]->functions();
    }
  }
  std::int64_t of_cell(std::size_t body, Index cell, int k) const { return first_[body] + cell * kMost + k; }
  std::int64_t operator()(Index pool, Index item) const {
    const auto functions = facts_.parts.stencil_pools[at(pool)]->functions();
    for (std::size_t b = 0; b < facts_.bodies.size(); ++b) {
      const BodyData& body = facts_.bodies[b];
      if (!body.present()) continue;
      for (const RegionData& r : body.regions) {
        if (r.has_volume_pool(pool)) return of_cell(b, r.cells[at(item / functions)], item % functions);
      }
      for (const SpanningVolume& v : body.spanning) {
        if (v.pool != pool) continue;
        const auto& data = static_cast<const SolidPool&>(*facts_.parts.stencil_pools[at(pool)]).data();
        return of_cell(b, data.cell[at(item / functions)], item % functions);
      }
    }
    return other_[at(pool)] + item;
  }

 private:
  static constexpr std::int64_t kMost = 8;  // functions of a cell
  const SceneFacts& facts_;
  std::vector<std::int64_t> first_, other_;
  std::int64_t next_ = 0;
};

std::string name_rows(const SceneFacts& facts, const std::vector<HardRow>& rows,
                      const std::vector<std::size_t>& involved) {
  std::map<Index, std::vector<Index>> by_pool;
  for (const std::size_t i : involved) {
    if (rows[i].pool >= 0) by_pool[rows[i].pool].push_back(rows[i].row);
  }
  std::string names;
  for (const auto& [p, list] : by_pool) {
    const RowPool& pool = *facts.parts.row_pools[at(p)];
    names += (names.empty() ? "\"" : ", \"") + std::string(pool.name()) + "\"";
    if (pool.rows() == 1) continue;
    const auto count = static_cast<Index>(list.size());
    if (count == pool.rows()) {
      names += " (all of its " + std::to_string(count) + " rows)";
    } else {
      names += " (" + std::to_string(count) + " of its " + std::to_string(pool.rows()) + " rows)";
    }
  }
  return names;
}

// Rows of the map that depend on each other whatever the positions: zero pivots of W W^T + C.
Result<void> check_independent_rows(const SceneFacts& facts, const std::vector<HardRow>& rows) {
  const auto count = static_cast<Eigen::Index>(rows.size());
  std::vector<Eigen::Triplet<double>> w, c;
  std::map<std::int64_t, int> column;
  std::map<Index, std::map<Index, Eigen::Index>> place;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    double norm = 0;
    for (const auto& [f, weight] : rows[r].terms) norm += weight * weight;
    for (const auto& [f, weight] : rows[r].terms) {
      const int col = column.emplace(f, static_cast<int>(column.size())).first->second;
      w.emplace_back(static_cast<int>(r), col, weight / std::sqrt(norm));
    }
    if (rows[r].pool >= 0) place[rows[r].pool][rows[r].row] = static_cast<Eigen::Index>(r);
  }
  // Rows are scaled to length one, a stabilization with them: what it maps to zero stays so.
  std::vector<double> length(rows.size());
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (const auto& [f, weight] : rows[r].terms) length[r] += weight * weight;
    length[r] = std::sqrt(length[r]);
  }
  for (const auto& [p, of_row] : place) {
    double largest = 1e-300;
    for (const ComplianceEntry& e : facts.parts.row_pools[at(p)]->compliance)
      largest = std::max(largest, std::abs(e.value));
    for (const ComplianceEntry& e : facts.parts.row_pools[at(p)]->compliance) {
      // Rows that were left out are not there.
      if (!of_row.contains(e.row) || !of_row.contains(e.col)) continue;
      const Eigen::Index i = of_row.at(e.row), j = of_row.at(e.col);
      const double v =
          e.value / largest / (length[static_cast<std::size_t>(i)] * length[static_cast<std::size_t>(j)]);
      c.emplace_back(static_cast<int>(i), static_cast<int>(j), v);
      if (i != j) c.emplace_back(static_cast<int>(j), static_cast<int>(i), v);
    }
  }
  Eigen::SparseMatrix<double> W(count, static_cast<Eigen::Index>(column.size())), C(count, count);
  W.setFromTriplets(w.begin(), w.end());
  C.setFromTriplets(c.begin(), c.end());
  // An exact zero would stop the factorization and leave D and L unwritten behind it.
  Eigen::SparseMatrix<double> rounding(count, count);
  rounding.setIdentity();
  const Eigen::SparseMatrix<double> S = Eigen::SparseMatrix<double>(W * W.transpose()) + C + 1e-13 * rounding;
  // A check may not cost more than the solve. Rows that couple so much are left to the solver.
  constexpr Eigen::Index kMostNonzeros = 4'000'000;
  if (S.nonZeros() > kMostNonzeros) return {};
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> ldlt(S);
  if (ldlt.info() != Eigen::Success) {
    std::vector<std::size_t> all(rows.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    return Error{"hard rows repeat or contradict each other: " + name_rows(facts, rows, all) +
                 "; drop some of them, or give them a compliance (nu < 0.5)"};
  }
  const Eigen::VectorXd D = ldlt.vectorD();
  const double largest = D.maxCoeff();
  Eigen::Index zero = 0;
  while (zero < count && D[zero] > 1e-10 * largest) ++zero;
  if (zero == count) return {};
  // The combination of rows that vanishes: L^T y = e at the first zero pivot, in the order of the pivots.
  Eigen::VectorXd y = Eigen::VectorXd::Unit(count, zero);
  ldlt.matrixL().transpose().solveInPlace(y);
  y = ldlt.permutationPinv() * y;
  std::vector<std::size_t> involved;
  Index part = -1;
  for (Eigen::Index r = 0; r < count; ++r) {
    if (std::abs(y[r]) < 1e-6 * y.cwiseAbs().maxCoeff()) continue;
    involved.push_back(static_cast<std::size_t>(r));
    if (rows[static_cast<std::size_t>(r)].part >= 0) part = rows[static_cast<std::size_t>(r)].part;
  }
  if (part >= 0) {
    return Error{
        "body \"" + facts.bodies[at(part)].name +
        "\" is enclosed: every boundary node is held in the direction of its surface, so hard volume rows "
        "leave the mean pressure undetermined; free part of the boundary, or take nu < 0.5"};
  }
  return Error{"hard rows repeat or contradict each other: " + name_rows(facts, rows, involved) +
               " constrain the same volumes with zero compliance (what one says follows from the others); "
               "drop one of them, or give one a compliance (nu < 0.5)"};
}

// Parts whose whole boundary is held, as a row each: their volume cannot change.
std::vector<HardRow> fixed_volumes(const SceneFacts& facts, const FunctionNumbers& number) {
  Index count = 0;
  const std::vector<Index> part = connected_parts(facts, count);
  std::vector<Vec3> area(facts.parts.rest.size());
  std::vector<double> scale(at(count), 0);
  std::vector<HardRow> rows(at(count));
  for (std::size_t b = 0; b < facts.bodies.size(); ++b) {
    const BodyData& body = facts.bodies[b];
    if (!body.present()) continue;
    const int functions = body.reference->points > 1 ? body.reference->corners : 1;
    for (const RegionData& region : body.regions) {
      const auto data = solid_data(*body.reference, facts.parts.rest, body.global_cells, region.cells,
                                   VolumeFunctions::none);
      if (!data) continue;
      const SolidData& d = data.value();
      for (Index s = 0; s < d.nodes.count(); ++s) {
        const auto nodes = d.nodes[s];
        HardRow& row = rows[at(part[at(nodes[0])])];
        row.part = static_cast<Index>(b);
        for (int k = 0; k < functions; ++k)
          row.terms.emplace_back(number.of_cell(b, region.cells[at(s)], k), 1.0);
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
  std::vector<HardRow> fixed;
  for (Index c = 0; c < count; ++c) {
    if (!open[at(c)] && !rows[at(c)].terms.empty()) fixed.push_back(std::move(rows[at(c)]));
  }
  return fixed;
}

// Groups of rows that have functions in common, each group by itself.
std::vector<std::vector<HardRow>> connected_groups(std::vector<HardRow> rows) {
  std::vector<std::size_t> root(rows.size());
  std::iota(root.begin(), root.end(), std::size_t{0});
  const auto find = [&](std::size_t i) {
    while (root[i] != i) i = root[i] = root[root[i]];
    return i;
  };
  std::map<std::int64_t, std::size_t> holder;
  std::map<Index, std::size_t> of_pool;  // a pool's compliance may couple its rows
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (rows[r].pool >= 0) root[find(r)] = find(of_pool.emplace(rows[r].pool, r).first->second);
    for (const auto& [f, weight] : rows[r].terms) root[find(r)] = find(holder.emplace(f, r).first->second);
  }
  std::map<std::size_t, std::vector<HardRow>> groups;
  for (std::size_t r = 0; r < rows.size(); ++r) groups[find(r)].push_back(std::move(rows[r]));
  std::vector<std::vector<HardRow>> out;
  for (auto& [r, group] : groups) out.push_back(std::move(group));
  return out;
}

// Rows that cannot depend on each other, those of one pool that share no function; and pressure spaces, whose
// weights add up to one everywhere: rows at nodes, with a stabilization against what depends, or without one
// because the author took it away.
bool plainly_independent(const SceneFacts& facts, const std::vector<HardRow>& group) {
  for (const HardRow& row : group) {
    if (row.pool != group.front().pool || row.pool < 0) return false;
  }
  if (!facts.parts.row_pools[at(group.front().pool)]->compliance.empty()) return true;
  std::map<std::int64_t, double> sum;
  bool shared = false;
  for (const HardRow& row : group) {
    for (const auto& [f, weight] : row.terms) {
      const auto [it, fresh] = sum.emplace(f, 0.0);
      shared = shared || !fresh;
      it->second += weight;
    }
  }
  return !shared || std::all_of(sum.begin(), sum.end(),
                                [](const auto& entry) { return std::abs(entry.second - 1) < 1e-9; });
}

// A function whose nodes are all held in all directions is what supports make it; rows over such functions
// alone have nothing to act on and are left out (System), unless a stabilization couples them to others.
bool is_fixed(const SceneFacts& facts, Index stencil_pool, Index item, std::span<const std::uint8_t> held) {
  const StencilPool& stencils = *facts.parts.stencil_pools[at(stencil_pool)];
  const auto nodes = stencils.nodes()[item / stencils.functions()];
  return std::all_of(nodes.begin(), nodes.end(), [&](Index n) { return held[at(n)] != 0; });
}

}  // namespace

Result<void> check_hard_rows(const SceneFacts& facts) {
  const FunctionNumbers number(facts);
  std::vector<HardRow> rows;
  Index hard_total = 0;
  std::string names;
  std::set<std::int64_t> fixed;  // functions of cells whose nodes are all held
  std::vector<std::uint8_t> held(facts.parts.rest.size(), 0);
  for (const PrescribedNode& p : facts.supports.nodes) held[at(p.node)] = p.directions == 3 ? 1 : 0;
  for (std::size_t p = 0; p < facts.parts.row_pools.size(); ++p) {
    const RowPool& pool = *facts.parts.row_pools[p];
    if (!is_hard(pool)) continue;
    Index acting = 0;
    for (Index r = 0; r < pool.rows(); ++r) {
      HardRow row{static_cast<Index>(p), r, -1, {}};
      for (Index k = pool.map.offset[at(r)]; k < pool.map.offset[at(r) + 1]; ++k) {
        const Index item = pool.map.item[at(k)];
        const std::int64_t f = number(pool.stencil_pool, item);
        if (pool.compliance.empty() && is_fixed(facts, pool.stencil_pool, item, held))
          fixed.insert(f);
        else
          row.terms.emplace_back(f, pool.weight[at(k)]);
      }
      if (row.terms.empty()) continue;
      ++acting;
      rows.push_back(std::move(row));
    }
    bool stabilized = false;
    for (const ComplianceEntry& e : pool.compliance) stabilized = stabilized || e.value != 0;
    if (!stabilized) {
      hard_total += acting;
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
  if (rows.empty()) return {};
  for (HardRow& whole : fixed_volumes(facts, number)) {
    std::erase_if(whole.terms, [&](const auto& term) { return fixed.contains(term.first); });
    if (!whole.terms.empty()) rows.push_back(std::move(whole));
  }
  for (const auto& group : connected_groups(std::move(rows))) {
    if (group.size() < 2 || plainly_independent(facts, group)) continue;
    if (auto r = check_independent_rows(facts, group); !r) return r;
  }
  return {};
}

}  // namespace isochor
