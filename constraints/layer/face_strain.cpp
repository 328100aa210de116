#include "constraints/layer/face_strain.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace isochor {

FaceStrainPool::FaceStrainPool(std::string name, Gives gives, std::size_t nodes_per_face,
                               std::span<const Index> faces, std::span<const Vec3> rest)
    : name_(std::move(name)), gives_(gives), rule_(&face_rule(nodes_per_face)) {
  for (std::size_t f = 0; f < faces.size(); f += nodes_per_face) {
    const auto nodes = faces.subspan(f, nodes_per_face);
    nodes_.push(nodes);
    for (std::size_t p = 0; p < points(); ++p) {
      const double* U = rule_->N_u.data() + p * nodes_per_face;
      const double* V = rule_->N_v.data() + p * nodes_per_face;
      Vec3 u, v;
      for (std::size_t a = 1; a < nodes_per_face; ++a) {
        const Vec3 d = rest[at(nodes[a])] - rest[at(nodes[0])];
        u += U[a] * d;
        v += V[a] * d;
      }
      const Vec3 normal = cross(u, v);
      const double area = std::sqrt(dot(normal, normal)), length = std::sqrt(dot(u, u));
      Frame frame;
      frame.t1 = (1 / length) * u;
      frame.t2 = (1 / area) * cross(normal, frame.t1);
      frame.weight = rule_->weight[p] * area;
      frame_.push_back(frame);
      // u = length t1, v = shear t1 + height t2; slopes by the chain rule.
      const double shear = dot(v, frame.t1), height = area / length;
      for (std::size_t a = 0; a < nodes_per_face; ++a) {
        const double along = U[a] / length;
        slope_.push_back({along, (V[a] - shear * along) / height});
      }
    }
  }
  finish_topology();
}

double FaceStrainPool::rest_area(Index face) const {
  double sum = 0;
  for (std::size_t p = 0; p < points(); ++p) sum += frame_[at(face) * points() + p].weight;
  return sum;
}

double FaceStrainPool::area(std::span<const Vec3> x, std::span<const Vec3> rest) const {
  double sum = 0;
  for (Index f = 0; f < stencils(); ++f) {
    for (std::size_t p = 0; p < points(); ++p) {
      const double q = 1 + strain(f, p, x, rest).q_minus_1();
      sum += frame_[at(f) * points() + p].weight * std::sqrt(std::max(q, 0.0));
    }
  }
  return sum;
}

FaceStrainPool::Strain FaceStrainPool::strain(Index face, std::size_t point, std::span<const Vec3> x,
                                              std::span<const Vec3> rest) const {
  const auto nodes = nodes_[face];
  const std::size_t k = at(face) * points() + point;
  const Slope* B = slope_.data() + k * nodes.size();
  const Vec3 u0 = x[at(nodes[0])] - rest[at(nodes[0])];
  Vec3 h1, h2;
  for (std::size_t a = 1; a < nodes.size(); ++a) {
    const Vec3 u = x[at(nodes[a])] - rest[at(nodes[a])] - u0;
    h1 += B[a].u * u;
    h2 += B[a].v * u;
  }
  const Frame& t = frame_[k];
  Strain e;
  e.f1 = t.t1 + h1;
  e.f2 = t.t2 + h2;
  e.e11 = dot(t.t1, h1) + 0.5 * dot(h1, h1);
  e.e22 = dot(t.t2, h2) + 0.5 * dot(h2, h2);
  e.g = dot(t.t1, h2) + dot(t.t2, h1) + dot(h1, h2);
  return e;
}

