// The saddle point on the corners of a mesh whose edges have nodes in their middles.
//
// With the prolongation P the stiffness is P^T K P and the gradients are G P: what linear tets have at the
// quadrature points of the finer mesh. All else that acts on nodes comes along. Pressures at the corners are
// too many for linear displacements, and are given what the middles took from them: a compliance between the
// ends of each edge, of the size of G_m D^-1 G_m^T, D the stiffness of the middle. It is zero where pressures
// are even.
#pragma once

#include "engine/solvers/two_level/prolongation.h"

namespace isochor {

class CoarseMatrix {
 public:
  void analyze(const SymmetricPattern& fine, const SaddleMatrix& matrix, const BlockMatrix& stiffness,
               const Prolongation& prolongation);
  // Once the prolongation is weighed. `scale` as LinearSolver::set_scale(); `middle_inverse`: inverse blocks
  // of the stiffness, by node, those of middles.
  void assemble(const RowLoop& loop, const SaddleMatrix& matrix, const BlockMatrix& stiffness,
                std::span<const double> scale, std::span<const double> middle_inverse);

  const SymmetricPattern& pattern() const { return pattern_; }
  std::span<const double> values() const { return values_; }

 private:
  // Entries of a sparse matrix by lines, each with numbers of its own, and where these go in the pattern.
  struct Part {
    std::vector<std::int64_t> start{0};
    std::vector<Index> other;
    std::vector<double> value;
    std::vector<std::int64_t> place;  // one a number; -1: nowhere
  };
  void list_stiffness(const BlockMatrix& stiffness);
  void list_gradients(const SaddleMatrix& matrix);
  void list_compliance(const SymmetricPattern& fine, const SaddleMatrix& matrix);
  void build_pattern(const SymmetricPattern& fine, const SaddleMatrix& matrix);
  void project_stiffness(const RowLoop& loop, const BlockMatrix& stiffness);
  void project_gradients(const SaddleMatrix& matrix);
  void fill_compliance(const SaddleMatrix& matrix, std::span<const double> scale,
                       std::span<const double> middle_inverse);

  const Prolongation* p_ = nullptr;
  Index rows_ = 0;
  Part stiffness_;   // blocks (a, b) of corners, b >= a
  Part gradient_;    // three numbers for a row and a corner
  Part compliance_;  // lower triangle by columns
  // For each product that adds to a block of the stiffness, in the order of the loops, to which one of its
  // corner; -1: to none.
  std::vector<std::int64_t> product_start_;
  std::vector<Index> product_;
  std::vector<Index> gradient_product_;
  struct EdgeRows {
    Index middle = 0, first = 0, second = 0;  // rows of the ends
    std::int64_t between = 0;                 // their entry
  };
  std::vector<EdgeRows> edge_rows_;
  std::vector<std::int64_t> compliance_diagonal_;
  SymmetricPattern pattern_;
  std::vector<double> values_;
};

}  // namespace isochor
