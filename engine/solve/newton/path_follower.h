// Equilibria along a path of load and deformation, through limit points: the load factor becomes an unknown
// and the length of the step along the path the equation that goes with it (Riks 1979; Crisfield 1981 in the
// form with a plane, solved by bordering with two right-hand sides).
#pragma once

#include "engine/solve/newton/newton.h"

namespace isochor {

// A direction or a step along the path.
struct PathVector {
  std::vector<Vec3> x;
  std::vector<double> lambda;
  double t = 0;
};

class PathFollower : public Newton {
 public:
  PathFollower(std::shared_ptr<const System> system, const Parallel& parallel,
               std::unique_ptr<LinearSolver> solver);

  // The problem at a load factor; its spans hold until the next call.
  using ProblemAt = std::function<SaddleProblem(double t)>;

  // One step of `length` = sqrt(mean |dx|^2 + (load_weight dt)^2) from the equilibrium (x, lambda, t), into
  // the direction that continues `secant` (the last step: 3 numbers a node, then dt; all zero: upwards). No
  // inertia is mended: an unstable equilibrium is one too, and the report's negative pivots tell. On success
  // x, lambda and t are the new equilibrium and `secant` the step taken; on failure they are left alone.
  SaddleReport follow(const ProblemAt& problem_at, double length, double load_weight,
                      const SaddleOptions& options, std::span<Vec3> x, std::span<double> lambda, double& t,
                      std::span<double> secant);

 private:
  double product(const PathVector& a, const PathVector& b) const;
  bool factor_here(const ProblemAt& problem_at, double t, SaddleReport& report);
  bool slope(const ProblemAt& problem_at, double t, double step, SaddleReport& report);
  bool find_tangent(const ProblemAt& problem_at, double t, std::span<const double> secant,
                    SaddleReport& report);
  bool correct_across(const ProblemAt& problem_at, double step, double& t, SaddleReport& report);
  void move(double part, const PathVector& v, double& t);
  static double forward(std::span<const double> secant) { return secant.back() < 0 ? -1 : 1; }

  // For derivatives of the loads, which are piecewise linear in t.
  static constexpr double load_difference = 1e-3;
  double load_weight_ = 0;
  PathVector correction_, slope_, tangent_;
};

}  // namespace isochor
