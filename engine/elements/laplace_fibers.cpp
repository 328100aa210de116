// Directions from a Laplace problem on the mesh itself.
//
//   phi        linear on triangles and tets (middle nodes left out), trilinear on hexahedra; given on two
//   sides,
//              natural elsewhere; one sparse Cholesky factorization
//   cells      its gradient in the middle; with an axis the way round it, turned within the layer
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <map>

#include "engine/base/base.h"
#include "engine/mesh/cell_shape.h"
#include "engine/mesh/words.h"
#include "isochor/fiber_fields.h"
#include "isochor/mesh_select.h"

namespace isochor {

namespace {

using mesh_files::join;
using mesh_files::quoted;

// Gradients of the functions of the corners of a cell, at a point of it.
struct CellPoint {
  std::array<Vec3, 8> gradient{};
  double weight = 0;  // of the point in an integral over the cell [m^3], of triangles [m^2]
};

// From derivatives by three coordinates of which x has the derivatives J: J^-T times them.
void to_space(const std::array<Vec3, 3>& J, CellPoint& p, std::size_t corners) {
  const Vec3 a = cross(J[1], J[2]), b = cross(J[2], J[0]), c = cross(J[0], J[1]);
  const double det = dot(J[0], a);
  for (std::size_t k = 0; k < corners; ++k) {
    const Vec3 d = p.gradient[k];
    p.gradient[k] = (1 / det) * (d.x * a + d.y * b + d.z * c);
  }
  p.weight *= std::abs(det);
}

CellPoint hex_point(const Mesh& mesh, const Index* cell, const Vec3& xi) {
  CellPoint p;
  p.weight = 1;
  std::array<Vec3, 3> J{};
  for (std::size_t a = 0; a < 8; ++a) {
    p.gradient[a] = hex_gradient(a, xi);
    for (int i = 0; i < 3; ++i) J[static_cast<std::size_t>(i)] += p.gradient[a][i] * mesh.nodes[at(cell[a])];
  }
  to_space(J, p, 8);
  return p;
}

// Of a tet, or of a triangle, whose third direction is its normal.
CellPoint simplex_point(const Mesh& mesh, const Index* cell, std::size_t corners) {
  CellPoint p;
  p.gradient[0] = {-1, -1, corners == 4 ? -1.0 : 0.0};
  p.gradient[1] = {1, 0, 0};
  p.gradient[2] = {0, 1, 0};
  if (corners == 4) p.gradient[3] = {0, 0, 1};
  p.weight = corners == 4 ? 1.0 / 6 : 0.5;
  const Vec3& x = mesh.nodes[at(cell[0])];
  std::array<Vec3, 3> J{mesh.nodes[at(cell[1])] - x, mesh.nodes[at(cell[2])] - x, {}};
  J[2] = corners == 4 ? mesh.nodes[at(cell[3])] - x : direction(cross(J[0], J[1]));
  to_space(J, p, corners);
  return p;
}

class LaplaceProblem {
 public:
  LaplaceProblem(const Mesh& mesh, const LaplaceFibers& fibers) : mesh_(mesh), fibers_(fibers) {}
  Result<std::vector<Vec3>> directions();

 private:
  std::size_t corners() const { return cell_shape(mesh_.cell_type).corners; }
  const Index* cell(std::size_t c) const {
    return mesh_.cells.data() + c * static_cast<std::size_t>(nodes_per_cell(mesh_.cell_type));
  }
  Result<void> hold(const char* side, const std::vector<std::string>& names, double value);
  Result<void> check_parts() const;
  Result<void> solve();
  template <class F>
  void at_points(std::size_t c, F f) const {
    if (mesh_.cell_type != CellType::hex8) return f(simplex_point(mesh_, cell(c), corners()));
    for (const auto& s : kHexSign)
      f(hex_point(mesh_, cell(c), {kHexGauss * s[0], kHexGauss * s[1], kHexGauss * s[2]}));
  }
  Result<Vec3> direction_in(std::size_t c) const;

