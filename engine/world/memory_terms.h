// How what materials remember goes on over an increment, and what it changes of forces: exact derivatives,
// and their transposes. Of viscoelastic solids, whose memory is told by smooth numbers
// (RelaxationPool::smooth()).
#pragma once

#include "engine/elements/relaxation_pool.h"
#include "engine/system/assembly.h"

namespace isochor {

class MemoryTerms {
 public:
  // Over an increment that ends at x and begins with the memory of all pools.
  MemoryTerms(const System& system, const Assembly& assembly, const StencilIncrement& increment,
              std::span<const Vec3> x, std::span<const double> memory);

  // Whether all that materials of the scene remember is followed.
  static bool follows(const System& system);
  static std::size_t numbers(const System& system);
  // What is kept at the end of the increment that the assembly was evaluated for.
  static std::vector<double> kept(const System& system, const Assembly& assembly, std::span<const Vec3> x,
                                  std::span<const double> memory);

  // force += factor dR/dm m; and m += factor (dR/dm)^T way.
  void add_force(double factor, std::span<const double> m, std::span<Vec3> force) const;
  void add_force_back(double factor, std::span<const Vec3> way, std::span<double> m) const;
  // What is kept changes by, along a change of the memory and of positions.
  std::vector<double> onward(std::span<const double> m, std::span<const Vec3> dx) const;
  // The transpose: x += what positions feel; returns what the memory feels.
  std::vector<double> back(std::span<const double> felt, std::span<Vec3> x) const;

 private:
  static constexpr std::size_t kIn = RelaxationPool::kSmooth + 9;
  struct Point {
    const RelaxationPool::Rates& rates;
    double weight;  // [m^3]
    std::span<const Index> nodes;
    const Vec3* gradient;  // of the shape functions
    std::size_t first;     // of its numbers
  };
  template <class Visit>
  void each_point(Visit&& visit) const;

  const System& system_;
  std::vector<RelaxationPool::Rates> rates_;
};

}  // namespace isochor
