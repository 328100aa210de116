// Newton's method on the saddle point, globalised by a merit function that a Newton direction always
// descends.
//
// Merit. Give every compliant row its own strain eta (so that phi(x) - target = C eta, with energy eta^T C
// eta / 2) and keep the new multiplier estimate l = lambda + dlambda fixed while searching:
//   P(x, eta) = E(x) + 1/2 eta^T C eta + l^T theta + gamma/2 theta^T D^-1 theta,  theta = phi(x) - target - C
//   eta.
// Along (dx, deta = dlambda) from eta = lambda its slope is
//   -(dx^T H dx + dlambda^T C dlambda) - gamma theta^T D^-1 theta,
// which is negative for a moderate gamma whenever the inertia of the saddle-point matrix is right, for every
// C >= 0 alike: nu = 0.5 and 0.4999 take the same path. Prescribed coordinates that have not reached their
// targets enter as hard rows whose multipliers are the reactions, so a large prescribed motion is searched
// like any other step.
#pragma once

#include <optional>

#include "engine/solve/saddle_point.h"

namespace isochor {

class Newton : public SaddlePoint {
 public:
  Newton(std::shared_ptr<const System> system, const Parallel& parallel,
         std::unique_ptr<LinearSolver> solver);

  SaddleReport solve(const SaddleProblem& problem, const SaddleOptions& options, std::span<Vec3> x,
                     std::span<double> lambda) override;

 protected:
  void choose_clamped(std::span<const double> lambda, bool first);
  bool direction(std::span<const double> lambda, SaddleReport& report);
  // Who solves for a direction: the factors of the matrix at hand, which may be unsymmetric; or steps on
  // symmetric factors, of a matrix next to the one wanted (Kkt::solve_coupled).
  enum class Coupling : std::uint8_t { none, factored, added };
  void begin_search(const SaddleOptions& options);  // of a solve
  void damp_cycles(const SaddleReport& report);
  bool left_all_bounds(std::span<const Vec3> x) const;
  bool descends(const SaddleProblem& p, std::span<const Vec3> x, std::span<const double> lambda);
  bool descend_unmended(const SaddleProblem& p, std::span<const Vec3> x, std::span<const double> lambda,
                        SaddleReport& report);
  bool mend_direction(const SaddleProblem& p, std::span<const Vec3> x, std::span<const double> lambda,
                      SaddleReport& report);
  double longest_step(double tau);
  bool search(const SaddleProblem& p, std::span<Vec3> x, std::span<double> lambda, SaddleReport& report);
  void try_coupled(const SaddleProblem& p, double tau, std::span<const Vec3> x,
                   std::span<const double> lambda, SaddleReport& report);
  bool correct(const SaddleProblem& p, const SaddleOptions& options, std::span<Vec3> x,
               std::span<double> lambda, SaddleReport& report);
  bool correct_coupled(const SaddleProblem& p, const SaddleOptions& options, std::span<Vec3> x,
                       std::span<double> lambda, SaddleReport& report);
  static constexpr double correction_tolerance = 1e-2;  // of the linear systems of corrections
  static bool close_enough(const SaddleReport& report);

  std::vector<double> lambda_new_, lambda_trial_;
  std::vector<Vec3> dx_, x_trial_;
  bool full_step_ = false;
  std::optional<UnsymmetricPart> part_;  // of systems with a lag whose derivatives are known
  Coupling coupling_ = Coupling::none;
  double coupled_tolerance_ = 0;          // of Coupling::added
  bool moves_bounds_ = false;             // corrections may change which rows are held
  std::vector<double> bound_, to_bound_;  // rows with bounds: the bound, and how far away it is

 private:
  void keep_multipliers(const SaddleProblem& p, std::span<const Vec3> x, std::span<double> lambda);
  double merit(const SaddleProblem& p, double tau, std::span<const double> lambda) const;
  double merit_slope(std::span<const double> lambda);
  double try_step(const SaddleProblem& p, double tau, std::span<const Vec3> x, std::span<const double> lambda,
                  SaddleReport& report);
  void rest_gap(const SaddleReport& report);
  bool out_of_patience(const SaddleOptions& options, int iteration, int factorizations) const;
  bool may_venture() const;
  void venture(std::span<const Vec3> x, std::span<const double> lambda, double enough, double excess);
  bool settle_venture(const SaddleProblem& p, std::span<Vec3> x, std::span<double> lambda,
                      SaddleReport& report);

  std::array<double, 5> past_residuals_{};  // of forces, the latest first
  double cycle_ = 0;                        // one that came back; 0: none did
  double damping_ = 1;                      // longest step that may be taken since
  bool resting_ = false;                    // prescribed motion waits for the body to follow
  int creeping_ = 0;                        // steps in a row that were cut to next to nothing
  std::uint8_t full_steps_ = 0;             // of the last eight, the latest in the lowest bit
  // A step that the merit refused and that was taken all the same, until one more Newton step has shown
  // where it leads: where it started, its direction, and the merit that must be reached.
  struct Venture {
    bool under_way = false;
    int failed = 0;     // in this solve, less those that went well
    double length = 1;  // of the step that is ventured
    int returns = 0;    // steps back so far
    double enough = 0, gamma = 0;
    double excess = 0;  // of the merit over `enough` where it is now
    std::vector<Vec3> x, dx;
    std::vector<double> lambda, lambda_new;
  } venture_;
  double gamma_ = 0.1;  // more would follow the volume too closely, less would lose descent; raised as needed

  std::vector<double> row_work_, row_rhs_;
  std::vector<Vec3> node_work_, node_rhs_, reaction_;
};

}  // namespace isochor
