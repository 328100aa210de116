// Friction of one point of contact over one increment. In turn:
//   1. the pull that the last step left turns with the surface (FrictionMemory, the geometry's axes);
//   2. the lag tells the normal, the limit mu N and how nodes move the point over what it touches (Touch);
//   3. the slip since the increment began, with that pull over the stiffness of sticking, stretches a spring
//      across the normal (FrictionSpring), which sticks or slips;
//   4. its energy and slopes are those of friction, and its derivatives in the lag those of coupled systems.
// The geometry is that of a rigid shape, of a patch of triangles, or of two edges; see FrictionalPool.
#pragma once

#include "constraints/contact/friction/friction_law.h"

namespace isochor {

// Where a point touches, held within an iteration. `Nodes`: most nodes of a stencil.
template <std::size_t Nodes>
struct Touch {
  static constexpr std::size_t kNodes = Nodes;
  Vec3 normal{};                       // unit
  double share = 1;                    // of the multiplier, that presses there [-]; 0: nothing touches
  std::array<double, Nodes> weight{};  // of nodes in the motion of the point over what it touches
  Vec3 carried{};  // how far a shape that is moved as told goes there within the increment [m]
};

// Rates of these as one coordinate of one node moves.
template <std::size_t Nodes>
struct TouchRate {
  Vec3 normal{};
  double share = 0;
  std::array<double, Nodes> weight{};
  Vec3 whole{};  // of FrictionPoint::whole
};

template <class TouchAt>
struct FrictionPoint {
  FrictionSpring spring;
  TouchAt touch;
  double mu = 0;  // coefficient of this step [-]
  Vec3 whole{};   // what stretches the spring, before it is taken across the normal [m]

  // Without an increment nothing slips, and what is left is the pull that the last step ended with.
  void keep(const Vec3& pull) {
    spring.limit = std::sqrt(dot(pull, pull));
    spring.z = (1 / spring.stiffness) * pull;
  }
  void slide(double pressing, const Vec3& stretch) {
    spring.limit = mu * touch.share * pressing;
    spring.normal = touch.normal;
    whole = stretch;
    spring.z = stretch - dot(stretch, touch.normal) * touch.normal;
  }
  bool rubs() const { return spring.limit > 0; }

  // Adds its part to the packed Hessian blocks of a stencil of n nodes.
  void add_curvature(std::size_t n, Mat3* blocks) const {
    const Mat3 plane = spring.curvature();
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        for (std::size_t e = 0; e < 9; ++e)
          blocks[i * (i + 1) / 2 + j].m[e] += touch.weight[i] * touch.weight[j] * plane.m[e];
      }
    }
  }
  // Slope of the pull in the multiplier, through the limit. Of a point that rubs, as the next.
  Vec3 pull_by_multiplier() const { return -mu * touch.share * spring.pull_by_limit(); }
  template <class Rate>
  Vec3 pull_rate(const Rate& rate) const {
    return spring.pull_rate(whole, rate.whole, rate.normal) +
           (spring.limit / touch.share * rate.share) * spring.pull_by_limit();
  }
};

}  // namespace isochor
