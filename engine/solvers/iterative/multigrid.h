// Smoothed-aggregation algebraic multigrid for stiffness matrices of nodes with three coordinates, as a
// preconditioner that is definite whatever the matrix.
//
// Vanek, Mandel & Brezina 1996: nodes are put together in aggregates, rigid motions of the aggregates span
// the coarse space (after one smoothing step), and the coarse matrix is its Galerkin projection.
//
// Definiteness. Let D be the diagonal blocks made definite (the absolute values of their eigenvalues), and p
// the polynomial of the smoother, p(0) = 1, |p| < 1 on the positive eigenvalues of D^-1 K and p > 1 on its
// negative ones (a Chebyshev polynomial on [a, b] with b above the largest one is monotone below a). The
// symmetrized smoother (1 - p(t)^2) / t is then positive for every t, of either sign, and the cycle is that
// plus E P B P^T E^T, B the cycle of the coarse level. On the coarsest level B inverts the absolute values of
// the eigenvalues. So the cycle is definite by induction, also where K is not.
#pragma once

#include <array>

#include "engine/solvers/front/block_matrix.h"

namespace isochor {

struct MultigridOptions {
  int smoother_degree = 2;
  double smoother_range = 12;  // largest over smallest eigenvalue that the smoother cares for
  Index coarsest = 48;         // aggregates on the coarsest level, at most
};

class Multigrid {
 public:
  explicit Multigrid(const MultigridOptions& options = {}) : options_(options) {}

  // Takes a matrix of 3 x 3 blocks with its pattern filled in, diagonal blocks included.
  void analyze(BlockMatrix fine);
  // The fine matrix, whose values the caller fills in before factor(). A coordinate that does not exist has a
  // row and a column of zeros.
  BlockMatrix& matrix() { return levels_.front().a; }
  const BlockMatrix& matrix() const { return levels_.front().a; }
  // `modes`: for each fine node three rows of six, the motions that the matrix hardly resists. `caution`
  // multiplies the bounds on eigenvalues, which are estimates.
  void factor(const RowLoop& loop, std::span<const double> modes, double caution = 1);
  // x = B b, one cycle.
  void apply(const RowLoop& loop, std::span<const double> b, std::span<double> x);

  int level_count() const { return static_cast<int>(levels_.size()); }
  std::int64_t nonzeros() const;  // of the matrices of all levels
  bool coarse_was_definite() const { return coarse_definite_; }
  std::size_t bytes() const;

 private:
  struct Level {
    BlockMatrix a;
    std::vector<double> diagonal_inverse;  // blocks
    double bound = 1;                      // on the eigenvalues of D^-1 A
    // To the next level; unused on the coarsest.
    std::vector<Index> aggregate;  // of a node
    Index aggregates = 0;
    BlockMatrix p, ap;                        // prolongation and A P
    std::vector<std::int64_t> p_by_column;    // blocks of p by aggregate, rows ascending
    std::vector<Index> p_row;                 // their rows
    std::vector<std::int64_t> p_start;        // where an aggregate's begin
    std::vector<Index> member, member_start;  // nodes of an aggregate
    std::vector<double> tentative;            // block of each node in its aggregate's columns
    std::vector<double> modes;                // rows of six
    // Of the cycle.
    std::vector<double> x, b, r, d, dot;
  };

  void build_pattern(Level& level, Level& coarse);
  double estimate_bound(const RowLoop& loop, Level& level);
  void prolongate_tentative(const RowLoop& loop, Level& level, Level& coarse);
  void smooth_prolongation(const RowLoop& loop, Level& level);
  void project(const RowLoop& loop, Level& level, Level& coarse);
  void factor_coarsest();
  void solve_coarsest(std::span<const double> b, std::span<double> x);
  void smooth(const RowLoop& loop, Level& level, std::span<const double> b, std::span<double> x,
              bool from_zero);
  void cycle(const RowLoop& loop, std::size_t index, std::span<const double> b, std::span<double> x);

  MultigridOptions options_;
  std::vector<Level> levels_;
  BlockedDot dot_;
  bool dense_ = true, coarse_definite_ = true;
  std::vector<double> coarse_, coarse_work_;  // L of the coarsest matrix, or its modified inverse
};

}  // namespace isochor
