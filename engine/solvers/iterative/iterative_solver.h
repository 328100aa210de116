// Preconditioned minimal residuals on the saddle point: multigrid on the displacements, the row metric on the
// multipliers. Memory is linear in the mesh.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "engine/solvers/gmres.h"
#include "engine/solvers/iterative/multigrid.h"
#include "engine/solvers/linear_solver.h"
#include "engine/solvers/saddle_matrix.h"

namespace isochor {

struct IterativeOptions {
  double tolerance = 1e-8;    // residual against the right-hand side, in the norm of the preconditioner
  int max_iterations = 1000;  // of one solve, restarts included
  MultigridOptions multigrid;
};

// Rows are expected in units of their metric: then the Schur complement G K^-1 G^T + C is close to 1 + C for
// rows that lie in a few elements (the mass matrix of the pressure, for volumes). Rows over many nodes have
// no such bound, but are few: their diagonal entry is measured.
class IterativeSolver final : public LinearSolver {
 public:
  explicit IterativeSolver(const IterativeOptions& options = {});

  std::string_view name() const override { return "iterative"; }
  void set_parallel(const Parallel& parallel) override { loop_ = RowLoop(&parallel); }
  bool wants_geometry() const override { return true; }
  void set_geometry(std::vector<UnknownGeometry> geometry) override { geometry_ = std::move(geometry); }
  void set_scale(std::span<const double> scale) override { scale_ = scale; }

  FactorReport analyze(const SymmetricPattern& pattern) override;
  FactorReport factor(std::span<const double> values) override;
  SolveReport solve(std::span<const double> right_hand_side, std::span<double> solution) override {
    return solve_to(0, right_hand_side, solution);
  }
  // In the Euclidean norm, or that of the definite preconditioner.
  SolveReport solve_to(double tolerance, std::span<const double> right_hand_side,
                       std::span<double> solution) override;

  // y = preconditioner times x, in the order of the pattern.
  void apply_preconditioner(std::span<const double> x, std::span<double> y);
  const Multigrid& multigrid() const { return multigrid_; }
  std::size_t bytes() const;

 private:
  void fill_modes();
  bool build();
  void measure_wide_rows();
  void apply(std::span<const double> b, std::span<double> x);
  double norm_of_residual(std::span<const double> b, std::span<const double> x);
  void finish(double b_norm, std::span<double> solution, SolveReport& report);
  bool solve_triangular(std::span<double> v);
  bool iterate_on_triangle(double wanted, std::span<double> x, int& iterations);
  bool minimize(double wanted, double first, std::span<double> x, int& iterations);
  double dot(std::span<const double> a, std::span<const double> b) { return dot_(loop_, a, b); }

  IterativeOptions options_;
  RowLoop loop_;
  BlockedDot dot_;
  std::vector<UnknownGeometry> geometry_;
  std::span<const double> scale_;
  const SymmetricPattern* pattern_ = nullptr;
  SaddleMatrix matrix_;
  Multigrid multigrid_;
  std::optional<Gmres> gmres_;
  bool factored_ = false;
  double norm_ = 0, caution_ = 1;
  std::vector<double> modes_, row_inverse_;
  std::vector<Index> wide_rows_;
  std::vector<double> b_, x_, residual_, row_sum_;
  // Three generations of vectors, preconditioned ones and directions.
  struct {
    std::vector<double> v0, v1, v2, z1, z2, w0, w1, w2;
  } lanczos_;
};

std::unique_ptr<LinearSolver> make_iterative_solver(const IterativeOptions& options = {});

}  // namespace isochor
