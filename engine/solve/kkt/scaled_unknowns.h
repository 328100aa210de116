// The unknowns of the saddle-point matrix, scaled so that its diagonal is of order 1, and the ways between
// them and the nodes.
#pragma once

#include "engine/base/parallel.h"
#include "engine/solve/kkt/matrix_values.h"

namespace isochor {

class ScaledUnknowns {
 public:
  explicit ScaledUnknowns(const System& system);
  ScaledUnknowns(const ScaledUnknowns&) = delete;
  ScaledUnknowns& operator=(const ScaledUnknowns&) = delete;

  // Diagonal of S: a step is S u, and the matrix that is factored S A S. Always the same memory.
  std::span<const double> scale() const { return scale_; }

  // Nodes by their stiffness, kept rows by their metric. The shift comes with it, relative to the stiffness
  // before rows are condensed into it.
  void choose(const MatrixValues& values, std::span<double> matrix);
  // Once rows have been added to the stiffness: nodes that they made stiffer.
  void choose_again(std::span<const double> matrix);
  // matrix = S matrix S.
  void apply(const Parallel& parallel, std::span<double> matrix) const;

  // Forces of all nodes into the displacement part of u, in free directions and scaled.
  void from_nodes(std::span<const Vec3> force, std::span<double> u) const;
  // The displacement part of u as steps of all nodes.
  void to_nodes(std::span<const double> u, std::span<Vec3> dx) const;
  // w += factor times forces of nodes; for few that are not zero.
  void add_forces(double factor, std::span<const Vec3> force, std::span<double> w) const;

 private:
  const System& system_;
  std::vector<double> scale_;
};

}  // namespace isochor
