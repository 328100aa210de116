// A solid seen from other axes.
#pragma once

#include "constraints/contact/shape/solid.h"

namespace isochor {

// Its own coordinates z are base coordinates y = origin + R z.
class MovedSolid final : public Solid {
 public:
  MovedSolid(SolidPtr base, const Vec3& origin, const Mat3& R);

  Distance distance(const Vec3& z) const override;
  double value(const Vec3& z) const override { return base_->value(to_base(z)); }
  std::size_t crossings(const Vec3& z0, const Vec3& z1, std::span<double> out) const override {
    return base_->crossings(to_base(z0), to_base(z1), out);
  }
  std::array<Vec3, 2> box() const override { return box_; }
  TriangleSurface outline() const override;
  void describe(Fingerprint& f) const override { f.add(base_, origin_, R_); }

 private:
  Vec3 to_base(const Vec3& z) const { return origin_ + R_ * z; }
  SolidPtr base_;
  Vec3 origin_;
  Mat3 R_;
  std::array<Vec3, 2> box_;
};

}  // namespace isochor