  const Mesh& mesh_;
  const LaplaceFibers& fibers_;
  std::map<Index, double> given_;
  std::vector<double> phi_;  // by node
};

Result<void> LaplaceProblem::hold(const char* side, const std::vector<std::string>& names, double value) {
  if (names.empty()) return Error{join(side, " names no surface; name those on which phi is ", value)};
  for (const std::string& name : names) {
    std::vector<Index> nodes;
    const auto set = std::find_if(mesh_.node_sets.begin(), mesh_.node_sets.end(),
                                  [&](const MeshNodeSet& s) { return s.name == name; });
    if (set != mesh_.node_sets.end()) {
      nodes = set->nodes;
    } else {
      MeshSelection on;
      on.name = side;
      on.of = {name};
      auto found = select_nodes(mesh_, on);
      if (!found) return Error{join(side, ": ", found.error())};
      nodes = std::move(found).value();
    }
    for (const Index n : nodes) {
      const auto [it, fresh] = given_.emplace(n, value);
      if (fresh || it->second == value) continue;
      const Vec3& X = mesh_.nodes[at(n)];
      return Error{join("node ", n, " at (", X.x, ", ", X.y, ", ", X.z, ") is both in from and in to (",
                        quoted(name), "); phi is 0 there or 1, name sides that do not meet")};
    }
  }
  return {};
}

// Every part that hangs together needs a value somewhere.
Result<void> LaplaceProblem::check_parts() const {
  std::vector<Index> root(mesh_.nodes.size());
  for (std::size_t i = 0; i < root.size(); ++i) root[i] = static_cast<Index>(i);
  const auto find = [&](Index i) {
    while (root[at(i)] != i) i = root[at(i)] = root[at(root[at(i)])];
    return i;
  };
  const auto cells = at(mesh_.cell_count());
  for (std::size_t c = 0; c < cells; ++c) {
    for (std::size_t k = 1; k < corners(); ++k) root[at(find(cell(c)[k]))] = find(cell(c)[0]);
  }
  std::vector<bool> has(root.size(), false);
  for (const auto& [node, value] : given_) has[at(find(node))] = true;
  for (std::size_t c = 0; c < cells; ++c) {
    if (has[at(find(cell(c)[0]))]) continue;
    return Error{join("the part of the mesh with cell ", c,
                      " touches neither from nor to; name sides that every part has")};
  }
  return {};
}

Result<void> LaplaceProblem::solve() {
  phi_.assign(mesh_.nodes.size(), 0);
  for (const auto& [node, value] : given_) phi_[at(node)] = value;
  std::vector<Index> unknown(mesh_.nodes.size(), -1);
  Index count = 0;
  const auto cells = at(mesh_.cell_count());
  for (std::size_t c = 0; c < cells; ++c) {
    for (std::size_t k = 0; k < corners(); ++k) {
      const Index n = cell(c)[k];
      if (unknown[at(n)] < 0 && !given_.contains(n)) unknown[at(n)] = count++;
    }
  }
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd load = Eigen::VectorXd::Zero(count);
  for (std::size_t c = 0; c < cells; ++c) {
    at_points(c, [&](const CellPoint& p) {
      for (std::size_t a = 0; a < corners(); ++a) {
        const Index i = unknown[at(cell(c)[a])];
        for (std::size_t b = 0; i >= 0 && b < corners(); ++b) {
          const Index j = unknown[at(cell(c)[b])];
          const double k = p.weight * dot(p.gradient[a], p.gradient[b]);
          if (j < 0)
            load[i] -= k * phi_[at(cell(c)[b])];
          else
            entries.emplace_back(i, j, k);
        }
      }
    });
  }
  if (count == 0) return {};
  Eigen::SparseMatrix<double> matrix(count, count);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors(matrix);
  if (factors.info() != Eigen::Success)
    return Error{"the Laplace problem has no solution on this mesh; `isochor check` tells of flat cells"};
  const Eigen::VectorXd x = factors.solve(load);
  for (std::size_t n = 0; n < unknown.size(); ++n) {
    if (unknown[n] >= 0) phi_[n] = x[unknown[n]];
  }
  return {};
}

Result<Vec3> LaplaceProblem::direction_in(std::size_t c) const {
  const CellPoint p = mesh_.cell_type == CellType::hex8 ? hex_point(mesh_, cell(c), {})
                                                        : simplex_point(mesh_, cell(c), corners());
  Vec3 gradient{}, middle{};
  double phi = 0, size = 0;
  const double share = 1.0 / static_cast<double>(corners());
  for (std::size_t k = 0; k < corners(); ++k) {
    gradient += phi_[at(cell(c)[k])] * p.gradient[k];
    middle += share * mesh_.nodes[at(cell(c)[k])];
    phi += share * phi_[at(cell(c)[k])];
    size = std::max(size, norm(mesh_.nodes[at(cell(c)[k])] - mesh_.nodes[at(cell(c)[0])]));
  }
  const auto where = [&] { return join("cell ", c, " at (", middle.x, ", ", middle.y, ", ", middle.z, ")"); };
  if (!(norm(gradient) * size > 1e-9)) {
    return Error{join("phi does not change in ", where(),
                      ", which has no direction then; name sides that the fibers go between")};
  }
  const Vec3 along = direction(gradient);
  if (dot(fibers_.axis, fibers_.axis) == 0) return along;
  const Vec3 around = cross(fibers_.axis, along);
  if (!(norm(around) > 1e-6 * norm(fibers_.axis))) {
    return Error{join("the axis runs along the gradient of phi in ", where(),
                      ", so that there is no way round it; give another axis, or none")};
  }
  const Vec3 e = direction(around), up = cross(along, e);
  const double angle = fibers_.angle_from + (fibers_.angle_to - fibers_.angle_from) * phi;
  return std::cos(angle) * e + std::sin(angle) * up;
}

Result<std::vector<Vec3>> LaplaceProblem::directions() {
  if (!finite(fibers_.axis) || !std::isfinite(fibers_.angle_from) || !std::isfinite(fibers_.angle_to))
    return Error{"axis, angle_from and angle_to must be finite numbers"};
  if (dot(fibers_.axis, fibers_.axis) == 0 && (fibers_.angle_from != 0 || fibers_.angle_to != 0)) {
    return Error{join("angle_from = ", fibers_.angle_from, " and angle_to = ", fibers_.angle_to,
                      " rad are angles to an axis, and there is none; give the axis")};
  }
  if (auto r = hold("from", fibers_.from, 0); !r) return r.failure();
  if (auto r = hold("to", fibers_.to, 1); !r) return r.failure();
  if (auto r = check_parts(); !r) return r.failure();
  if (auto r = solve(); !r) return r.failure();
  std::vector<Vec3> out;
  for (std::size_t c = 0; c < at(mesh_.cell_count()); ++c) {
    auto one = direction_in(c);
    if (!one) return one.failure();
    out.push_back(one.value());
  }
  return out;
}

}  // namespace

Result<std::vector<Vec3>> laplace_directions(const Mesh& mesh, const LaplaceFibers& fibers) {
  return LaplaceProblem(mesh, fibers).directions();
}

}  // namespace isochor
