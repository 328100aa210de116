// Factors of matrices that are not exactly the one of Newton's method where that has the wrong inertia: the
// ladder of mending (as Waechter & Biegler 2006 correct an inertia, with the shift in units of each node's
// stiffness).
//
//   exact matrix
//   of the first matrix of a solve: that of the given multipliers (pressures) with which the increment began
//   rows with bounds and a singular matrix: a trace of compliance
//   shifts of the displacement block, from a third of the last one that helped, times six
//   projected Hessians of the stencils, and shifts on top, times thirty
//
// What does not work on any rung is singular, and null_space.cpp tells who is to blame.
#pragma once

#include <functional>

#include "engine/solve/evaluator.h"
#include "engine/solve/kkt/kkt.h"

namespace isochor {

class InertiaCorrection {
 public:
  InertiaCorrection(Evaluator& evaluator, Kkt& kkt, StageSeconds& seconds)
      : evaluator_(evaluator), kkt_(kkt), seconds_(seconds) {}

  // Of a solve: nothing of an earlier one is left.
  void begin(Definiteness definiteness);
  // Rows that the matrix holds at a bound from now on; empty: none.
  void hold(std::span<const std::uint8_t> rows) { held_ = rows; }

  // Factors at positions and multipliers, where the last evaluation was, up the ladder until the inertia is
  // right. False: the report has a status of failure, or (converged) the matrix is singular.
  bool factor(const SaddleProblem& p, std::span<const Vec3> x, std::span<const double> multipliers,
              SaddleReport& report);
  // The same from the shifts on, until the factors also serve `works`: for directions that do not descend or
  // were not found.
  template <class Works>
  bool factor_until(const SaddleProblem& p, std::span<const Vec3> x, std::span<const double> multipliers,
                    SaddleReport& report, Works&& works) {
    // By reference, so that the function allocates nothing.
    if (climb(p, x, multipliers, report, std::ref(works))) return true;
    if (!gave_up(report) && report.message.empty())
      report.message = "the linear solver found no direction of descent";
    return false;
  }
  // One matrix, mended by nothing but what is there already. True when its inertia is right or unknown.
  bool factor_exact(SaddleReport& report) {
    mended_ = false;
    return factor_shifted(0, report);
  }
  // The unsymmetric matrix, with a trace of compliance where that helps.
  bool factor_unsymmetric(const UnsymmetricPart& part, SaddleReport& report);

  bool mended() const { return mended_; }      // the last factors are not those of the exact matrix
  bool singular() const { return singular_; }  // the last matrix was
  Definiteness definiteness() const { return definiteness_; }  // of the stencils' Hessians in this solve
  void set_interrupt(std::function<bool()> asked) { interrupt_ = std::move(asked); }

 private:
  bool factor_where_it_began(const SaddleProblem& p, std::span<const Vec3> x,
                             std::span<const double> multipliers, SaddleReport& report);
  bool climb(const SaddleProblem& p, std::span<const Vec3> x, std::span<const double> multipliers,
             SaddleReport& report, const std::function<bool()>& works);
  bool factor_shifted(double shift, SaddleReport& report);
  Kkt::Values values(double shift) const;
  bool add_trace(SaddleReport& report);
  bool gave_up(SaddleReport& report) const;
  bool found_singular(SaddleReport& report);
  // null_space.cpp
  void explain_singular(SaddleReport& report);
  void name_rows(std::span<const double> null, SaddleReport& report) const;
  void name_nodes(std::span<const double> null, SaddleReport& report) const;

  Evaluator& evaluator_;
  Kkt& kkt_;
  StageSeconds& seconds_;
  std::function<bool()> interrupt_;
  std::span<const std::uint8_t> held_;
  Definiteness definiteness_ = Definiteness::exact;
  bool mended_ = false, singular_ = false;
  bool first_ = true;  // no matrix has been factored in this solve
  double trace_ = 0;   // of compliance in the matrix, where rows repeat each other
  double shift_ = 0;   // the last one that mended the inertia in this solve
};

}  // namespace isochor
