// A barrier on single tets for edge-smoothed bodies, whose patches and nodal rows do not see one tet turn
// over.
#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include "engine/elements/material.h"

namespace isochor {

// psi = -stiffness log^3(J / threshold) for J < threshold and exactly zero above: twice continuously
// differentiable, infinite at J = 0. A tet that is inverted or flat when an increment begins would have no
// way out; it has no guard in that increment. Only positions that a host sets are so: no increment ends with
// a guarded tet turned over (Admission), so a tet that loads crush, however much, keeps its guard.
class ElementGuard final : public Material {
 public:
  struct Barrier {
    double stiffness = 0;  // [Pa]; 0: the guard is off
    double threshold = 0;  // J below which it acts
  };
  // One barrier an element.
  explicit ElementGuard(std::vector<Barrier> barriers);
  std::string_view name() const override { return "element_guard"; }
  void describe(Fingerprint& f) const override { f.add(name(), barriers_); }
  double looks_back_below() const override { return largest_threshold_; }
  void evaluate(Want want, const PointBatch& points, ResponseBatch& response) const override;
  void spectrum(const PointBatch& points, const Svd3& svd, Spectrum& out) const override;

 private:
  std::vector<Barrier> barriers_;
  double largest_threshold_ = 0;
};

}  // namespace isochor
