// Stencils on faces that depend on how the face is strained in its own plane: epidermis and membrane.
#pragma once

#include <string>
#include <vector>

#include "constraints/stencil/face_pool.h"

namespace isochor {

// A function W(I, q) of the in-plane strain: I = tr C, q = det C = (area ratio)^2 with C = F^T F of the 3x2
// deformation gradient F of the face. Linear in I.
struct FaceResponse {
  double value = 0;  // per rest area; infinity outside the domain, and the slopes are then zero
  double I = 0, q = 0, qq = 0;
};

// One stencil a face: the integral of W over the rest area, either as energy [J] or as a function for rows.
// Strains are made from displacements, so that all is exactly zero at rest.
class FaceStrainPool : public StencilPool {
 public:
  enum class Gives : std::uint8_t { energy, function };

  // `faces`: nodes_per_face scene nodes each, 3, 4 or 6.
  FaceStrainPool(std::string name, Gives gives, std::size_t nodes_per_face, std::span<const Index> faces,
                 std::span<const Vec3> rest);

  std::string_view name() const override { return name_; }
  StencilShape shape() const override {
    return {.energy = gives_ == Gives::energy, .functions = gives_ == Gives::function ? 1 : 0};
  }
  void evaluate(const StencilRequest& request, const StencilSlots& slots) const override;

  double rest_area(Index face) const;  // [m^2]
  double area(std::span<const Vec3> x, std::span<const Vec3> rest) const;

 protected:
  // From tr C - 2 and det C - 1, which keep their digits at small strain.
  virtual FaceResponse respond(double trace_minus_2, double q_minus_1) const = 0;

  struct Frame {
    Vec3 t1, t2;  // orthonormal, in the plane of the face at rest
    double weight = 0;
  };
  struct Slope {
    double u = 0, v = 0;  // dN/ds along t1 and t2 [1/m]
  };
  struct Strain {
    Vec3 f1, f2;                     // columns of F
    double e11 = 0, e22 = 0, g = 0;  // Green's strain, g = 2 e12
    double trace_minus_2() const { return 2 * (e11 + e22); }
    double q_minus_1() const { return 2 * (e11 + e22) + 4 * e11 * e22 - g * g; }
  };
  Strain strain(Index face, std::size_t point, std::span<const Vec3> x, std::span<const Vec3> rest) const;
  std::size_t points() const { return static_cast<std::size_t>(rule_->points); }
  // `point`: of all faces, face * points() + its number there.
  const Frame& frame(std::size_t point) const { return frame_[point]; }
  const Slope* slopes(std::size_t point, std::size_t nodes) const { return slope_.data() + point * nodes; }

 private:
  void add_point(const StencilSlots& slots, Index face, std::size_t point, const Strain& e,
                 const FaceResponse& w, double factor, std::span<Vec3> slope, bool hessian) const;

  std::string name_;
  Gives gives_;
  const FaceRule* rule_;
  std::vector<Frame> frame_;  // [face * points + point]
  std::vector<Slope> slope_;  // [(face * points + point) * nodes + a]
};

// Faces named by surfaces of a body, each once however often it is named.
std::vector<Index> distinct_faces(std::span<const Index> faces, std::size_t nodes_per_face);

}  // namespace isochor
