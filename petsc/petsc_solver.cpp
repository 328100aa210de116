#include "petsc/petsc_solver.h"

#include <petscksp.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "petsc/calls.h"
#include "petsc/krylov.h"
#include "petsc/shared_matrix.h"

namespace isochor {

namespace {

constexpr double kAcceptable = 1e-10;           // residual of factors, as SolveReport::residual
constexpr Index kMostToFactor = 200'000;        // unknowns that the automatic choice factors without need
constexpr Index kMostToFallBackOn = 1'000'000;  // and after iterations have failed

// Takes symmetric matrices, and unsymmetric ones as solvers of make_unsymmetric_solver() do: told by how many
// values there are.
class PetscSolver final : public LinearSolver {
 public:
  PetscSolver(const Ranks& ranks, Solver kind, bool prefer_iterative)
      : ranks_(ranks), kind_(kind), prefer_iterative_(prefer_iterative), matrix_(ranks) {}
  ~PetscSolver() override {
    if (direct_) KSPDestroy(&direct_);
  }
  PetscSolver(const PetscSolver&) = delete;
  PetscSolver& operator=(const PetscSolver&) = delete;

  std::string_view name() const override { return iterates_ ? "PETSc FGMRES" : "PETSc MUMPS"; }
  std::string reason() const override { return std::to_string(ranks_.size()) + " ranks" + why_; }
  bool wants_geometry() const override { return true; }
  void set_geometry(std::vector<UnknownGeometry> geometry) override { geometry_ = std::move(geometry); }
  void set_scale(std::span<const double> scale) override { scale_ = scale; }

  FactorReport analyze(const SymmetricPattern& pattern) override;
  FactorReport factor(std::span<const double> values) override;
  SolveReport solve(std::span<const double> right_hand_side, std::span<double> solution) override {
    return solve_to(0, right_hand_side, solution);
  }
  SolveReport solve_to(double tolerance, std::span<const double> right_hand_side,
                       std::span<double> solution) override;
  bool precondition(std::span<double> x) override;

 private:
  void choose(Index unknowns);
  void prepare();
  void make_direct();
  FactorReport factor_direct();
  bool refine(double tolerance, SolveReport& report);
  bool fall_back(SolveReport& report);
  double residual_of_solution(double right_norm);

