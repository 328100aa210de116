// A viscoelastic branch of a solid, a Maxwell element at finite strain: a spring psi_e in series with a
// dashpot of relaxation time tau, F = F_e F_v (Sidoroff 1974; Reese & Govindjee 1998), beside what the solid
// stores for good. The spring is isotropic, isochoric and quadratic in the logarithmic strain (Hencky), so
// that flow takes place in the frame of F_e and an increment is a closed form (Weber & Anand 1990; Simo
// 1992).
//
// With x = dt/tau, p = x/(e^x - 1) and q = (1 - e^-x)/x, all in (0, 1], one increment is
//
//   flow      the elastic logarithmic strain e_n of its start shrinks to p e_n
//   stretch   the solid deforms, nothing flows: e = log of the stretch of F F_v^-1
//   flow      e shrinks to q e
//
// the recursion of Taylor, Pister & Goudreau (1970): exact for strains that are held and for such that grow
// at a constant rate along fixed axes, second order otherwise, without a bound on dt. Both flows take energy
// away, whatever the increment: dissipation is never negative. The stress at the end is 2 mu q e, the
// derivative of q psi_e(F F_v^-1): an increment has a potential, and its matrices are symmetric.
//
// Memory, for each point: F_v^-1 - 1 (9 numbers, row-major), and the elastic logarithmic strain in the frame
// of the intermediate configuration by its axes (9, row-major, in columns) and its values (3), so that no
// increment has to find them again. Zero is a solid that has rested forever.
#pragma once

#include <array>

#include "engine/elements/solid_pool.h"

namespace isochor {

class RelaxationPool final : public StencilPool, public RememberingStencils {
 public:
  static constexpr int kNumbers = 21;  // of memory, a point

  // `spring`: isotropic, without a volume part. `time`: tau [s] > 0.
  RelaxationPool(std::string name, std::shared_ptr<const SolidData> data,
                 std::shared_ptr<const Material> spring, double time);

  std::string_view name() const override { return name_; }
  StencilShape shape() const override { return {.energy = true}; }
  void evaluate(const StencilRequest& request, const StencilSlots& slots) const override;
  StencilFacets facets() const override { return {.remembering = this}; }

  // First Piola-Kirchhoff stress at a point with the memory of a step that was accepted [Pa], row-major.
  void stress(Index stencil, int point, std::span<const Vec3> x, std::span<const Vec3> rest,
              std::span<const double> memory, double P[9]) const;

  // The same as smooth functions of what happened, without axes that turn where strains come together: F_v^-1
  // (9) and the elastic logarithmic strain as a tensor (9), row-major.
  static constexpr std::size_t kSmooth = 18;
  static void smooth(std::span<const double, kNumbers> memory, std::span<double, kSmooth> out);
  // How an increment changes at a point with its memory, as smooth numbers, and with F.
  struct Rates {
    std::array<double, 9 * kSmooth> stress{};            // of P [Pa] by the memory; F held
    std::array<double, kSmooth*(kSmooth + 9)> memory{};  // of what is kept, by the memory and F
  };
  Rates rates(const StencilRequest& request, Index stencil, int point) const;
  const SolidData& data() const { return *data_; }

  int memory() const override;
  void accept(const StencilRequest& request, std::span<double> memory) const override;

 private:
  struct Point;
  struct Flow;
  struct Batch;
  // visit(points, count) for all points of stencils [begin, end), in batches.
  template <class Visit>
  static void for_batches(Index begin, Index end, int points, const Visit& visit);
  Flow flow(const StencilIncrement& increment) const;
  void stretch(const StencilRequest& request, const Flow& flow, const Point* points, int count,
               Batch& batch) const;
  void respond(const StencilRequest& request, const Point* points, int count, const Batch& batch,
               ResponseBatch& response) const;
  void flush(const StencilRequest& request, const StencilSlots& slots, const Flow& flow, const Point* points,
             int count) const;
  void keep(const StencilRequest& request, const Flow& flow, const Point* points, int count,
            std::span<double> memory) const;

  std::string name_;
  std::shared_ptr<const SolidData> data_;
  SolidPool geometry_;  // of the same stencils: who knows F
  std::shared_ptr<const Material> spring_;
  double time_;
};

}  // namespace isochor