// With K = adj C = dq/dC: S = 2 W_I 1 + 2 W_q K and dS/dE = 4 W_qq K K + 2 W_q M, where M is the constant
// derivative of K by E, both in the order (11, 22, 12) against (e11, e22, 2 e12).
void FaceStrainPool::add_point(const StencilSlots& slots, Index face, std::size_t point, const Strain& e,
                               const FaceResponse& w, double factor, std::span<Vec3> slope,
                               bool hessian) const {
  const std::size_t n = nodes_[face].size(), k = at(face) * points() + point;
  const Slope* B = slope_.data() + k * n;
  const double weight = frame_[k].weight;
  const double K[3] = {1 + 2 * e.e22, 1 + 2 * e.e11, -e.g};
  // The ones of 2 W_I 1 and 2 W_q K cancel at rest: taken together first.
  const double isotropic = 2 * (w.I + w.q);
  const double S[3] = {isotropic + 4 * w.q * e.e22, isotropic + 4 * w.q * e.e11, -2 * w.q * e.g};
  for (std::size_t a = 0; a < n; ++a) {
    slope[a] += weight * ((B[a].u * S[0] + B[a].v * S[2]) * e.f1 + (B[a].u * S[2] + B[a].v * S[1]) * e.f2);
  }
  if (!hessian) return;
  double D[3][3];
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) D[i][j] = 4 * w.qq * K[i] * K[j];
  }
  D[0][1] += 4 * w.q;
  D[1][0] += 4 * w.q;
  D[2][2] -= 2 * w.q;
  const auto strain_slopes = [&](std::size_t a, Vec3 out[3]) {
    out[0] = B[a].u * e.f1;
    out[1] = B[a].v * e.f2;
    out[2] = B[a].u * e.f2 + B[a].v * e.f1;
  };
  Mat3* block = slots.hessian.data() + hessian_offset()[at(face)];
  for (std::size_t a = 0; a < n; ++a) {
    Vec3 ea[3], Da[3];
    strain_slopes(a, ea);
    for (std::size_t i = 0; i < 3; ++i) Da[i] = D[i][0] * ea[0] + D[i][1] * ea[1] + D[i][2] * ea[2];
    for (std::size_t b = 0; b <= a; ++b, ++block) {
      Vec3 eb[3];
      strain_slopes(b, eb);
      const double initial =
          B[a].u * (S[0] * B[b].u + S[2] * B[b].v) + B[a].v * (S[2] * B[b].u + S[1] * B[b].v);
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
          (*block)(i, j) +=
              factor * weight * (Da[0][i] * eb[0][j] + Da[1][i] * eb[1][j] + Da[2][i] * eb[2][j]);
        }
        (*block)(i, i) += factor * weight * initial;
      }
    }
  }
}

void FaceStrainPool::evaluate(const StencilRequest& request, const StencilSlots& slots) const {
  const bool function = gives_ == Gives::function, hessian = request.want == Want::hessian;
  for (Index f = request.begin; f < request.end; ++f) {
    const std::size_t n = nodes_[f].size(), first = at(nodes_.offset[at(f)]);
    const double factor = function ? request.function_multiplier[at(f)] : 1;
    Mat3* blocks = hessian ? slots.hessian.data() + hessian_offset()[at(f)] : nullptr;
    if (blocks) std::fill_n(blocks, n * (n + 1) / 2, Mat3{});
    Vec3 slope[6] = {};
    double value = 0;
    for (std::size_t p = 0; p < points(); ++p) {
      const Strain e = strain(f, p, request.x, request.rest);
      const FaceResponse w = respond(e.trace_minus_2(), e.q_minus_1());
      value += frame_[at(f) * points() + p].weight * w.value;
      if (request.want == Want::value || !std::isfinite(w.value)) continue;
      add_point(slots, f, p, e, w, factor, {slope, n}, hessian);
    }
    if (function) {
      // A face without area has no direction in which it grows: outside the domain.
      const bool outside = !std::isfinite(value);
      slots.energy[at(f)] = outside ? std::numeric_limits<double>::infinity() : 0;
      slots.value[at(f)] = outside ? 0 : value;
    } else {
      slots.energy[at(f)] = value;
    }
    if (request.want == Want::value) continue;
    for (std::size_t a = 0; a < n; ++a) {
      if (function) slots.jacobian[first + a] = slope[a];
      slots.gradient[first + a] = factor * slope[a];
    }
    if (blocks && request.definiteness != Definiteness::exact) raise_negative_eigenvalues(n, blocks);
  }
}

std::vector<Index> distinct_faces(std::span<const Index> faces, std::size_t nodes_per_face) {
  std::set<std::vector<Index>> seen;
  std::vector<Index> out;
  for (std::size_t f = 0; f < faces.size(); f += nodes_per_face) {
    const auto nodes = faces.subspan(f, nodes_per_face);
    std::vector<Index> key(nodes.begin(), nodes.end());
    std::sort(key.begin(), key.end());
    if (seen.insert(std::move(key)).second) out.insert(out.end(), nodes.begin(), nodes.end());
  }
  return out;
}

}  // namespace isochor
