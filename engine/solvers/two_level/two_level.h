// A preconditioner for quadratic displacements with pressures at corners: smoothing at the middles of edges,
// and the factors of what linear tets make of the same mesh.
//
// With S the smoother of the middles (a Chebyshev polynomial in D^-1 K_mm), P the prolongation from the
// corners and A_c the coarse matrix,
//
//   M^-1 = S + (1 - S A) P A_c^-1 P^T (1 - A S),
//
// one application:
//
//   x = S b                      at the middles
//   c = A_c^-1 P^T (b - A x)     at the corners, and the rows
//   x = x + P c
//   x = x + S (b - A x)          at the middles; S b is in x already
//
// Inertia. M is symmetric, and (1 - S A) P and the middles span everything: M has as many negative
// eigenvalues as A_c, as long as S is definite. S is, whatever K_mm: D is made of the magnitudes of its
// blocks' eigenvalues, and 1 minus the Chebyshev polynomial has the sign of its argument below the bound.
// That of A is the same unless M^-1 A has a negative eigenvalue: on the way from M to A one would pass zero.
#pragma once

#include <memory>

#include "engine/solvers/front/multifrontal_solver.h"
#include "engine/solvers/two_level/coarse_matrix.h"

namespace isochor {

struct TwoLevelOptions {
  int smoother_degree = 2;
  double smoother_range = 5;  // largest over smallest eigenvalue that the smoother cares for
};

class TwoLevel {
 public:
  TwoLevel(std::unique_ptr<LinearSolver> pivoting, const TwoLevelOptions& options = {});

  void set_parallel(const Parallel& parallel);
  void set_interrupt(std::function<bool()> asked) { coarse_solver_.set_interrupt(std::move(asked)); }
  void begin_solve() { coarse_solver_.begin_solve(); }

  // False where too few nodes are middles of edges, or there are no rows: then there is nothing here for it.
  bool analyze(const SymmetricPattern& pattern, std::span<const UnknownGeometry> geometry);
  FactorReport factor(std::span<const double> values, std::span<const double> scale);

  // Vectors as SaddleMatrix has them. w = A v; and v := M^-1 v, false when the coarse factors fail.
  std::size_t size() const { return matrix_.size(); }
  std::span<const Index> place() const { return matrix_.place(); }
  void multiply(std::span<const double> v, std::span<double> w) const {
    matrix_.multiply(loop_, stiffness_, v, w);
  }
  bool precondition(std::span<double> v);

  Index rows() const { return matrix_.rows(); }
  Index middles() const { return prolongation_.edges().count; }
  // Multiplications of the coarse factorization, and of one application with its product.
  double factor_work() const { return coarse_solver_.tree().operations; }
  double direction_work() const;

 private:
  // Blocks in single precision, three columns of four numbers each, of some rows and columns of the
  // stiffness.
  struct Narrow {
    std::vector<std::int64_t> start{0};
    std::vector<Index> column;
    std::vector<std::int64_t> source;  // block of the stiffness
    std::vector<float> value;
  };
  void list_blocks();
  void fill(Narrow& part) const;
  void estimate_bound();
  void subtract(const Narrow& part, std::span<const float> x, std::span<float> r) const;
  void solve_diagonal(float alpha, float beta);
  void smooth();
  void leave_middles(std::span<double> v) const;
  void take_corners(std::span<const double> v);

  TwoLevelOptions options_;
  RowLoop loop_;
  SaddleMatrix matrix_;
  BlockMatrix stiffness_;
  Prolongation prolongation_;
  CoarseMatrix coarse_;
  MultifrontalSolver coarse_solver_;
  std::vector<Index> middle_;  // nodes
  std::vector<Index> corner_;  // nodes
  Narrow middles_, to_corners_, to_middles_;
  std::vector<double> inverse_;        // of the diagonal blocks of all nodes; those of middles are used
  std::vector<float> middle_inverse_;  // the same as blocks of Narrow
  double bound_ = 1;                   // on the eigenvalues of D^-1 K_mm
  // Four numbers a node: what is smoothed, its residual, directions; and corners.
  std::vector<float> x_, r_, d_, at_corners_;
  std::vector<double> coarse_vector_;
};

}  // namespace isochor
