#include "studies/design/smooth_field.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace isochor::design {

namespace {

using Faces = std::vector<std::vector<int>>;

const Faces& faces_of(CellType type) {
  static const Faces tet{{0, 1, 2}, {0, 1, 3}, {0, 2, 3}, {1, 2, 3}};
  static const Faces hex{{0, 1, 2, 3}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  return type == CellType::hex8 ? hex : tet;
}

double area_of(std::span<const Vec3> corners) {
  Vec3 sum{};
  for (std::size_t k = 2; k < corners.size(); ++k)
    sum += 0.5 * cross(corners[k - 1] - corners[0], corners[k] - corners[0]);
  return std::sqrt(dot(sum, sum));
}

Vec3 center_of(const Mesh& mesh, std::size_t cell) {
  const int corners = corners_of(mesh.cell_type);
  const auto per = static_cast<std::size_t>(nodes_per_cell(mesh.cell_type));
  Vec3 sum{};
  for (int k = 0; k < corners; ++k)
    sum += mesh.nodes[static_cast<std::size_t>(mesh.cells[cell * per + static_cast<std::size_t>(k)])];
  return (1.0 / corners) * sum;
}

}  // namespace

int corners_of(CellType type) {
  return type == CellType::hex8 ? 8 : type == CellType::tri3 ? 3 : 4;
}

double cell_volume(const Mesh& mesh, std::span<const Vec3> nodes, std::size_t cell) {
  const auto per = static_cast<std::size_t>(nodes_per_cell(mesh.cell_type));
  const auto x = [&](int k) {
    return nodes[static_cast<std::size_t>(mesh.cells[cell * per + static_cast<std::size_t>(k)])];
  };
  const auto tet = [&](int a, int b, int c, int d) {
    return dot(cross(x(b) - x(a), x(c) - x(a)), x(d) - x(a)) / 6;
  };
  if (mesh.cell_type != CellType::hex8) return tet(0, 1, 2, 3);
  // Six tets around the diagonal 0-6.
  return tet(0, 1, 2, 6) + tet(0, 2, 3, 6) + tet(0, 3, 7, 6) + tet(0, 7, 4, 6) + tet(0, 4, 5, 6) +
         tet(0, 5, 1, 6);
}

SmoothField::SmoothField(const Mesh& mesh, double length, double spread) {
  const auto n = static_cast<std::size_t>(mesh.cell_count());
  const auto per = static_cast<std::size_t>(nodes_per_cell(mesh.cell_type));
  root_volume_.resize(static_cast<Eigen::Index>(n));
  std::vector<Eigen::Triplet<double>> entries;
  std::map<std::vector<Index>, std::size_t> open;  // faces that one cell has been seen at
  for (std::size_t c = 0; c < n; ++c) {
    const double volume = cell_volume(mesh, mesh.nodes, c);
    const auto at = static_cast<int>(c);
    root_volume_[at] = std::sqrt(volume);
    entries.emplace_back(at, at, volume / (length * length));
    for (const std::vector<int>& face : faces_of(mesh.cell_type)) {
      std::vector<Index> nodes;
      std::vector<Vec3> corners;
      for (const int k : face) {
        nodes.push_back(mesh.cells[c * per + static_cast<std::size_t>(k)]);
        corners.push_back(mesh.nodes[static_cast<std::size_t>(nodes.back())]);
      }
      std::sort(nodes.begin(), nodes.end());
      const auto [found, first] = open.emplace(std::move(nodes), c);
      if (first) continue;
      const auto other = static_cast<int>(found->second);
      const Vec3 between = center_of(mesh, c) - center_of(mesh, found->second);
      const double weight = area_of(corners) / std::sqrt(dot(between, between));
      entries.emplace_back(at, at, weight);
      entries.emplace_back(other, other, weight);
      entries.emplace_back(at, other, -weight);
      entries.emplace_back(other, at, -weight);
      open.erase(found);
    }
  }
  Eigen::SparseMatrix<double> matrix(static_cast<int>(n), static_cast<int>(n));
  matrix.setFromTriplets(entries.begin(), entries.end());
  solver_ = std::make_shared<Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>>(matrix);
  constexpr double pi = 3.14159265358979323846;
  factor_ = spread * std::sqrt(8 * pi / length);
}

Eigen::VectorXd SmoothField::field(const Eigen::VectorXd& white) const {
  return factor_ * solver_->solve(root_volume_.cwiseProduct(white));
}

Eigen::MatrixXd SmoothField::times(const Eigen::MatrixXd& jacobian) const {
  const Eigen::MatrixXd solved = solver_->solve(jacobian.transpose());
  return factor_ * solved.transpose() * root_volume_.asDiagonal();
}

Eigen::VectorXd SmoothField::deviations(const Eigen::MatrixXd& jacobian) const {
  const Eigen::MatrixXd seen = times(jacobian);  // J B
  Eigen::MatrixXd inner = seen * seen.transpose();
  inner.diagonal().array() += 1;
  const Eigen::LLT<Eigen::MatrixXd> factors(inner);
  Eigen::VectorXd out(cells());
  // In parts: B itself is a full matrix.
  constexpr Eigen::Index part = 256;
  for (Eigen::Index first = 0; first < cells(); first += part) {
    const auto size = std::min(part, cells() - first);
    Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(cells(), size);
    for (Eigen::Index k = 0; k < size; ++k) unit(first + k, k) = 1;
    // Rows `first`... of B, as columns: the matrix of the equation is symmetric.
    const Eigen::MatrixXd rows = factor_ * (root_volume_.asDiagonal() * solver_->solve(unit));
    const Eigen::MatrixXd told = factors.matrixL().solve(seen * rows);
    out.segment(first, size) =
        (rows.colwise().squaredNorm() - told.colwise().squaredNorm()).cwiseMax(0.0).cwiseSqrt().transpose();
  }
  return out;
}

}  // namespace isochor::design
