// Stencils on the edges between triangles: how far the faces there have turned against each other.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "engine/system/pool.h"

namespace isochor {

// One function an edge, phi = L (theta - theta_0) [m] with the rest length L and the angle theta between the
// normals of its two faces; beside it an energy H phi^2 / 2.
//
// At the rim a face is held against a direction in space instead, which leaves the middle of the edge.
class HingePool final : public StencilPool {
 public:
  explicit HingePool(std::string name) : name_(std::move(name)) {}
  // Edge, then the corners across it of the face that runs along it and of the one that runs against it:
  // angles are positive where the faces fold toward their upper side. `natural`: theta_0 [rad], NaN: as at
  // rest.
  void add(std::array<Index, 4> nodes, std::span<const Vec3> rest,
           double natural = std::numeric_limits<double>::quiet_NaN());
  // Edge and the corner across, of a face that runs along it; the face keeps the direction in its plane that
  // is across the edge at rest.
  void add_clamped(std::array<Index, 3> nodes, std::span<const Vec3> rest);
  void set_stiffness(std::vector<double> stiffness) { stiffness_ = std::move(stiffness); }  // H [J/m^2]
  void finish() { finish_topology(); }

  std::string_view name() const override { return name_; }
  StencilShape shape() const override { return {.energy = true, .functions = 1}; }
  bool sees_rigid_motion() const override { return clamped_; }
  void evaluate(const StencilRequest& request, const StencilSlots& slots) const override;

  double rest_length(Index edge) const { return length_[at(edge)]; }
  bool is_clamped(Index edge) const { return nodes_[edge].size() == 3; }
  double stiffness(Index edge) const { return stiffness_[at(edge)]; }
  double turned(Index edge, std::span<const Vec3> x) const;  // phi [m]; NaN where a face has no size

 private:
  std::array<Vec3, 4> corners(Index edge, std::span<const Vec3> x) const;
  void write_hessian(Index edge, const std::array<Vec3, 4>& x, std::span<const Vec3> slope, double moment,
                     Mat3* block) const;

  std::string name_;
  bool clamped_ = false;
  std::vector<double> length_, natural_, stiffness_;
  std::vector<Vec3> ahead_;  // of clamped edges: from the middle of the edge
};

}  // namespace isochor
