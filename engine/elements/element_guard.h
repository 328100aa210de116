// A barrier on single tets for edge-smoothed bodies, whose patches and nodal rows do not see one tet turn
// over.
#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include "engine/material.h"

namespace isochor {

// psi = -stiffness log^3(J / threshold) for J < threshold and exactly zero above: twice continuously
// differentiable, infinite at J = 0. A tet that is as good as inverted when an increment begins (J below a
// fiftieth of the threshold) would have no way out; it has no guard in that increment.
class ElementGuard final : public Material {
 public:
  // One stiffness [Pa] an element; 0 where the guard is off.
  ElementGuard(std::vector<double> stiffness, double threshold)
      : b_(std::move(stiffness)), threshold_(threshold) {}
  std::string_view name() const override { return "element_guard"; }
  double looks_back_below() const override { return threshold_; }
  void evaluate(Want want, const PointBatch& points, ResponseBatch& response) const override;
  void spectrum(const PointBatch& points, const Svd3& svd, Spectrum& out) const override;

 private:
  std::vector<double> b_;
  double threshold_;
};

}  // namespace isochor
