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

#include <atomic>
#include <functional>

#include "engine/kkt.h"

namespace isochor {

struct NewtonOptions {
  int max_iterations = 60;
  int max_factorizations = 1000;  // mending an inertia takes more than one an iteration
  // Residual force against the magnitudes that cancel in it, in the norm sqrt(sum |r_i|^2 / k_i), k_i the
  // stiffness of a node at rest plus its inertia.
  double force_tolerance = 1e-9;
  // max |phi - target - C lambda| / measure: relative volume for volume rows.
  double row_tolerance = 1e-10;
  // Largest distance to a prescribed position, relative to the scene's length.
  double position_tolerance = 1e-12;
};

// What stays fixed while one saddle point is solved.
struct NewtonProblem {
  double mass_scale = 0;               // [1/s^2]
  std::span<const Vec3> predicted;     // inertia's positions; unused when mass_scale is 0
  std::span<const Vec3> force;         // dead loads [N]
  std::span<const double> target;      // compliant rows
  std::span<const double> prescribed;  // multipliers of prescribed rows
  std::span<const Vec3> position;      // targets of given nodes, one for each System::free_bases() entry
  double t0 = 0, t1 = 0;               // the increment, for rows with a law of their own
  std::span<const double> memory;      // System::memory() numbers: what row pools keep between steps
  StencilIncrement increment;          // for stencils with damping; none in statics
};

enum class NewtonStatus : std::uint8_t {
  converged,
  iteration_limit,
  line_search_failed,
  singular,
  diverged,    // positions left every reasonable bound
  not_finite,  // NaN or infinity in loads, or an energy without value at the start
  cancelled,
  out_of_memory,
};
std::string_view to_string(NewtonStatus status);

struct NewtonReport {
  NewtonStatus status = NewtonStatus::converged;
  int iterations = 0, factorizations = 0, trials = 0;
  int corrections = 0;             // further steps on factors at hand
  int projected = 0, shifted = 0;  // iterations mended by projection and by a diagonal shift
  Index negative_pivots = -1;      // of the last factorisation; rows() when the inertia is right
  double force_residual = 0, row_residual = 0, linear_residual = 0;
  double step = 0;  // largest displacement of the last step [m]
  std::string message;
};

class Newton {
 public:
  Newton(std::shared_ptr<const System> system, const Parallel& parallel,
         std::unique_ptr<LinearSolver> solver);

  // Improves x and lambda in place; on anything but converged they hold the last iterate.
  NewtonReport solve(const NewtonProblem& problem, const NewtonOptions& options, std::span<Vec3> x,
                     std::span<double> lambda);

  // Asked once an iteration; true stops the solve.
  std::function<bool()> cancelled;
  // Called after every iteration: iteration number and the two residuals.
  std::function<void(int, double, double)> progress;

  const Assembly& assembly() const { return assembly_; }
  Assembly& assembly() { return assembly_; }
  LinearSolver& linear_solver() { return kkt_.linear_solver(); }
  const StageSeconds& seconds() const { return seconds_; }
  std::int64_t factor_nonzeros() const { return kkt_.factor_nonzeros(); }
  int analyses() const { return kkt_.analyses(); }
  // Internal minus load forces, plus inertia, at the last evaluation: zero at free coordinates in balance,
  // the support force on the body at given ones [N].
  std::span<const Vec3> residual() const { return r_; }

 private:
  struct Residuals {
    double force, row, position;
  };
  double potential(const NewtonProblem& p, std::span<const Vec3> x) const;
  double potential_magnitude(const NewtonProblem& p, std::span<const Vec3> x) const;
  void assemble_residual(const NewtonProblem& p, std::span<const Vec3> x, std::span<const double> lambda);
  Residuals measure(const NewtonProblem& p, std::span<const Vec3> x, std::span<const double> lambda) const;
  bool balanced(const NewtonProblem& p, const NewtonOptions& o, std::span<const Vec3> x,
                std::span<const double> lambda, NewtonReport& report) const;
  void keep_multipliers(const NewtonProblem& p, std::span<const Vec3> x, std::span<double> lambda);
  void calibrate();
  double apply_laws(const NewtonProblem& p, std::span<const double> lambda, bool tangents);
  void choose_clamped(std::span<const double> lambda);
  void clamp(std::span<double> lambda) const;
  bool correct(const NewtonProblem& p, const NewtonOptions& options, std::span<Vec3> x,
               std::span<double> lambda, NewtonReport& report);
  void position_gap(const NewtonProblem& p, std::span<const Vec3> x);
  bool factor(const NewtonProblem& p, std::span<const Vec3> x, std::span<const double> lambda,
              NewtonReport& report);
  bool factor_shifted(double mass_scale, double shift, NewtonReport& report);
  bool direction(std::span<const double> lambda, NewtonReport& report);
  double merit(const NewtonProblem& p, double tau, std::span<const double> lambda) const;
  double merit_slope(std::span<const double> lambda);
  double try_step(const NewtonProblem& p, double tau, std::span<const Vec3> x, std::span<const double> lambda,
                  NewtonReport& report);
  bool search(const NewtonProblem& p, std::span<Vec3> x, std::span<double> lambda, NewtonReport& report);

  std::shared_ptr<const System> system_;
  Assembly assembly_;
  Kkt kkt_;
  StageSeconds seconds_;
  bool has_gap_ = false, full_step_ = false;
  double shift_ = 0;       // the last one that mended the inertia in this solve
  double law_energy_ = 0;  // of the rows with a law of their own, at the last residual
  bool any_clamped_ = false;
  double gamma_ = 0.1;  // more would follow the volume too closely, less would lose descent; raised as needed

  std::vector<double> theta_, row_work_, row_rhs_, stiffness_, magnitude_, rest_stiffness_;
  std::vector<double> lambda_new_, lambda_trial_, prescribed_phi_;
  // Rows with laws: strain and tangent (one for each compliance entry). Rows with bounds: which of them the
  // matrix holds at a bound, and by how much their multipliers move there.
  std::vector<double> strain_, tangent_, bound_, to_bound_;
  std::vector<std::uint8_t> clamped_;
  std::vector<Vec3> r_, dx_, gap_, node_work_, node_rhs_, x_trial_, reaction_;
};

}  // namespace isochor
