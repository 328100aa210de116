// What a rigid shape of any kind offers to contacts.
#pragma once

#include <span>

#include "engine/base/fingerprint.h"
#include "isochor/solids.h"

namespace isochor {

// Distance to a surface, negative inside, with its first and second derivatives in space.
struct Distance {
  double value = 0;  // [m]
  Vec3 normal{};     // the direction in which it grows; a unit vector, of a field nearly
  Mat3 curvature;    // [1/m]
};

class Solid {
 public:
  virtual ~Solid() = default;
  virtual Distance distance(const Vec3& y) const = 0;
  virtual double value(const Vec3& y) const = 0;
  // Where the straight way from y0 to y1 meets the surface, as fractions of the way, ascending; as many as
  // `out` holds at most. Returns how many.
  virtual std::size_t crossings(const Vec3& y0, const Vec3& y1, std::span<double> out) const = 0;
  // Lower and upper corner of a box around the surface.
  virtual std::array<Vec3, 2> box() const = 0;
  // The surface in triangles, for volumes, points that touch, and pictures.
  virtual TriangleSurface outline() const = 0;
  // What it was made from.
  virtual void describe(Fingerprint& f) const = 0;
};

// Passing through, as passes_through() of obstacle_shape.h has it; the thickness is that of the solid where
// the way enters it.
bool passes_through_solid(const Solid& solid, const Vec3& y0, const Vec3& y1, Vec3& met);

}  // namespace isochor
