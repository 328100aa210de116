// Rows with a compliance of their own, eliminated into the stiffness one by one: with dl = (G dx - g) / C the
// forces of a row are G^T dl, and K becomes K + G^T G / C. A row held at a bound adds nothing.
#pragma once

#include "engine/solve/kkt/matrix_values.h"
#include "engine/solve/kkt/row_jacobian.h"

namespace isochor {

class CondensedRows {
 public:
  CondensedRows(const System& system, const RowJacobian& jacobian);

  void assemble(const MatrixValues& values, std::span<double> matrix);
  void reduce(std::span<const double> row_rhs, std::span<double> rhs);
  void recover(std::span<const double> row_rhs, std::span<const double> solution,
               std::span<double> dlambda) const;

  // For systems next to the one that was factored: k numbers System::treated().condensed.
  std::size_t count() const { return compliance_.size(); }
  double compliance(std::size_t k) const { return compliance_[k]; }
  bool held(std::size_t k) const { return held_[k] != 0; }
  void hold(std::size_t k, bool held) { held_[k] = held ? 1 : 0; }
  // What reduce() set aside: dl = G dx / C - part.
  double part(std::size_t k) const { return part_[k]; }

 private:
  const System& system_;
  const RowJacobian& jacobian_;
  std::vector<double> compliance_, part_;
  std::vector<std::uint8_t> held_;
};

}  // namespace isochor
