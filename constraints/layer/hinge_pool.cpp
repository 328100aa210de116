#include "constraints/layer/hinge_pool.h"

#include <algorithm>
#include <cmath>

#include "constraints/stencil/face_pool.h"

namespace isochor {

namespace {

using Corners = std::array<Vec3, 4>;

// What one face adds: the rotation about the edge from a to b that its corner c gives it. With e = b - a, p =
// c - a and n = e x p the slope by c is g = |e| n / |n|^2; the ends of the edge take what leaves translations
// and turns of the edge in the plane out, -(1 - s) g and -s g with s = e . p / |e|^2.
struct Wing {
  Vec3 e, p, n, g;
  double ee = 0, nn = 0, s = 0;

  // `side`: +1 or -1, whichever makes n the normal that both faces share.
  Wing(const Vec3& a, const Vec3& b, const Vec3& c, double side) : e(b - a), p(c - a) {
    n = side * cross(e, p);
    ee = dot(e, e);
    nn = dot(n, n);
    s = dot(e, p) / ee;
    g = (std::sqrt(ee) / nn) * n;
  }
};

// The same instructions at rest and later, so that the difference at rest is exactly zero: inlined in two
// places products may be fused in one and not in the other. NaN where a face or the edge has no size.
[[gnu::noinline]] double angle(const Corners& x) {
  const Wing first(x[0], x[1], x[2], 1), second(x[0], x[1], x[3], -1);
  if (!(first.ee > 0) || !finite(first.g) || !finite(second.g)) return std::nan("");
  const Vec3 turn = cross(second.n, first.n);
  return std::atan2(dot(turn, first.e) / std::sqrt(first.ee), dot(first.n, second.n));
}

// Second derivatives of the angle as blocks of corners (0, 1, 2, 3); `own` is the place of the wing's corner.
void add_curvature(const Wing& w, double side, std::size_t own, std::array<std::array<Mat3, 4>, 4>& out) {
  const double length = std::sqrt(w.ee);
  // dg = by_n dn + n (e . de) / (|e| |n|^2), with dn = side (de x p + e x dp).
  Mat3 by_n, by_e, by_p;
  for (int i = 0; i < 3; ++i) by_n(i, i) = length / w.nn;
  add_outer(by_n, -2 * length / (w.nn * w.nn), w.n, w.n);
  Mat3 with_e, with_p;  // of crosses: x -> e x x, and x -> x x p
  add_cross(with_e, side, w.e);
  add_cross(with_p, -side, w.p);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < 3; ++k) {
        by_e(i, j) += by_n(i, k) * with_p(k, j);
        by_p(i, j) += by_n(i, k) * with_e(k, j);
      }
    }
  }
  add_outer(by_e, 1 / (length * w.nn), w.n, w.e);
  // s = e . p / |e|^2.
  const Vec3 s_by_e = (1 / w.ee) * (w.p - 2 * w.s * w.e), s_by_p = (1 / w.ee) * w.e;
  const std::array<std::size_t, 3> place{0, 1, own};
  const double e_of[3] = {-1, 1, 0}, p_of[3] = {-1, 0, 1};  // how e and p follow the corners
  const double share[3] = {-(1 - w.s), -w.s, 1}, by_s[3] = {1, -1, 0};
  for (std::size_t b = 0; b < 3; ++b) {
    const Vec3 s_by_b = e_of[b] * s_by_e + p_of[b] * s_by_p;
    for (std::size_t a = 0; a < 3; ++a) {
      Mat3& block = out[place[a]][place[b]];
      for (std::size_t i = 0; i < 9; ++i)
        block.m[i] += share[a] * (e_of[b] * by_e.m[i] + p_of[b] * by_p.m[i]);
      add_outer(block, by_s[a], w.g, s_by_b);
    }
  }
}

}  // namespace

void HingePool::add(std::array<Index, 4> nodes, std::span<const Vec3> rest, double natural) {
  nodes_.push(nodes);
  ahead_.emplace_back();
  const Index edge = nodes_.count() - 1;
  const Corners x = corners(edge, rest);
  length_.push_back(norm(x[1] - x[0]));
  natural_.push_back(std::isnan(natural) ? angle(x) : natural);
}

