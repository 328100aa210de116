#include "constraints/stencil/face_pool.h"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace isochor {

namespace {

struct TrianglePoint {
  double u, v, weight;
};

// Dunavant's six points: degree 4, exact for the volume under a curved triangle.
std::vector<TrianglePoint> degree_4() {
  std::vector<TrianglePoint> p;
  const auto three = [&](double a, double w) {
    p.push_back({a, a, w / 2});
    p.push_back({1 - 2 * a, a, w / 2});
    p.push_back({a, 1 - 2 * a, w / 2});
  };
  three(0.44594849091596488632, 0.22338158967801146570);
  three(0.091576213509770743460, 0.10995174365532186764);
  return p;
}

void push_six(FaceRule& r, const TrianglePoint& p) {
  const double b[3] = {1 - p.u - p.v, p.u, p.v};
  const double du[3] = {-1, 1, 0}, dv[3] = {-1, 0, 1};
  for (int a = 0; a < 3; ++a) {
    r.N.push_back(b[a] * (2 * b[a] - 1));
    r.N_u.push_back((4 * b[a] - 1) * du[a]);
    r.N_v.push_back((4 * b[a] - 1) * dv[a]);
  }
  for (int a = 0; a < 3; ++a) {
    const int c = (a + 1) % 3;
    r.N.push_back(4 * b[a] * b[c]);
    r.N_u.push_back(4 * (b[a] * du[c] + b[c] * du[a]));
    r.N_v.push_back(4 * (b[a] * dv[c] + b[c] * dv[a]));
  }
}

FaceRule make_triangle3() {
  FaceRule r;
  r.nodes = 3;
  r.points = 1;
  r.weight = {0.5};
  r.N = {1.0 / 3, 1.0 / 3, 1.0 / 3};
  r.N_u = {-1, 1, 0};
  r.N_v = {-1, 0, 1};
  return r;
}

FaceRule make_triangle6() {
  FaceRule r;
  r.nodes = 6;
  for (const TrianglePoint& p : degree_4()) {
    push_six(r, p);
    r.weight.push_back(p.weight);
    ++r.points;
  }
  return r;
}

FaceRule make_quadrangle4() {
  FaceRule r;
  r.nodes = 4;
  const double g = 0.5 / std::sqrt(3.0);
  for (const double u : {0.5 - g, 0.5 + g}) {
    for (const double v : {0.5 - g, 0.5 + g}) {
      r.N.insert(r.N.end(), {(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v});
      r.N_u.insert(r.N_u.end(), {v - 1, 1 - v, v, -v});
      r.N_v.insert(r.N_v.end(), {u - 1, -u, u, 1 - u});
      r.weight.push_back(0.25);
      ++r.points;
    }
  }
  return r;
}

// The points of a six-node face for one whose nodes are among its own: `tie` makes the values of these of
// those of the six, all 6 (a_0, a_1, a_2; middles of 01, 12, 20).
template <class Tie>
FaceRule tied_six(int nodes, Tie tie) {
  const FaceRule& six = triangle6_rule();
  FaceRule r;
  r.nodes = nodes;
  r.points = six.points;
  r.weight = six.weight;
  const auto all = [&](const std::vector<double>& n, std::vector<double>& out) {
    for (int q = 0; q < six.points; ++q) tie(n.data() + static_cast<std::size_t>(6 * q), out);
  };
  all(six.N, r.N);
  all(six.N_u, r.N_u);
  all(six.N_v, r.N_v);
  return r;
}

// Its edges are straight.
FaceRule make_varying_triangle() {
  return tied_six(3, [](const double* s, std::vector<double>& out) {
    out.insert(out.end(),
               {s[0] + 0.5 * (s[3] + s[5]), s[1] + 0.5 * (s[3] + s[4]), s[2] + 0.5 * (s[4] + s[5])});
  });
}

// The six-node face (apex, a, b; apex-a, ab, b-apex) with the two straight mid-nodes tied to their ends.
FaceRule make_cap4() {
  return tied_six(4, [](const double* s, std::vector<double>& out) {
    out.insert(out.end(), {s[0] + 0.5 * (s[3] + s[5]), s[1] + 0.5 * s[3], s[2] + 0.5 * s[5], s[4]});
  });
}

// A cap whose apex is the first end of its curved edge.
FaceRule make_bulge3() {
  const FaceRule& cap = cap4_rule();
  FaceRule r;
  r.nodes = 3;
  r.points = cap.points;
  r.weight = cap.weight;
  const auto merge = [&](const std::vector<double>& n, std::vector<double>& out) {
    for (int q = 0; q < cap.points; ++q) {
      const double* s = n.data() + static_cast<std::size_t>(4 * q);
      out.insert(out.end(), {s[0] + s[1], s[2], s[3]});
    }
  };
  merge(cap.N, r.N);
  merge(cap.N_u, r.N_u);
  merge(cap.N_v, r.N_v);
  return r;
}

// The first node becomes an apex that does not move.
FaceRule detach_apex(const FaceRule& with) {
  FaceRule r;
  r.nodes = with.nodes - 1;
  r.points = with.points;
  r.weight = with.weight;
  const auto split = [&](const std::vector<double>& n, std::vector<double>& rest, std::vector<double>& apex) {
    for (std::size_t k = 0; k < n.size(); ++k) {
      (k % static_cast<std::size_t>(with.nodes) == 0 ? apex : rest).push_back(n[k]);
    }
  };
  split(with.N, r.N, r.apex_N);
  split(with.N_u, r.N_u, r.apex_N_u);
  split(with.N_v, r.N_v, r.apex_N_v);
  return r;
}

struct FacePoint {
  Vec3 x, u, v;  // position, tangents
};

FacePoint face_point(const FaceRule& r, int q, std::span<const Index> nodes, std::span<const Vec3> x,
                     const Vec3& origin, const Vec3& apex = {}) {
  FacePoint p{};
  if (!r.apex_N.empty()) {
    const Vec3 d = apex - origin;
    const auto k = static_cast<std::size_t>(q);
    p = {r.apex_N[k] * d, r.apex_N_u[k] * d, r.apex_N_v[k] * d};
  }
  for (std::size_t a = 0; a < nodes.size(); ++a) {
    const std::size_t k = static_cast<std::size_t>(q) * nodes.size() + a;
    const Vec3 d = x[at(nodes[a])] - origin;
    p.x += r.N[k] * d;
    p.u += r.N_u[k] * d;
    p.v += r.N_v[k] * d;
  }
  return p;
}

}  // namespace

void raise_negative_eigenvalues(std::size_t n, Mat3* block) {
  // At most six nodes: the matrix lives on the stack.
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 18, 18>;
  Matrix h(3 * static_cast<int>(n), 3 * static_cast<int>(n));
  const auto each = [&](auto&& visit) {
    for (std::size_t a = 0, k = 0; a < n; ++a) {
      for (std::size_t b = 0; b <= a; ++b, ++k) {
        for (int i = 0; i < 3; ++i) {
          for (int j = 0; j < 3; ++j)
            visit(block[k](i, j), 3 * static_cast<int>(a) + i, 3 * static_cast<int>(b) + j);
        }
      }
    }
  };
  each([&](double& value, int row, int col) { h(row, col) = h(col, row) = value; });
  if (!h.allFinite()) return;
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(h);
  const Matrix fixed = eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() *
                       eigen.eigenvectors().transpose();
  each([&](double& value, int row, int col) { value = fixed(row, col); });
}

const FaceRule& triangle3_rule() {
  static const FaceRule rule = make_triangle3();
  return rule;
}
const FaceRule& triangle6_rule() {
  static const FaceRule rule = make_triangle6();
  return rule;
}
const FaceRule& quadrangle4_rule() {
  static const FaceRule rule = make_quadrangle4();
  return rule;
}
const FaceRule& face_rule(std::size_t nodes) {
  return nodes == 3 ? triangle3_rule() : (nodes == 4 ? quadrangle4_rule() : triangle6_rule());
}
const FaceRule& varying_face_rule(std::size_t nodes) {
  static const FaceRule triangle = make_varying_triangle();
  return nodes == 3 ? triangle : face_rule(nodes);
}

const FaceRule& cap4_rule() {
  static const FaceRule rule = make_cap4();
  return rule;
}
const FaceRule& bulge3_rule() {
  static const FaceRule rule = make_bulge3();
  return rule;
}
const FaceRule& fan2_rule() {
  static const FaceRule rule = detach_apex(triangle3_rule());
  return rule;
}
const FaceRule& fan3_rule() {
  static const FaceRule rule = detach_apex(cap4_rule());
  return rule;
}

std::vector<std::pair<Index, double>> nodal_areas(std::span<const Index> face, std::span<const Vec3> rest) {
  const FaceRule& r = face_rule(face.size());
  std::vector<std::pair<Index, double>> areas;
  for (const Index n : face) areas.emplace_back(n, 0.0);
  for (int q = 0; q < r.points; ++q) {
    const FacePoint p = face_point(r, q, face, rest, Vec3{});
    const Vec3 n = cross(p.u, p.v);
    const double da = r.weight[static_cast<std::size_t>(q)] * std::sqrt(dot(n, n));
    for (std::size_t a = 0; a < face.size(); ++a) {
      areas[a].second += da * r.N[static_cast<std::size_t>(q) * face.size() + a];
    }
  }
  return areas;
}

void EnclosedVolumePool::add_faces(const EnclosedVolumePool& other) {
  for (Index f = 0; f < other.stencils(); ++f) {
    nodes_.push(other.nodes_[f]);
    rule_.push_back(other.rule_[at(f)]);
    apex_.push_back(other.apex_[at(f)]);
    face_origin_.push_back(other.face_origin_[at(f)]);
  }
}

double EnclosedVolumePool::face_volume(Index face, std::span<const Vec3> x) const {
  const auto nodes = nodes_[face];
  const FaceRule& r = *rule_[at(face)];
  double volume = 0;
  for (int q = 0; q < r.points; ++q) {
    const FacePoint p = face_point(r, q, nodes, x, face_origin_[at(face)], apex_[at(face)]);
    volume += r.weight[static_cast<std::size_t>(q)] * scale(face, p.x) * dot(p.x, cross(p.u, p.v));
  }
  return volume;
}

double EnclosedVolumePool::volume(std::span<const Vec3> x) const {
  double sum = 0;
  for (Index f = 0; f < stencils(); ++f) sum += face_volume(f, x);
  return sum;
}

void EnclosedVolumePool::evaluate(const StencilRequest& request, const StencilSlots& slots) const {
  for (Index f = request.begin; f < request.end; ++f) {
    const auto nodes = nodes_[f];
    const std::size_t n = nodes.size(), first = at(nodes_.offset[at(f)]);
    slots.energy[at(f)] = 0;
    slots.value[at(f)] = face_volume(f, request.x);
    if (request.want == Want::value) continue;
    const FaceRule& r = *rule_[at(f)];
    const double sigma = request.function_multiplier[at(f)];
    Mat3* block = request.want == Want::hessian ? slots.hessian.data() + hessian_offset()[at(f)] : nullptr;
    if (block) std::fill_n(block, n * (n + 1) / 2, Mat3{});
    for (std::size_t a = 0; a < n; ++a) slots.jacobian[first + a] = Vec3{};
    for (int q = 0; q < r.points; ++q) {
      const FacePoint p = face_point(r, q, nodes, request.x, face_origin_[at(f)], apex_[at(f)]);
      const double weight = r.weight[static_cast<std::size_t>(q)], w = weight * scale(f, p.x);
      const Vec3 uv = cross(p.u, p.v), vx = cross(p.v, p.x), xu = cross(p.x, p.u);
      const double* N = r.N.data() + static_cast<std::size_t>(q) * n;
      const double* U = r.N_u.data() + static_cast<std::size_t>(q) * n;
      const double* V = r.N_v.data() + static_cast<std::size_t>(q) * n;
      // The slope of the weight: zero but for a first moment.
      const Vec3 slope = weighted_ ? (weight / 4) * weight_ : Vec3{};
      const Vec3 slope_term = weighted_ ? dot(p.x, uv) * slope : Vec3{};
      const auto triple_slope = [&](std::size_t a) { return N[a] * uv + U[a] * vx + V[a] * xu; };
      for (std::size_t a = 0; a < n; ++a) {
        slots.jacobian[first + a] += w * triple_slope(a);
        if (weighted_) slots.jacobian[first + a] += N[a] * slope_term;
        if (!block) continue;
        for (std::size_t b = 0; b < a; ++b) {
          Mat3& h = block[a * (a + 1) / 2 + b];
          add_cross(h, sigma * w * (U[a] * N[b] - N[a] * U[b]), p.v);
          add_cross(h, sigma * w * (N[a] * V[b] - V[a] * N[b]), p.u);
          add_cross(h, sigma * w * (V[a] * U[b] - U[a] * V[b]), p.x);
        }
        if (!weighted_) continue;
        for (std::size_t b = 0; b <= a; ++b) {
          Mat3& h = block[a * (a + 1) / 2 + b];
          add_outer(h, sigma * N[a], slope, triple_slope(b));
          add_outer(h, sigma * N[b], triple_slope(a), slope);
        }
      }
    }
    for (std::size_t a = 0; a < n; ++a) slots.gradient[first + a] = sigma * slots.jacobian[first + a];
    if (block && request.definiteness != Definiteness::exact) raise_negative_eigenvalues(n, block);
  }
}

}  // namespace isochor
