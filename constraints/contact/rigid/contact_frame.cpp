#include "constraints/contact/rigid/contact_frame.h"

namespace isochor {

ContactFrame frame_of(const ObstaclePose& pose) {
  ContactFrame f{pose.position, pose.R, {}};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) f.inverse(i, j) = pose.R(j, i);
  }
  return f;
}

ContactFrame frame_of(const ControlPoints& points, std::span<const Vec3> x) {
  ContactFrame f;
  for (std::size_t a = 0; a < 4; ++a) {
    const Vec3& p = x[at(points.node[a])];
    const Vec3 b = points.slope(a);
    f.c += 0.25 * p;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) f.A(i, j) += p[i] * b[j];
    }
  }
  const auto column = [&](int j) { return Vec3{f.A(0, j), f.A(1, j), f.A(2, j)}; };
  const Vec3 r[3] = {cross(column(1), column(2)), cross(column(2), column(0)), cross(column(0), column(1))};
  const double determinant = dot(column(0), r[0]);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) f.inverse(i, j) = r[i][j] / determinant;
  }
  return f;
}

}  // namespace isochor
