// Systems next to the one that was factored, by a generalized minimal residual method that its factors
// precondition. Matrices differ by what happens at a surface (friction that follows the normal force, points
// that begin or cease to touch), so that few steps do, each a pair of triangular solves and a product with
// the matrix.
#pragma once

#include "engine/solve/kkt/condensed_rows.h"
#include "engine/solve/kkt/factored_matrix.h"
#include "engine/solve/kkt/scaled_unknowns.h"
#include "engine/solvers/gmres.h"

namespace isochor {

class CoupledSystem {
 public:
  // What is referred to outlives this.
  CoupledSystem(const System& system, FactoredMatrix& matrix, const ScaledUnknowns& unknowns,
                RowJacobian& jacobian, CondensedRows& condensed);

  // Looks at the compliance of the rows once more.
  void take_new_numbers();
  // Notes which rows a matrix holds that is about to be factored.
  void assemble(const MatrixValues& values);
  bool holds(std::span<const std::uint8_t> held) const;

  // Which matrix is next: rows as they are held now, and an unsymmetric part (null: none). False when a row
  // changes whose compliance ties it to others.
  bool choose(const UnsymmetricPart* part, std::span<const std::uint8_t> held);
  // Once the treatments have reduced the right-hand side: takes what condensed rows' multipliers do to forces
  // apart from the steps of the nodes to it.
  void reduce(std::span<double> rhs);
  // From FactoredMatrix::rhs() to its solution(), until the residual is `tolerance` of the right-hand side.
  // False when there are no factors or a number is not finite.
  bool solve(double tolerance);

 private:
  void times(std::span<const double> u, std::span<double> w);
  void add_changed_rows(std::span<const double> u, std::span<double> w) const;
  void add_part(std::span<const double> u, std::span<double> w);
  bool held(Index row) const { return !held_.empty() && held_[at(row)] != 0; }

  const System& system_;
  FactoredMatrix& matrix_;
  const ScaledUnknowns& unknowns_;
  const RowJacobian& jacobian_;
  CondensedRows& condensed_;
  Gmres gmres_;
  // Of all rows: number among the condensed ones (-1: none), whether the factors hold it at a bound, whether
  // it may change that (no compliance ties it to others), and its own compliance. Empty without bounds, but
  // the first.
  std::vector<Index> condensed_index_;
  std::vector<std::uint8_t> factored_held_, movable_;
  std::vector<double> own_compliance_;
  // The present matrix: its unsymmetric part, rows it holds, and those it holds that the factors do not, or
  // the other way round.
  const UnsymmetricPart* part_ = nullptr;
  std::span<const std::uint8_t> held_;
  std::vector<Index> changed_;
  std::vector<Vec3> dx_, force_;
  std::vector<double> dlambda_;
};

}  // namespace isochor
