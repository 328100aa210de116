// What the methods that solve one saddle point share: the problem of an increment, residuals and their scaled
// norms, the potential, and the linear systems.
#pragma once

#include <functional>

#include "engine/solve/kkt/kkt.h"

namespace isochor {

struct SaddleOptions {
  int max_iterations = 60;
  // Of a budget: no more, whatever else a method counts its iterations by. 0: none.
  int budget = 0;
  int max_factorizations = 1000;  // mending an inertia takes more than one an iteration
  // From so many on, a solve goes on only while it gets somewhere.
  int patient_iterations = 1000, patient_factorizations = 1000;
  // Of iterations inside of steps (SaddleReport::inner_work()): a solve whose steps take that much of them
  // gets nowhere.
  double most_inner_work() const { return 3.0 * max_factorizations; }
  // A body in motion whose steps all go downhill is given several times the limits above.
  bool persistent = false;
  // Residual force against the magnitudes that cancel in it, in the norm sqrt(sum |r_i|^2 / k_i), k_i the
  // stiffness of a node at rest plus its inertia.
  double force_tolerance = 1e-9;
  // max |phi - target - C lambda| / measure: relative volume for volume rows.
  double row_tolerance = 1e-10;
  bool corrections = true;  // whether factors at hand may be used again
  // Of the stencils' Hessians in every matrix.
  Definiteness definiteness = Definiteness::exact;
  // Largest distance to a prescribed position, relative to the scene's length.
  double position_tolerance = 1e-12;
};

// What stays fixed while one saddle point is solved.
struct SaddleProblem {
  double mass_scale = 0;               // [1/s^2]
  std::span<const Vec3> predicted;     // inertia's positions; unused when mass_scale is 0
  std::span<const Vec3> force;         // dead loads [N]
  std::span<const double> target;      // compliant rows
  std::span<const double> prescribed;  // multipliers of prescribed rows
  std::span<const Vec3> position;      // targets of given nodes, one for each System::free_bases() entry
  double t0 = 0, t1 = 0;               // the increment, for rows with a law of their own
  std::span<const double> memory;      // System::memory() numbers: what row pools keep between steps
  StencilIncrement increment;          // for stencils with a past
};

enum class SaddleStatus : std::uint8_t {
  converged,
  iteration_limit,
  line_search_failed,
  singular,
  diverged,    // positions left every reasonable bound
  not_finite,  // NaN or infinity in loads, or an energy without value at the start
  cancelled,
  out_of_memory,
  passed_through,  // converged, but nodes passed through what they must not
  inadmissible,    // converged to an end that must not be a state; the message says why
};
std::string_view to_string(SaddleStatus status);

struct SaddleReport : SolveCounters {
  SaddleStatus status = SaddleStatus::converged;
  Index negative_pivots = -1;  // of the last factorisation; rows() when the inertia is right
  double force_residual = 0, row_residual = 0, linear_residual = 0;
  double step = 0;  // largest displacement of the last step [m]
  std::string message;
  // Of a matrix that stayed singular: who is in its null vector. Nodes that may move without a force, or,
  // where `null_rows` is not empty, effects whose rows depend on each other and the nodes around them.
  std::vector<Index> null_nodes;
  std::vector<std::string> null_rows;

  // Counts the work of an earlier solve of the same step in.
  void add_work(const SaddleReport& earlier) { SolveCounters::operator+=(earlier); }
  // What iterations inside of steps took, in factorizations, roughly: the same on every machine.
  double inner_work() const {
    return 0.1 * dual_steps + 0.05 * static_cast<double>(dual_iterations) +
           0.02 * static_cast<double>(linear_iterations);
  }
  double work() const { return factorizations + 0.1 * corrections + inner_work(); }
};

class SaddlePoint {
 public:
  SaddlePoint(std::shared_ptr<const System> system, const Parallel& parallel,
              std::unique_ptr<LinearSolver> solver);
  virtual ~SaddlePoint() = default;

  // Improves x and lambda in place; on anything but converged they hold the last iterate.
  virtual SaddleReport solve(const SaddleProblem& problem, const SaddleOptions& options, std::span<Vec3> x,
                             std::span<double> lambda) = 0;

  // Asked often, from any thread that works; true stops the solve.
  void set_interrupt(std::function<bool()> asked);
  // Called after every iteration: iteration number and the two residuals.
  std::function<void(int, double, double)> progress;

