// How a set of nodes has turned since rest: the rotation that fits best (Kabsch 1976), and where a face
// looks.
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "engine/base/out_of_memory.h"
#include "engine/mesh/cell_shape.h"
#include "engine/world/world_impl.h"

namespace isochor {

namespace {

using Corners = std::array<Index, 4>;  // of a face; the last of a triangle is -1

Eigen::Vector3d eigen(const Vec3& v) {
  return {v.x, v.y, v.z};
}
Vec3 plain(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

Corners sorted(Corners c) {
  std::sort(c.begin(), c.end());
  return c;
}

// Faces of the surfaces by their corners, each counterclockwise as seen from outside of the first cell that
// has it. Node numbers are those of the mesh.
std::vector<Corners> outward_faces(const Mesh& mesh, std::span<const Index> faces) {
  const CellShape& shape = cell_shape(mesh.cell_type);
  const auto per_face = static_cast<std::size_t>(nodes_per_face(mesh.cell_type));
  const auto per_cell = static_cast<std::size_t>(nodes_per_cell(mesh.cell_type));
  std::map<Corners, bool> wanted;
  for (std::size_t f = 0; f + per_face <= faces.size(); f += per_face) {
    Corners c{-1, -1, -1, -1};
    std::copy_n(faces.begin() + static_cast<std::ptrdiff_t>(f), shape.side_corners, c.begin());
    wanted.emplace(sorted(c), true);
  }
  std::vector<Corners> out;
  for (std::size_t c = 0; c + per_cell <= mesh.cells.size(); c += per_cell) {
    for (std::size_t side = 0; side < shape.sides; ++side) {
      Corners here{-1, -1, -1, -1};
      for (std::size_t k = 0; k < shape.side_corners; ++k) here[k] = mesh.cells[c + shape.side[side][k]];
      const auto it = wanted.find(sorted(here));
      if (it == wanted.end() || !it->second) continue;
      it->second = false;
      out.push_back(here);
    }
  }
  return out;
}

// Half the cross product of the diagonals: the area vector of a triangle, and of a quadrilateral whatever its
// warp.
Vec3 area_vector(const Corners& f, std::span<const Vec3> x) {
  const Vec3 &a = x[at(f[0])], &b = x[at(f[1])], &c = x[at(f[2])];
  return f[3] < 0 ? 0.5 * cross(b - a, c - a) : 0.5 * cross(c - a, x[at(f[3])] - b);
}

struct WeightedSet {
  std::vector<Index> nodes;    // of the mesh
  std::vector<double> weight;  // sum 1
  std::vector<Corners> faces;  // of surfaces
};

// Corners count by the area around them; nodes in the middle of edges lie between them and do not count.
void weigh_by_area(WeightedSet& set, std::span<const Vec3> rest) {
  std::map<Index, double> area;
  for (const Corners& f : set.faces) {
    const Vec3 a = area_vector(f, rest);
    const double size = std::sqrt(dot(a, a));
    for (const Index n : f) {
      if (n >= 0) area[n] += size;
    }
  }
  for (std::size_t i = 0; i < set.nodes.size(); ++i) {
    const auto it = area.find(set.nodes[i]);
    set.weight[i] = it == area.end() ? 0 : it->second;
  }
}

WeightedSet weighted_set(const BodyData& body, const Selection& where, std::span<const Index> scene_nodes) {
  WeightedSet set;
  for (const Index n : scene_nodes) set.nodes.push_back(n - body.first_node);
  set.weight.assign(set.nodes.size(), 1);
  const bool surfaces_only = !where.surfaces.empty() && where.regions.empty() && where.node_sets.empty() &&
                             where.nodes.empty() && where.boxes.empty() && where.nearest.empty() &&
                             !where.everything;
  if (surfaces_only) {
    std::vector<Index> all;
    for (const MeshSurface& s : body.mesh.surfaces) {
      if (std::find(where.surfaces.begin(), where.surfaces.end(), s.name) != where.surfaces.end())
        all.insert(all.end(), s.faces.begin(), s.faces.end());
    }
    set.faces = outward_faces(body.mesh, all);
    if (!set.faces.empty()) weigh_by_area(set, body.mesh.nodes);
  }
  double sum = 0;
  for (const double w : set.weight) sum += w;
  for (double& w : set.weight) w /= sum;
  return set;
}

Eigen::Vector3d middle(const WeightedSet& set, std::span<const Vec3> x) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < set.nodes.size(); ++i) sum += set.weight[i] * eigen(x[at(set.nodes[i])]);
  return sum;
}

// Sum of the products of the distances from the middles.
Eigen::Matrix3d moments(const WeightedSet& set, std::span<const Vec3> a, std::span<const Vec3> b) {
  const Eigen::Vector3d ma = middle(set, a), mb = middle(set, b);
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < set.nodes.size(); ++i) {
    const auto n = at(set.nodes[i]);
    sum += set.weight[i] * (eigen(b[n]) - mb) * (eigen(a[n]) - ma).transpose();
  }
  return sum;
}

