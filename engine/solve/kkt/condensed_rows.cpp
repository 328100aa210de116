#include "engine/solve/kkt/condensed_rows.h"

namespace isochor {

CondensedRows::CondensedRows(const System& system, const RowJacobian& jacobian)
    : system_(system),
      jacobian_(jacobian),
      compliance_(system.treated().condensed.row.size()),
      part_(compliance_.size()),
      held_(compliance_.size()) {}

void CondensedRows::assemble(const MatrixValues& values, std::span<double> matrix) {
  const FilledRows& rows = system_.treated().condensed;
  std::size_t place = 0;
  for (std::size_t k = 0; k < rows.row.size(); ++k) {
    const Index row = rows.row[k];
    const double weight = 1 / values.compliance(system_, system_.row_data().own_compliance[at(row)]);
    compliance_[k] = 1 / weight;
    held_[k] = values.held(row);
    place = jacobian_.add_square(row, held(k) ? 0 : weight, rows.place, place, matrix);
  }
}

void CondensedRows::reduce(std::span<const double> row_rhs, std::span<double> rhs) {
  const auto& rows = system_.treated().condensed.row;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (held(k)) continue;
    part_[k] = row_rhs[at(rows[k])] / compliance_[k];
    jacobian_.add_force(rows[k], part_[k], rhs);
  }
  // A rank has all rows of its own nodes.
  if (system_.shares() && !rows.empty()) system_.shares()->gather_unknowns(rhs);
}

void CondensedRows::recover(std::span<const double> row_rhs, std::span<const double> solution,
                            std::span<double> dlambda) const {
  const auto& rows = system_.treated().condensed.row;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const std::size_t r = at(rows[k]);
    // Of a row held at a bound -D dl = g is left, D its metric, as of a kept one.
    dlambda[r] = held(k) ? -row_rhs[r] / system_.row_metric()[r]
                         : jacobian_.dot(rows[k], solution) / compliance_[k] - part_[k];
  }
  if (system_.shares() && !rows.empty()) system_.shares()->gather_rows(dlambda);
}

}  // namespace isochor
