// Stencils on faces: the signed volume under a face, and rest areas of faces.
#pragma once

#include <utility>

#include "engine/system/pool.h"

namespace isochor {

// Shape functions of one kind of face at quadrature points.
struct FaceRule {
  int nodes = 0, points = 0;
  std::vector<double> weight;       // points; the reference triangle has area 1/2
  std::vector<double> N, N_u, N_v;  // [q * nodes + a]
  // The same, [q], of an apex that is no node and does not move; empty: none.
  std::vector<double> apex_N, apex_N_u, apex_N_v;
};
const FaceRule& triangle3_rule();
const FaceRule& triangle6_rule();
// A bilinear face, four corners in turn; exact for the volume under it.
const FaceRule& quadrangle4_rule();
// The rule for the faces of a mesh, by their number of nodes.
const FaceRule& face_rule(std::size_t nodes);
// As that, with points enough on a triangle for what varies along it.
const FaceRule& varying_face_rule(std::size_t nodes);
// A flat cap next to a curved edge: nodes (apex, a, b, middle of ab); the edges to the apex are straight.
const FaceRule& cap4_rule();
// What lies between a curved edge (a, b, middle) and its chord.
const FaceRule& bulge3_rule();
// A flat cap from an apex that does not move: nodes (a, b), and (a, b, middle of ab).
const FaceRule& fan2_rule();
const FaceRule& fan3_rule();

// Rest area that falls to each node of a face, integral of N_a dA [m^2]. 3, 4 (a quadrangle) or 6 nodes.
std::vector<std::pair<Index, double>> nodal_areas(std::span<const Index> face, std::span<const Vec3> rest);

// Raises the negative eigenvalues of one face's packed Hessian to zero; at most six nodes.
void raise_negative_eigenvalues(std::size_t nodes, Mat3* block);

// One function a face: V = 1/3 integral (x - origin) . n da [m^3]. Over a closed surface the sum is the
// enclosed volume, whatever the origin; its gradient is the pressure load, its Hessian the (symmetric)
// follower stiffness.
//
// With a weight b the functions sum to the first moment of the enclosed volume instead, the integral of
// b . (x - datum) [b m^4]: over the cone from the origin to a face, that of (b . (origin - datum)) / 3 +
// b . (x - origin) / 4. Its gradient is that of a pressure b . (x - datum) on the surface.
class EnclosedVolumePool final : public StencilPool {
 public:
  EnclosedVolumePool(std::string name, Vec3 origin) : name_(std::move(name)), origin_(origin) {}
  EnclosedVolumePool(std::string name, Vec3 origin, const Vec3& weight, const Vec3& datum)
      : name_(std::move(name)), origin_(origin), weighted_(true), weight_(weight), datum_(datum) {}
  // Node order gives the normal; `rule` is one of those above and must outlive the pool. `apex` is for rules
  // that have one.
  void add_face(std::span<const Index> nodes, const FaceRule& rule, const Vec3& apex = {}) {
    nodes_.push(nodes);
    rule_.push_back(&rule);
    apex_.push_back(apex);
    face_origin_.push_back(origin_);
  }
  // The faces of another surface, measured from its own origin.
  void add_faces(const EnclosedVolumePool& other);
  void finish() { finish_topology(); }

  std::string_view name() const override { return name_; }
  StencilShape shape() const override { return {.functions = 1}; }
  void evaluate(const StencilRequest& request, const StencilSlots& slots) const override;

  double volume(std::span<const Vec3> x) const;
  const Vec3& origin() const { return origin_; }

 private:
  double face_volume(Index face, std::span<const Vec3> x) const;
  // What the triple product of a quadrature point counts, at a position relative to the face's origin.
  double scale(Index face, const Vec3& r) const {
    if (!weighted_) return 1.0 / 3;
    return dot(weight_, face_origin_[at(face)] - datum_) / 3 + dot(weight_, r) / 4;
  }
  std::string name_;
  Vec3 origin_;
  std::vector<const FaceRule*> rule_;
  std::vector<Vec3> apex_, face_origin_;
  bool weighted_ = false;
  Vec3 weight_{}, datum_{};
};

}  // namespace isochor