// Of a set that is no surface: the direction of its smallest extent at rest, pointing away from the body.
Eigen::Vector3d flat_direction(const WeightedSet& set, std::span<const Vec3> rest) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> extents(moments(set, rest, rest));
  // Squares of extents: a set that is about as thick as it is wide has no such direction.
  if (extents.eigenvalues()(0) > 0.5 * extents.eigenvalues()(1)) return Eigen::Vector3d::Zero();
  Eigen::Vector3d n = extents.eigenvectors().col(0);
  Eigen::Vector3d body = Eigen::Vector3d::Zero();
  for (const Vec3& X : rest) body += eigen(X) / static_cast<double>(rest.size());
  double side = n.dot(middle(set, rest) - body);
  if (std::abs(side) <= 1e-9 * std::sqrt(extents.eigenvalues()(2))) n.cwiseAbs().maxCoeff(&side);
  return side < 0 ? Eigen::Vector3d(-n) : n;
}

Vec3 mean_normal(const WeightedSet& set, std::span<const Vec3> x) {
  Vec3 sum{};
  double area = 0;
  for (const Corners& f : set.faces) {
    const Vec3 a = area_vector(f, x);
    sum += a;
    area += std::sqrt(dot(a, a));
  }
  const double length = std::sqrt(dot(sum, sum));
  return length > 1e-6 * area ? (1 / length) * sum : Vec3{};
}

Error without_rotation(std::size_t nodes, const char* when) {
  return Error{"the " + std::to_string(nodes) + " selected nodes lie on one line or in one point " + when +
               ", which has no rotation; select nodes that span a face"};
}

}  // namespace

Result<Orientation> World::orientation(const Selection& where) const try {
  Impl& w = *impl_;
  if (auto r = w.compile(); !r) return r.failure();
  const auto selected = w.said.builder.select(where, "orientation");
  if (!selected) return selected.failure();
  const BodyData& body = w.said.builder.body(where.body);
  const auto rest = std::span<const Vec3>(body.mesh.nodes);
  const auto x = positions(where.body);
  const WeightedSet set = weighted_set(body, where, selected.value());
  constexpr double kThin = 1e-12;  // squares of extents that are told apart from nothing
  const Eigen::Vector3d spread =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(moments(set, rest, rest)).eigenvalues();
  if (!(spread(1) > kThin * spread(2))) return without_rotation(set.nodes.size(), "at rest");
  const Eigen::JacobiSVD<Eigen::Matrix3d> fit(moments(set, rest, x),
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  if (!(fit.singularValues()(1) > kThin * spread(2))) return without_rotation(set.nodes.size(), "now");
  Eigen::Matrix3d mend = Eigen::Matrix3d::Identity();
  mend(2, 2) = (fit.matrixU() * fit.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  const Eigen::Matrix3d R = fit.matrixU() * mend * fit.matrixV().transpose();
  Orientation out;
  const Eigen::AngleAxisd turn(R);
  out.angle = turn.angle();
  // Nothing but rounding: no turn.
  if (out.angle > 1e-14) out.axis = plain(turn.axis());
  const Eigen::Vector3d from = middle(set, rest), to = middle(set, x);
  out.displacement = plain(to - from);
  out.normal = set.faces.empty() ? plain(R * flat_direction(set, rest)) : mean_normal(set, x);
  for (std::size_t i = 0; i < set.nodes.size(); ++i) {
    const auto n = at(set.nodes[i]);
    out.misfit += set.weight[i] * (eigen(x[n]) - to - R * (eigen(rest[n]) - from)).squaredNorm();
  }
  out.misfit = std::sqrt(out.misfit);
  return out;
} catch (const std::bad_alloc&) {
  return no_memory("orientation");
}

}  // namespace isochor