void HingePool::add_clamped(std::array<Index, 3> nodes, std::span<const Vec3> rest) {
  nodes_.push(nodes);
  clamped_ = true;
  const Vec3 &a = rest[at(nodes[0])], &b = rest[at(nodes[1])], e = b - a, p = rest[at(nodes[2])] - a;
  // As far out as the corner is inside: no face is thinner than the other.
  ahead_.push_back((dot(e, p) / dot(e, e)) * e - p);
  length_.push_back(norm(e));
  const Corners x = corners(nodes_.count() - 1, rest);
  natural_.push_back(angle(x));
}

std::array<Vec3, 4> HingePool::corners(Index edge, std::span<const Vec3> x) const {
  const auto n = nodes_[edge];
  const Vec3 &a = x[at(n[0])], &b = x[at(n[1])];
  return {a, b, x[at(n[2])], n.size() == 4 ? x[at(n[3])] : 0.5 * (a + b) + ahead_[at(edge)]};
}

double HingePool::turned(Index edge, std::span<const Vec3> x) const {
  return length_[at(edge)] * (angle(corners(edge, x)) - natural_[at(edge)]);
}

// moment phi'' + H phi' phi'^T, `slope` the phi'.
void HingePool::write_hessian(Index s, const std::array<Vec3, 4>& x, std::span<const Vec3> slope,
                              double moment, Mat3* block) const {
  const std::size_t n = nodes_[s].size();
  std::array<std::array<Mat3, 4>, 4> curve{};
  add_curvature(Wing(x[0], x[1], x[2], 1), 1, 2, curve);
  add_curvature(Wing(x[0], x[1], x[3], -1), -1, 3, curve);
  if (is_clamped(s)) {
    const auto add_half = [](const Mat3& from, Mat3& to) {
      for (std::size_t i = 0; i < 9; ++i) to.m[i] += 0.5 * from.m[i];
    };
    for (std::size_t end = 0; end < 2; ++end) {
      for (std::size_t b = 0; b < 4; ++b) add_half(curve[3][b], curve[end][b]);
    }
    for (std::size_t end = 0; end < 2; ++end) {
      for (std::size_t a = 0; a < 3; ++a) add_half(curve[a][3], curve[a][end]);
    }
  }
  const double k = moment * length_[at(s)];
  for (std::size_t a = 0; a < n; ++a) {
    for (std::size_t b = 0; b <= a; ++b, ++block) {
      for (int i = 0; i < 3; ++i) {
        // The two faces are symmetric together; rounding is not.
        for (int j = 0; j < 3; ++j) (*block)(i, j) = 0.5 * k * (curve[a][b](i, j) + curve[b][a](j, i));
      }
      add_outer(*block, stiffness_[at(s)], slope[a], slope[b]);
    }
  }
}

void HingePool::evaluate(const StencilRequest& request, const StencilSlots& slots) const {
  for (Index s = request.begin; s < request.end; ++s) {
    const std::size_t n = nodes_[s].size(), first = at(nodes_.offset[at(s)]);
    const Corners x = corners(s, request.x);
    // A face without area has no normal: outside the domain.
    const double theta = angle(x);
    const bool inside = std::isfinite(theta);
    const double phi = inside ? length_[at(s)] * (theta - natural_[at(s)]) : 0;
    slots.value[at(s)] = phi;
    slots.energy[at(s)] =
        inside ? 0.5 * stiffness_[at(s)] * phi * phi : std::numeric_limits<double>::infinity();
    if (request.want == Want::value) continue;
    std::array<Vec3, 4> slope{};
    if (inside) {
      const Wing one(x[0], x[1], x[2], 1), other(x[0], x[1], x[3], -1);
      const Vec3 g = length_[at(s)] * one.g, h = length_[at(s)] * other.g;
      slope = {-((1 - one.s) * g) - (1 - other.s) * h, -(one.s * g) - other.s * h, g, h};
    }
    // The direction that a clamped face is held against rides on the middle of the edge.
    for (std::size_t end = 0; end < 2 && is_clamped(s); ++end) slope[end] += 0.5 * slope[3];
    const double moment = stiffness_[at(s)] * phi + request.function_multiplier[at(s)];
    for (std::size_t a = 0; a < n; ++a) {
      slots.jacobian[first + a] = slope[a];
      slots.gradient[first + a] = moment * slope[a];
    }
    if (request.want != Want::hessian) continue;
    Mat3* block = slots.hessian.data() + hessian_offset()[at(s)];
    std::fill_n(block, n * (n + 1) / 2, Mat3{});
    if (!inside) continue;
    write_hessian(s, x, slope, moment, block);
    if (request.definiteness != Definiteness::exact) raise_negative_eigenvalues(n, block);
  }
}

}  // namespace isochor