  const Assembly& assembly() const { return assembly_; }
  Assembly& assembly() { return assembly_; }
  LinearSolver& linear_solver() { return kkt_.linear_solver(); }
  // For what replaces it; there is no solving any more.
  std::unique_ptr<LinearSolver> release_solver() { return kkt_.release_solver(); }
  std::unique_ptr<LinearSolver> release_unsymmetric() { return kkt_.release_unsymmetric(); }
  const StageSeconds& seconds() const { return seconds_; }
  // Counts the time of a method that this one takes the place of.
  void add_seconds(const StageSeconds& earlier) { seconds_ += earlier; }
  std::int64_t factor_nonzeros() const { return kkt_.factor_nonzeros(); }
  int analyses() const { return kkt_.analyses(); }
  // Largest diagonal stiffness of each node at rest [N/m].
  std::span<const double> rest_stiffness() const { return rest_stiffness_; }
  // Energy that positions and multipliers hold [J]: elastic, of compliant rows and of rows with a law, less
  // the work of loads since rest; no inertia.
  struct Stored {
    double energy = 0;
    double elastic = 0;  // magnitude of the elastic part, to compare changes with
    double noise = 0;    // rounding error of the energy
    double row = 0;      // residual of the rows, as SaddleReport::row_residual
    bool met = false;    // rows and given positions are where the problem wants them
  };
  Stored stored_at(const SaddleProblem& p, std::span<const Vec3> x, std::span<const double> lambda);
  // The same of the last evaluation with its residuals, which was there: that of a solve that converged.
  Stored stored(const SaddleProblem& p, std::span<const Vec3> x, std::span<const double> lambda) const;
  // Internal minus load forces, plus inertia, at the last evaluation: zero at free coordinates in balance,
  // the support force on the body at given ones [N].
  std::span<const Vec3> residual() const { return r_; }

 protected:
  struct Residuals {
    double force, row, position;
  };
  struct RowResiduals {
    double row, position;
  };
  // The following but calibrate() read the last evaluation of the assembly.
  void calibrate();
  void begin(const SaddleProblem& p);  // of a solve: nothing of an earlier one is left
  double potential(const SaddleProblem& p, std::span<const Vec3> x) const;
  double potential_magnitude(const SaddleProblem& p, std::span<const Vec3> x) const;
  void assemble_residual(const SaddleProblem& p, std::span<const Vec3> x, std::span<const double> lambda) {
    force_residual(p, x);
    row_residual(p, lambda);
  }
  void force_residual(const SaddleProblem& p, std::span<const Vec3> x);
  void row_residual(const SaddleProblem& p, std::span<const double> lambda);
  Residuals measure(const SaddleProblem& p, std::span<const Vec3> x, std::span<const double> lambda) const;
  RowResiduals measure_rows(const SaddleProblem& p, std::span<const Vec3> x,
                            std::span<const double> lambda) const;
  bool balanced(const SaddleProblem& p, const SaddleOptions& o, std::span<const Vec3> x,
                std::span<const double> lambda, SaddleReport& report) const;
  double apply_laws(const SaddleProblem& p, std::span<const double> lambda, bool tangents);
  void clamp(std::span<double> lambda) const;
  bool factor(const SaddleProblem& p, std::span<const Vec3> x, std::span<const double> lambda,
              SaddleReport& report);
  bool factor_shifted(double mass_scale, double shift, SaddleReport& report);
  bool add_trace(double mass_scale, SaddleReport& report);
  bool gave_up(SaddleReport& report) const;
  void explain_singular(SaddleReport& report);
  void name_rows(std::span<const double> null, SaddleReport& report) const;
  void name_nodes(std::span<const double> null, SaddleReport& report) const;
  bool interrupted() const { return cancelled_ && cancelled_(); }
  // The status of a solve that failed: whatever the reason seems to be, if it was stopped that is it.
  SaddleStatus failed_as(SaddleStatus status) const {
    return interrupted() ? SaddleStatus::cancelled : status;
  }
  // y += mass_scale M gap: the lumped part of it falls on given directions alone and is left out.
  void add_inertia_of_gap(std::span<Vec3> y);
  void position_gap(const SaddleProblem& p, std::span<const Vec3> x);

  std::function<bool()> cancelled_;
  std::shared_ptr<const System> system_;
  Assembly assembly_;
  Kkt kkt_;
  StageSeconds seconds_;
  bool any_clamped_ = false, singular_ = false;
  double trace_ = 0;       // of compliance in the matrix, where rows repeat each other
  double mass_scale_ = 0;  // of this solve
  Definiteness definiteness_ = Definiteness::exact;  // of this solve
  bool mended_ = false;                              // the last factors are not those of the exact matrix
  // In a body whose stiffness varies a shift holds the stiff part, which may only turn, against what the soft
  // part does: it goes down as far as it may.
  static constexpr double smallest_shift = 1e-10;
  double shift_ = 0;           // the last one that mended the inertia in this solve
  bool has_gap_ = false;       // given coordinates that are not at their targets yet
  double inertia_energy_ = 0;  // at the last force residual
  double law_energy_ = 0;      // of the rows with a law of their own, at the last residual
  std::vector<double> theta_, stiffness_, magnitude_, rest_stiffness_, prescribed_phi_;
  // Rows with laws: strain and tangent (one for each compliance entry).
  std::vector<double> strain_, tangent_;
  std::vector<std::uint8_t> clamped_;  // rows that the matrix holds at a bound
  std::vector<Vec3> r_, gap_, way_, inertia_;
};

inline double norm(const Vec3& v) {
  return std::sqrt(dot(v, v));
}
inline bool finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}
bool all_finite(const SaddleProblem& p);
// y += alpha * C v over the compliance entries.
void add_compliance(const System& s, double alpha, std::span<const double> v, std::span<double> y);
// v^T C v / 2 over the compliance entries.
double compliance_energy(const System& s, std::span<const double> v);

}  // namespace isochor
