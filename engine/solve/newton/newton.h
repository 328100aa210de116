// Newton's method on the saddle point, globalized by a merit function (merit.h).
//
//   evaluate, with Hessians               Evaluator
//   hold rows at their bounds             hold_rows (direction.cpp)
//   factor, mend the inertia              InertiaCorrection
//   direction                             direction (direction.cpp)
//   search along it                       search (search.cpp), steps that go on uphill: Watchdog
//   close to the solution: corrections    correct (correct.cpp), on the factors at hand
#pragma once

#include <array>
#include <optional>

#include "engine/solve/newton/merit.h"
#include "engine/solve/saddle_point.h"
#include "engine/solve/watchdog.h"

namespace isochor {

class Newton : public SaddlePoint {
 public:
  Newton(std::shared_ptr<const System> system, const Parallel& parallel,
         std::unique_ptr<LinearSolver> solver);

  bool linearize(const SaddleProblem& p, std::span<const Vec3> x, std::span<const double> lambda,
                 SaddleReport& report) override;
  bool respond(const SaddleProblem& p, std::span<Vec3> dx, std::span<double> lambda,
               SaddleReport& report) override;

 protected:
  // linear_response.cpp
  bool factor_as_is(const SaddleProblem& p, SaddleReport& report);
  bool step_as_is(const SaddleProblem& p, SaddleReport& report);
  SaddleReport solve_from_here(const SaddleProblem& problem, const SaddleOptions& options) override;

  void begin_search();  // of a solve
  // Evaluates now_ with a new lag and Hessians.
  void evaluate_here(const SaddleProblem& p);
  enum class Rows : std::uint8_t { first, later };  // of the iterations of a solve
  void hold_rows(Rows when);
  bool direction(SaddleReport& report);
  bool descends(const SaddleProblem& p);
  bool mend_direction(const SaddleProblem& p, SaddleReport& report);
  double longest_step(double tau);
  bool search(const SaddleProblem& p, SaddleReport& report);
  bool search_exactly(const SaddleProblem& p, SaddleReport& report);
  void set_trial(double tau);
  void try_coupled(const SaddleProblem& p, double tau, SaddleReport& report);
  bool correct(const SaddleProblem& p, const SaddleOptions& options, SaddleReport& report);
  bool correct_coupled(const SaddleProblem& p, const SaddleOptions& options, SaddleReport& report);
  static bool close_enough(const SaddleReport& report);
  bool left_all_bounds() const;

  Direction step_;
  HeldRows held_;
  bool full_step_ = false;
  std::optional<UnsymmetricPart> part_;  // of systems with a lag whose derivatives are known
  // Who solves for a direction: the factors of the matrix at hand, which may be unsymmetric; or steps on
  // symmetric factors, of a matrix next to the one wanted (Kkt::solve_coupled).
  enum class Coupling : std::uint8_t { none, factored, added };
  Coupling coupling_ = Coupling::none;
  double coupled_tolerance_ = 0;                        // of Coupling::added
  static constexpr double correction_tolerance = 1e-2;  // of the linear systems of corrections
  // Of the linear systems of directions, which need not be more exact than what is linear about the problem;
  // 0: as exact as they can be.
  double inexact_ = 0;
  static constexpr double inexact_direction = 1e-2, inexact_correction = 1e-1;

 private:
  struct LineSearch;
  bool find_direction(const SaddleProblem& p, bool unmended, SaddleReport& report);
  bool descend_unmended(const SaddleProblem& p, SaddleReport& report);
  void add_gap();
  void add_held();
  double try_step(const SaddleProblem& p, double tau, SaddleReport& report);
  void take_trial(const SaddleProblem& p);
  bool backtrack(const SaddleProblem& p, LineSearch& line, SaddleReport& report);
  bool try_uphill(const SaddleProblem& p, LineSearch& line, SaddleReport& report);
  void polish(const SaddleProblem& p, LineSearch& line, SaddleReport& report);
  bool may_go_uphill() const;
  bool watch(const SaddleProblem& p, SaddleReport& report);
  bool correct_lagged(const SaddleProblem& p, const SaddleOptions& options, SaddleReport& report);
  bool correct_plain(const SaddleProblem& p, const SaddleOptions& options, SaddleReport& report);
  void rest_gap(const SaddleReport& report);
  bool out_of_patience(const SaddleOptions& options, int iteration, int factorizations) const;
  void damp_cycles(const SaddleReport& report);

  Merit merit_;
  Watchdog watchdog_;
  // Where the watchdog's step began, its direction and penalty.
  struct {
    std::vector<Vec3> x;
    std::vector<double> lambda;
    Direction step;
    double gamma = 0;
  } uphill_;
  // How the steps of this solve went.
  struct {
    std::array<double, 5> past_residuals{};  // of forces, the latest first
    double cycle = 0;                        // one that came back; 0: none did
    double damping = 1;                      // longest step that may be taken since
    bool resting = false;                    // prescribed motion waits for the body to follow
    int creeping = 0;                        // steps in a row that were cut to next to nothing
    std::uint8_t full_steps = 0;             // of the last eight, the latest in the lowest bit
  } pace_;
  bool moves_bounds_ = false;  // corrections may change which rows are held
  struct {
    std::vector<double> row, row_rhs;
    std::vector<Vec3> node, node_rhs, force;
  } work_;
};

}  // namespace isochor
