// A membrane that is stretched where the body is at rest, or has fibers.
#pragma once

#include <memory>

#include "constraints/layer/membrane_pool.h"
#include "engine/elements/fiber_law.h"
#include "engine/scene/builder.h"
#include "isochor/effects/layer.h"

namespace isochor {

// What a membrane is, with what it may have beside.
struct Sheet {
  double mu = 0;  // [Pa]
  double poisson = 0.5, thickness = 0;
  Prestretch prestretch;
  std::shared_ptr<const Amount> amount;  // of the prestretch
  // Their directions are one, or one a face.
  std::vector<FiberFamily> fibers;

  bool prestretched() const { return prestretch.along != 1 || prestretch.across != 1; }
};

// Prestretch and fibers, checked; the error is the end of a sentence about the sheet.
Result<void> check_sheet(const Prestretch& prestretch, const Curve& amount,
                         const std::vector<FiberFamily>& fibers);

// The sheet without stress comes to the body at rest by U = 1 + amount (prestretch - 1), so that its strain
// is that of C_e = U C U; its energy per rest area of the body is W(C_e)/det U. Fibers with the direction a
// on the body at rest have the squared stretch a . C a / |U^-1 a|^2.
class SheetPool final : public MembranePool {
 public:
  SheetPool(const std::string& name, std::size_t nodes_per_face, std::span<const Index> faces,
            std::span<const Vec3> rest, const Sheet& sheet);

  void evaluate(const StencilRequest& request, const StencilSlots& slots) const override;

  // As far as a face has one direction of prestretch or fibers: empty, or the name of what has none there.
  std::string undirected() const { return undirected_; }

 protected:
  PlaneResponse plane(std::size_t point, const PlaneStrain& e, double t, bool hessian) const override;
  std::array<double, 3> prestretch_at(std::size_t point, double t) const override;

 private:
  // Unit vectors of a point of a face, in its frame.
  using InPlane = std::array<double, 2>;
  InPlane in_plane(std::size_t point, const Vec3& direction, const std::string& of);
  void add_point(const StencilSlots& slots, Index face, std::size_t point, const PlaneStrain& e,
                 const PlaneResponse& w, std::span<Vec3> slope, bool hessian) const;
  void add_fibers(std::size_t point, const PlaneStrain& e, const std::array<double, 3>& U, double thickness,
                  bool hessian, PlaneResponse& r) const;

  Sheet sheet_;
  std::vector<InPlane> stretched_;            // by point; empty: no prestretch
  std::vector<std::vector<InPlane>> fibers_;  // by family and point
  std::string undirected_;
};

// The one that a sheet needs.
std::shared_ptr<const MembranePool> make_sheet(const std::string& name, std::size_t nodes_per_face,
                                               std::span<const Index> faces, std::span<const Vec3> rest,
                                               const Sheet& sheet, std::string& undirected);

}  // namespace isochor