  const Ranks& ranks_;
  Solver kind_;
  bool prefer_iterative_, iterates_ = false, factored_ = false, symmetric_ = true;
  std::string why_;
  std::vector<UnknownGeometry> geometry_;
  std::span<const double> scale_, values_;
  const SymmetricPattern* pattern_ = nullptr;
  SharedMatrix matrix_;
  KSP direct_ = nullptr;
  PetscInt room_ = 0;  // ICNTL(14), as it had to be
  std::optional<Krylov> krylov_;
};

double norm_of(Vec v) {
  PetscReal norm = 0;
  check(VecNorm(v, NORM_INFINITY, &norm), "a norm");
  return norm;
}

void PetscSolver::choose(Index unknowns) {
  const bool alone = geometry_.empty();  // no displacements to build coarse grids on
  iterates_ = !alone && (kind_ == Solver::iterative ||
                         (kind_ == Solver::automatic && (prefer_iterative_ || unknowns > kMostToFactor)));
  why_ = kind_ != Solver::automatic ? ""
         : !iterates_               ? ""
         : prefer_iterative_        ? ", large, with inertia"
                                    : ", too large to factor";
}

FactorReport PetscSolver::analyze(const SymmetricPattern& pattern) {
  pattern_ = &pattern;
  factored_ = false;
  choose(pattern.size);
  prepare();
  return {};
}

void PetscSolver::prepare() {
  if (direct_) check(KSPDestroy(&direct_), "starting anew");
  krylov_.reset();
  if (pattern_->size == 0) return;
  matrix_.analyze(*pattern_, geometry_, iterates_, symmetric_);
}

void PetscSolver::make_direct() {
  PC pc = nullptr;
  check(KSPCreate(PETSC_COMM_WORLD, &direct_), "making MUMPS");
  check(KSPSetOperators(direct_, matrix_.matrix(), matrix_.matrix()), "making MUMPS");
  check(KSPSetType(direct_, KSPPREONLY), "making MUMPS");
  check(KSPGetPC(direct_, &pc), "making MUMPS");
  check(PCSetType(pc, symmetric_ ? PCCHOLESKY : PCLU), "making MUMPS");
  check(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS), "making MUMPS");
  check(KSPSetFromOptions(direct_), "making MUMPS");
}

// Pivoting may need more room than the analysis foresaw. What was enough once is kept for the factors to
// come.
FactorReport PetscSolver::factor_direct() {
  constexpr PetscInt most_room = 3000;  // beyond what was foreseen [%]
  FactorReport report;
  Mat factor = nullptr;
  PetscInt code = 0;
  PCFailedReason failed = PC_NOERROR;
  for (;;) {
    if (!direct_) make_direct();
    PC pc = nullptr;
    check(KSPGetPC(direct_, &pc), "factoring");
    check(PCFactorSetUpMatSolverType(pc), "factoring");
    check(PCFactorGetMatrix(pc, &factor), "factoring");
    if (room_ > 0) check(MatMumpsSetIcntl(factor, 14, room_), "factoring");
    // Without this a solver that has been set up looks at new values when it solves, and its inertia is the
    // old one.
    check(KSPSetOperators(direct_, matrix_.matrix(), matrix_.matrix()), "factoring");
    check(KSPSetUp(direct_), "factoring");
    check(PCGetFailedReason(pc, &failed), "factoring");
    check(MatMumpsGetInfog(factor, 1, &code), "factoring");
    if (code != -8 && code != -9) break;
    check(MatMumpsGetIcntl(factor, 14, &room_), "factoring");
    if (room_ >= most_room) break;
    room_ = 2 * room_ + 20;
    // PETSc does not factor again what has failed.
    check(KSPDestroy(&direct_), "factoring");
  }
  if (failed != PC_NOERROR) {
    report.status = failed == PC_FACTOR_OUTMEMORY ? FactorStatus::out_of_memory : FactorStatus::singular;
    report.message = "MUMPS could not factor the matrix, INFOG(1) = " + std::to_string(code);
    check(KSPDestroy(&direct_), "factoring");
    return report;
  }
  PetscInt negative = -1, zero = 0, positive = 0, nonzeros = 0;
  if (symmetric_)
    check(MatGetInertia(factor, &negative, &zero, &positive), "asking for the inertia");
  else
    check(MatMumpsGetInfog(factor, 28, &zero), "asking for null pivots");
  check(MatMumpsGetInfog(factor, 29, &nonzeros), "factoring");
  report.negative_pivots = static_cast<Index>(negative);
  report.factor_nonzeros = nonzeros < 0 ? -std::int64_t{nonzeros} * 1'000'000 : nonzeros;
  if (zero > 0) {
    report.status = FactorStatus::singular;
    report.message = "the matrix is numerically singular: " + std::to_string(zero) + " null pivots";
  }
  return report;
}

FactorReport PetscSolver::factor(std::span<const double> values) {
  factored_ = false;
  values_ = values;
  FactorReport report;
  const std::size_t entries = pattern_ == nullptr ? 0 : static_cast<std::size_t>(pattern_->nonzeros());
  if (pattern_ == nullptr || (values.size() != entries && values.size() != 2 * entries)) {
    report.status = FactorStatus::failed;
    report.message = pattern_ == nullptr ? "factor was called without a successful analyze"
                                         : "the number of values is not that of the analyzed pattern";
    return report;
  }
  if (pattern_->size == 0) {
    report.negative_pivots = 0;
    factored_ = true;
    return report;
  }
  if (const bool symmetric = values.size() == entries; symmetric != symmetric_) {
    symmetric_ = symmetric;
    iterates_ = iterates_ && symmetric;
    prepare();
  }
  if (!matrix_.set_values(values)) {
    report.status = FactorStatus::not_finite;
    report.message = "the matrix has a value that is not finite, or too large to sum";
    return report;
  }
  if (matrix_.norm() == 0) {
    report.status = FactorStatus::singular;
    report.message = "the matrix is zero";
    return report;
  }
  if (!iterates_) {
    report = factor_direct();
  } else if (krylov_.emplace(matrix_, geometry_, scale_); !krylov_->usable()) {
    report.status = FactorStatus::failed;
    report.message = krylov_->trouble();
  }
  factored_ = report.status == FactorStatus::ok;
  return report;
}

// The infinity norm of b - A x against those of its parts; the residual is in work().
double PetscSolver::residual_of_solution(double right_norm) {
  check(MatMult(matrix_.matrix(), matrix_.solution(), matrix_.work()), "a residual");
  check(VecAYPX(matrix_.work(), -1, matrix_.right()), "a residual");
  const double scale = matrix_.norm() * norm_of(matrix_.solution()) + right_norm;
  return scale > 0 ? norm_of(matrix_.work()) / scale : 0;
}

// Solves by the factors, and refines until nothing is gained.
bool PetscSolver::refine(double tolerance, SolveReport& report) {
  constexpr int most = 5;
  constexpr double target = 2 * std::numeric_limits<double>::epsilon();
  const double right_norm = norm_of(matrix_.right());
  check(KSPSolve(direct_, matrix_.right(), matrix_.solution()), "solving");
  report.residual = residual_of_solution(right_norm);
  Vec step = nullptr, before = nullptr;
  check(VecDuplicate(matrix_.right(), &step), "refining");
  check(VecDuplicate(matrix_.right(), &before), "refining");
  while (report.residual > target && report.refinements < most && std::isfinite(report.residual)) {
    if (report.refinements > 0 && norm_of(matrix_.work()) <= tolerance * right_norm) break;
    check(VecCopy(matrix_.solution(), before), "refining");
    check(KSPSolve(direct_, matrix_.work(), step), "refining");
    check(VecAXPY(matrix_.solution(), 1, step), "refining");
    const double now = residual_of_solution(right_norm), then = report.residual;
    ++report.refinements;
    if (!(now < then)) {
      check(VecCopy(before, matrix_.solution()), "refining");
      break;
    }
    report.residual = now;
    if (now > 0.5 * then) break;
  }
  check(VecDestroy(&step), "refining");
  check(VecDestroy(&before), "refining");
  return report.residual <= kAcceptable;
}

// Factors in place of iterations that have failed, from here on.
bool PetscSolver::fall_back(SolveReport& report) {
  if (kind_ != Solver::automatic || pattern_->size > kMostToFallBackOn) return false;
  iterates_ = false;
  why_ = ", FGMRES had failed";
  prepare();
  const FactorReport factored = factor(values_);
  if (factored.status != FactorStatus::ok) return false;
  // Whoever asked went by an inertia that nobody had told.
  report.inertia_changed = true;
  return true;
}

SolveReport PetscSolver::solve_to(double tolerance, std::span<const double> right_hand_side,
                                  std::span<double> solution) {
  SolveReport report;
  report.residual = std::numeric_limits<double>::infinity();
  std::fill(solution.begin(), solution.end(), 0.0);
  const std::size_t n = pattern_ == nullptr ? 0 : at(pattern_->size);
  if (!factored_ || right_hand_side.size() != n || solution.size() != n) return report;
  if (n == 0) return {true, 0, 0};
  double largest = 0;
  for (const double b : right_hand_side)
    largest = std::isfinite(b) ? std::max(largest, std::abs(b)) : INFINITY;
  if (!std::isfinite(largest)) return report;
  if (largest == 0) return {true, 0, 0};
  matrix_.to_petsc(right_hand_side, matrix_.right());
  if (iterates_) {
    report.ok = krylov_->solve(tolerance, report.iterations);
    report.residual = residual_of_solution(largest);
    report.ok = report.ok && std::isfinite(report.residual);
    if (!report.ok) {
      fall_back(report);
      return report;
    }
  } else {
    report.ok = refine(tolerance, report);
  }
  if (std::isfinite(report.residual)) matrix_.from_petsc(matrix_.solution(), solution);
  return report;
}

bool PetscSolver::precondition(std::span<double> x) {
  if (!factored_ || iterates_ || x.size() != at(pattern_->size)) return false;
  if (x.empty()) return true;
  matrix_.to_petsc(x, matrix_.right());
  check(KSPSolve(direct_, matrix_.right(), matrix_.solution()), "solving");
  matrix_.from_petsc(matrix_.solution(), x);
  return std::all_of(x.begin(), x.end(), [](double v) { return std::isfinite(v); });
}

}  // namespace

std::unique_ptr<LinearSolver> make_petsc_solver(const Ranks& ranks, Solver kind, bool prefer_iterative) {
  if (kind != Solver::automatic && kind != Solver::mumps && kind != Solver::iterative) return nullptr;
  return std::make_unique<PetscSolver>(ranks, kind, prefer_iterative);
}

}  // namespace isochor
