// The life of a sparse symmetric indefinite solver: structure once, values many times, and a report each
// time.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "isochor/choices.h"
#include "isochor/threads.h"
#include "isochor/types.h"

namespace isochor {

// Lower triangle (diagonal included) of a symmetric matrix, compressed by columns, rows ascending in each
// column.
struct OrderingBase;
struct SharedAnalysis;
struct SymmetricPattern {
  Index size = 0;
  std::vector<std::int64_t> column_start;  // size + 1
  std::vector<Index> row;                  // column_start[size]
  // Unknowns that belong together (the coordinates and the pressure row of one node, say) share a group; the
  // ordering is computed on groups, which is faster and keeps a row behind the unknowns it constrains.
  std::vector<Index> group;  // size entries, 0 .. groups-1
  Index groups = 0;
  // Optional (empty or size entries): 1 for a multiplier row, whose diagonal may be zero and whose pivot is
  // expected to be negative. The ordering keeps such a row behind an unknown that it constrains, and the
  // backends without pivoting know from it which way to regularize. Without it, the rows with a diagonal <= 0
  // are taken for that.
  std::vector<std::uint8_t> multiplier;
  // Of a matrix that is shared out (empty: it is not): the rank of each unknown. The lists of entries then
  // hold those that this rank has, each entry of the whole matrix being on one rank; columns may lack a
  // diagonal, and vectors are as long as ever.
  std::vector<Index> owner;
  // Optional: a pattern of the same unknowns that differs in a few places, whose pivot sequence may serve.
  std::shared_ptr<OrderingBase> base;
  // Optional: where solvers leave what they found out about the pattern, for others that are given it.
  std::shared_ptr<SharedAnalysis> analysis;

  std::int64_t nonzeros() const { return column_start.empty() ? 0 : column_start.back(); }
};

enum class FactorStatus : std::uint8_t { ok, singular, not_finite, out_of_memory, failed, interrupted };

struct FactorReport {
  FactorStatus status = FactorStatus::ok;
  Index negative_pivots = -1;        // -1: this backend cannot tell
  std::int64_t factor_nonzeros = 0;  // entries of L
  double memory = 0;                 // of analyze(): what factors are expected to take [bytes]; 0: not known
  std::string message;               // empty when ok
};

struct SolveReport {
  bool ok = false;
  double residual = 0;  // ||b - A x||_inf / (||A||_inf ||x||_inf + ||b||_inf), after refinement
  int refinements = 0;
  int iterations = 0;  // of an iterative method
  // The factors were replaced by better ones, which have another number of negative pivots than factor() had
  // reported; `ok` is false. A new factor() tells the right one.
  bool inertia_changed = false;
};

class Parallel;

// Where a displacement unknown sits, for backends that build coarse spaces from rigid motions.
struct UnknownGeometry {
  Index node = 0;
  Vec3 position, direction;  // rest position of its node [m]; unit vector that it moves the node along
};

class LinearSolver {
 public:
  virtual ~LinearSolver() = default;
  virtual std::string_view name() const = 0;
  virtual std::string reason() const { return {}; }  // why this one, where there was a choice
  // Optional knowledge, handed over before analyze(): loops to work with (they outlive the solver), and the
  // displacement unknowns, which come first in the pattern. Direct backends have no use for either.
  virtual void set_parallel(const Parallel& parallel) { (void)parallel; }
  virtual bool wants_geometry() const { return false; }
  virtual void set_geometry(std::vector<UnknownGeometry> geometry) { (void)geometry; }
  // Asked often during long work, from any thread that works; true: give up, which factor() reports as
  // `interrupted` and solve() as not ok. Work of a library that cannot be asked ends first.
  virtual void set_interrupt(std::function<bool()> asked) { interrupt_ = std::move(asked); }
  // Before every factor() whose matrix is S A S: the diagonal of S, alive until the next call.
  virtual void set_scale(std::span<const double> scale) { (void)scale; }
  // A new saddle point: what was learned from the matrices of earlier ones is forgotten, so that a run does
  // not depend on where it was started.
  virtual void begin_solve() {}
  // Ordering and symbolic work, once a topology. The pattern must outlive the solver's use of it.
  virtual FactorReport analyze(const SymmetricPattern& pattern) = 0;
  // Numeric factorization of the values that belong to the analyzed pattern. A solver from
  // make_unsymmetric_solver() takes two triangles one after the other: the lower one with the diagonal, then
  // the transposed upper one in the same places, with zeros on the diagonal.
  virtual FactorReport factor(std::span<const double> values) = 0;
  // Solves with iterative refinement against the values last factored (which must still be alive and
  // unchanged).
  virtual SolveReport solve(std::span<const double> right_hand_side, std::span<double> solution) = 0;
  // The same for a solution that need not be exact: until the residual is `tolerance` of the right-hand side,
  // in the norm of the backend (0: as exact as solve()). What is not known to stop early does not.
  virtual SolveReport solve_to(double tolerance, std::span<const double> right_hand_side,
                               std::span<double> solution) {
    (void)tolerance;
    return solve(right_hand_side, solution);
  }
  // x := M^-1 x, M what the factors last made are exactly those of: next to the matrix. False where there are
  // no factors.
  virtual bool precondition(std::span<double> x) {
    (void)x;
    return false;
  }

 protected:
  bool interrupted() const { return interrupt_ && interrupt_(); }
  const std::function<bool()>& interrupt() const { return interrupt_; }

 private:
  std::function<bool()> interrupt_;
};

struct SolverWishes {
  bool prefer_iterative = false;  // of `automatic`: factors only where iterations have failed
  // Factors in single precision where refinement shows that they do. Off where matrices next to singular
  // ones are the point.
  bool single_precision = true;
};

// The backend asked for, or one that chooses among those built in. Null when the backend is not
// part of this build.
std::unique_ptr<LinearSolver> make_linear_solver(Solver kind, const SolverWishes& wishes = {});

// For matrices that are symmetric in their pattern alone: LU factors, without inertia. Never null; of a kind
// that has no such factors the one that every build has.
std::unique_ptr<LinearSolver> make_unsymmetric_solver(Solver kind);

// The backends of this build with their licenses, for `isochor version`.
struct SolverBackend {
  std::string name, version, license;
};
std::vector<SolverBackend> linear_solver_backends();

}  // namespace isochor
