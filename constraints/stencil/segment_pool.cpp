#include "constraints/stencil/segment_pool.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace isochor {

Result<void> SegmentPool::push(const PointInBody& between, const Vec3& offset, std::span<const Vec3> rest) {
  nodes_.push(between.nodes);
  coefficient_.insert(coefficient_.end(), between.weight.begin(), between.weight.end());
  offset_.push_back(offset);
  const Vec3 d = chord(nodes_.count() - 1, rest);
  const double length = std::sqrt(dot(d, d));
  if (!(length > 0) || between.nodes.empty())
    return Error{"two neighboring points coincide; move them apart"};
  rest_length_.push_back(length);
  return {};
}

Result<void> SegmentPool::add(const PointInBody& first, const PointInBody& second,
                              std::span<const Vec3> rest) {
  return push(difference(first, second), {}, rest);
}

Result<void> SegmentPool::add_anchor(const PointInBody& point, const Vec3& place,
                                     std::span<const Vec3> rest) {
  return push(point, -place, rest);
}

Vec3 SegmentPool::chord(Index segment, std::span<const Vec3> x) const {
  const auto nodes = nodes_[segment];
  const std::size_t first = at(nodes_.offset[at(segment)]);
  Vec3 d = offset_[at(segment)];
  for (std::size_t a = 0; a < nodes.size(); ++a) d += coefficient_[first + a] * x[at(nodes[a])];
  return d;
}

double SegmentPool::rest_length() const {
  double sum = 0;
  for (const double l : rest_length_) sum += l;
  return sum;
}

double SegmentPool::length(Index segment, std::span<const Vec3> x) const {
  const Vec3 d = chord(segment, x);
  return std::sqrt(dot(d, d));
}

double SegmentPool::length(std::span<const Vec3> x) const {
  double sum = 0;
  for (Index s = 0; s < stencils(); ++s) sum += length(s, x);
  return sum;
}

void SegmentPool::evaluate(const StencilRequest& q, const StencilSlots& slots) const {
  for (Index s = q.begin; s < q.end; ++s) {
    const std::size_t n = nodes_[s].size(), first = at(nodes_.offset[at(s)]);
    const Vec3 d = chord(s, q.x);
    const double length = std::sqrt(dot(d, d));
    // Ends in one place have no direction: outside the domain, the line search stays away.
    slots.energy[at(s)] = length > 0 ? 0 : std::numeric_limits<double>::infinity();
    slots.value[at(s)] = length - rest_length_[at(s)];
    if (q.want == Want::value) continue;
    const Vec3 u = length > 0 ? (1 / length) * d : Vec3{};
    const double tension = q.function_multiplier[at(s)];
    for (std::size_t a = 0; a < n; ++a) {
      slots.jacobian[first + a] = coefficient_[first + a] * u;
      slots.gradient[first + a] = tension * slots.jacobian[first + a];
    }
    if (q.want != Want::hessian) continue;
    double k = length > 0 ? tension / length : 0;
    if (q.definiteness != Definiteness::exact) k = std::max(k, 0.0);
    Mat3* block = slots.hessian.data() + hessian_offset()[at(s)];
    for (std::size_t a = 0; a < n; ++a) {
      for (std::size_t b = 0; b <= a; ++b, ++block) {
        const double c = k * coefficient_[first + a] * coefficient_[first + b];
        for (int i = 0; i < 3; ++i) {
          for (int j = 0; j < 3; ++j) (*block)(i, j) = c * ((i == j ? 1.0 : 0.0) - u[i] * u[j]);
        }
      }
    }
  }
}

}  // namespace isochor
