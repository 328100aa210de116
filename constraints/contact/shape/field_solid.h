// The solid where a field of distances on a grid is negative: cubic splines through the values.
#pragma once

#include "constraints/contact/shape/solid.h"

namespace isochor {

// A tensor product of cubic splines, second derivatives zero across the border of the grid: twice
// continuously differentiable. Beyond the grid the distance is sqrt(s^2 + b^2), with s at the nearest point
// of the grid and b the way to it, which is never more than the true one.
class FieldSolid final : public Solid {
 public:
  static Result<std::shared_ptr<const FieldSolid>> make(const DistanceGrid& grid);

  Distance distance(const Vec3& y) const override;
  double value(const Vec3& y) const override;
  std::size_t crossings(const Vec3& y0, const Vec3& y1, std::span<double> out) const override;
  std::array<Vec3, 2> box() const override { return {low_, high_}; }
  TriangleSurface outline() const override;
  void describe(Fingerprint& f) const override { f.add(grid_); }

 private:
  void fit();
  // The spline and, where asked for, its derivatives at a point of the grid's box.
  Distance spline(const Vec3& y, bool derivatives) const;
  // Median of the mean slopes of the cells that the surface passes through.
  double slope_at_surface() const;
  Vec3 last() const;  // the corner of the grid opposite to its origin
  double sample(Index i, Index j, Index k) const {
    return grid_.values[at(i) + at(grid_.count[0]) * (at(j) + at(grid_.count[1]) * at(k))];
  }

  DistanceGrid grid_;
  std::array<std::size_t, 3> size_{};  // of coefficients: one more than points on either side
  std::vector<double> coefficient_;
  Vec3 low_{}, high_{};
};

}  // namespace isochor
