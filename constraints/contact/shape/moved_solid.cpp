#include "constraints/contact/shape/moved_solid.h"

#include <algorithm>

namespace isochor {

MovedSolid::MovedSolid(SolidPtr base, const Vec3& origin, const Mat3& R)
    : base_(std::move(base)), origin_(origin), R_(R), box_{} {
  const TriangleSurface s = outline();
  box_ = {s.points[0], s.points[0]};
  for (const Vec3& p : s.points) {
    for (int k = 0; k < 3; ++k) {
      box_[0][k] = std::min(box_[0][k], p[k]);
      box_[1][k] = std::max(box_[1][k], p[k]);
    }
  }
}

Distance MovedSolid::distance(const Vec3& z) const {
  const Distance b = base_->distance(to_base(z));
  Distance out{b.value, transposed_times(R_, b.normal), {}};
  for (int j = 0; j < 3; ++j) {
    const Vec3 column = transposed_times(R_, b.curvature * Vec3{R_(0, j), R_(1, j), R_(2, j)});
    for (int i = 0; i < 3; ++i) out.curvature(i, j) = column[i];
  }
  return out;
}

TriangleSurface MovedSolid::outline() const {
  TriangleSurface s = base_->outline();
  for (Vec3& p : s.points) p = transposed_times(R_, p - origin_);
  return s;
}

}  // namespace isochor
