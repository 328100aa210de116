#include "studies/design/morph.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "isochor/mesh_select.h"
#include "studies/design/smooth_field.h"

namespace isochor::design {

namespace {

// Corners next to each corner of a cell, in the order in which their triple product is positive.
std::vector<std::array<int, 4>> corner_frames(CellType type) {
  if (type != CellType::hex8) return {{0, 1, 2, 3}};
  return {{0, 1, 3, 4}, {1, 2, 0, 5}, {2, 3, 1, 6}, {3, 0, 2, 7},
          {4, 7, 5, 0}, {5, 4, 6, 1}, {6, 5, 7, 2}, {7, 6, 4, 3}};
}

std::vector<std::array<int, 2>> edges_of(CellType type) {
  if (type != CellType::hex8) return {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
  return {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6}, {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
}

Result<std::vector<Index>> faces_named(const Mesh& mesh, const std::string& name) {
  MeshSelection selection;
  selection.name = name;
  selection.of = {name};
  return select_faces(mesh, selection);
}

// Area-weighted outward normals at the nodes of faces; zero elsewhere.
std::vector<Vec3> normals_at(const Mesh& mesh, const std::vector<Index>& faces) {
  const auto per = static_cast<std::size_t>(nodes_per_face(mesh.cell_type));
  const std::size_t corners = mesh.cell_type == CellType::hex8 ? 4 : 3;
  std::vector<Vec3> out(mesh.nodes.size());
  for (std::size_t f = 0; f < faces.size(); f += per) {
    const auto x = [&](std::size_t k) { return mesh.nodes[static_cast<std::size_t>(faces[f + k])]; };
    const Vec3 normal = corners == 4 ? cross(x(2) - x(0), x(3) - x(1)) : cross(x(1) - x(0), x(2) - x(0));
    for (std::size_t k = 0; k < per; ++k) out[static_cast<std::size_t>(faces[f + k])] += normal;
  }
  for (Vec3& n : out) {
    const double length = std::sqrt(dot(n, n));
    if (length > 0) n = (1 / length) * n;
  }
  return out;
}

// The graph of corners with weights one over the length of edges, and who follows.
class Interior {
 public:
  Interior(const Mesh& mesh, const std::vector<char>& fixed) : mesh_(mesh), number_(mesh.nodes.size(), -1) {
    collect_edges();
    int count = 0;
    for (const auto& [a, b] : edges_) {
      for (const Index n : {a, b}) {
        int& at = number_[static_cast<std::size_t>(n)];
        if (at < 0 && !fixed[static_cast<std::size_t>(n)]) at = count++;
      }
    }
    std::vector<Eigen::Triplet<double>> entries;
    for (const auto& [a, b] : edges_) {
      const int i = number_[static_cast<std::size_t>(a)], j = number_[static_cast<std::size_t>(b)];
      const double w = weight(a, b);
      if (i >= 0) entries.emplace_back(i, i, w);
      if (j >= 0) entries.emplace_back(j, j, w);
      if (i >= 0 && j >= 0) entries.emplace_back(i, j, -w), entries.emplace_back(j, i, -w);
    }
    Eigen::SparseMatrix<double> matrix(count, count);
    matrix.setFromTriplets(entries.begin(), entries.end());
    if (count > 0) solver_.compute(matrix);
  }

  // Fills in `motion` where it is not fixed.
  void follow(std::vector<Vec3>& motion) const {
    const auto count = solver_.rows();
    if (count > 0) {
      Eigen::MatrixXd right = Eigen::MatrixXd::Zero(count, 3);
      for (const auto& [a, b] : edges_) {
        const int i = number_[static_cast<std::size_t>(a)], j = number_[static_cast<std::size_t>(b)];
        const double w = weight(a, b);
        for (int k = 0; k < 3; ++k) {
          if (i >= 0 && j < 0) right(i, k) += w * motion[static_cast<std::size_t>(b)][k];
          if (j >= 0 && i < 0) right(j, k) += w * motion[static_cast<std::size_t>(a)][k];
        }
      }
      const Eigen::MatrixXd found = solver_.solve(right);
      for (std::size_t n = 0; n < number_.size(); ++n) {
        for (int k = 0; k < 3 && number_[n] >= 0; ++k) motion[n][k] = found(number_[n], k);
      }
    }
    if (mesh_.cell_type != CellType::tet10) return;
    // Straight edges stay straight.
    const auto edges = edges_of(CellType::tet10);
    for (std::size_t c = 0; c < mesh_.cells.size(); c += 10) {
      for (std::size_t e = 0; e < 6; ++e) {
        const auto node = [&](int k) {
          return static_cast<std::size_t>(mesh_.cells[c + static_cast<std::size_t>(k)]);
        };
        motion[node(4 + static_cast<int>(e))] = 0.5 * (motion[node(edges[e][0])] + motion[node(edges[e][1])]);
      }
    }
  }

 private:
  void collect_edges() {
    const auto per = static_cast<std::size_t>(nodes_per_cell(mesh_.cell_type));
    for (std::size_t c = 0; c < mesh_.cells.size(); c += per) {
      for (const auto& [a, b] : edges_of(mesh_.cell_type)) {
        const Index i = mesh_.cells[c + static_cast<std::size_t>(a)],
                    j = mesh_.cells[c + static_cast<std::size_t>(b)];
        edges_.insert({std::min(i, j), std::max(i, j)});
      }
    }
  }
  double weight(Index a, Index b) const {
    const Vec3 d = mesh_.nodes[static_cast<std::size_t>(a)] - mesh_.nodes[static_cast<std::size_t>(b)];
    return 1 / std::sqrt(dot(d, d));
  }

  const Mesh& mesh_;
  std::vector<int> number_;
  std::set<std::pair<Index, Index>> edges_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver_;
};

Vec3 direction_of(const Move& move, const Vec3& normal) {
  switch (move.along) {
    case 'x':
      return {1, 0, 0};
    case 'y':
      return {0, 1, 0};
    case 'z':
      return {0, 0, 1};
    default:
      return normal;
  }
}

}  // namespace

Result<Morph> Morph::make(const Mesh& mesh, const std::vector<Move>& moves,
                          const std::vector<std::string>& hold) {
  Morph out;
  out.mesh_ = mesh;
  std::vector<char> held(mesh.nodes.size(), 0), fixed(mesh.nodes.size(), 0);
  for (const std::string& name : hold) {
    const auto faces = faces_named(mesh, name);
    if (!faces) return faces.failure();
    for (const Index n : faces.value())
      held[static_cast<std::size_t>(n)] = fixed[static_cast<std::size_t>(n)] = 1;
  }
  if (hold.empty()) {
    MeshSelection all;
    all.name = "boundary";
    constexpr double far = 1e9;
    all.box = {{{-far, -far, -far}, {far, far, far}}};
    const auto faces = select_faces(mesh, all);
    if (!faces) return faces.failure();
    for (const Index n : faces.value()) fixed[static_cast<std::size_t>(n)] = 1;
  }
  std::vector<std::vector<Index>> faces_moved;
  for (const Move& move : moves) {
    auto faces = faces_named(mesh, move.surface);
    if (!faces) return faces.failure();
    for (const Index n : faces.value()) fixed[static_cast<std::size_t>(n)] = 1;
    faces_moved.push_back(std::move(faces).value());
  }
  const Interior interior(mesh, fixed);
  for (std::size_t k = 0; k < moves.size(); ++k) {
    const std::vector<Vec3> normals = normals_at(mesh, faces_moved[k]);
    std::vector<Vec3> motion(mesh.nodes.size());
    bool any = false;
    for (const Index n : faces_moved[k]) {
      const auto at = static_cast<std::size_t>(n);
      if (held[at]) continue;
      motion[at] = direction_of(moves[k], normals[at]);
      any = true;
    }
    if (!any) {
      return Error{"all of surface \"" + moves[k].surface + "\" is held, so that it cannot move; hold less"};
    }
    interior.follow(motion);
    out.motions_.push_back(std::move(motion));
  }
  return out;
}

std::vector<Vec3> Morph::nodes(const std::vector<double>& amounts) const {
  std::vector<Vec3> out = mesh_.nodes;
  for (std::size_t k = 0; k < motions_.size(); ++k) {
    for (std::size_t n = 0; n < out.size(); ++n) out[n] += amounts[k] * motions_[k][n];
  }
  return out;
}

double Morph::quality(const std::vector<double>& amounts) const {
  const std::vector<Vec3> moved = nodes(amounts);
  const auto per = static_cast<std::size_t>(nodes_per_cell(mesh_.cell_type));
  const auto frames = corner_frames(mesh_.cell_type);
  double least = HUGE_VAL;
  for (std::size_t c = 0; c < mesh_.cells.size(); c += per) {
    for (const auto& frame : frames) {
      const auto determinant = [&](const std::vector<Vec3>& x) {
        const auto at = [&](std::size_t k) {
          return x[static_cast<std::size_t>(mesh_.cells[c + static_cast<std::size_t>(frame[k])])];
        };
        return dot(cross(at(1) - at(0), at(2) - at(0)), at(3) - at(0));
      };
      least = std::min(least, determinant(moved) / determinant(mesh_.nodes));
    }
  }
  return least;
}

double Morph::volume(const std::vector<double>& amounts) const {
  const std::vector<Vec3> moved = nodes(amounts);
  double sum = 0;
  for (std::size_t c = 0; c < static_cast<std::size_t>(mesh_.cell_count()); ++c)
    sum += cell_volume(mesh_, moved, c);
  return sum;
}

}  // namespace isochor::design
