// The saddle-point matrix as an operator: stiffness in blocks of nodes, rows and their compliance beside it.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "engine/solvers/front/block_matrix.h"
#include "engine/solvers/linear_solver.h"

namespace isochor {

// [K G^T; G -C] with nodes padded to three coordinates. A vector is 3 nodes() displacements, then rows().
class SaddleMatrix {
 public:
  // `geometry` may be empty: then unknowns that share a group of the pattern, three at most, are a node.
  // Leaves out the values, and the stiffness, which stiffness_pattern() hands over.
  void analyze(const SymmetricPattern& pattern, std::span<const UnknownGeometry> geometry);
  BlockMatrix take_stiffness_pattern() { return std::move(stiffness_pattern_); }
  // Spreads values of the pattern; those of the stiffness go to `stiffness`.
  void set_values(std::span<const double> values, BlockMatrix& stiffness);

  Index nodes() const { return nodes_; }
  Index rows() const { return rows_; }
  std::size_t size() const { return 3 * at(nodes_) + at(rows_); }
  // Place of an unknown in a vector.
  std::span<const Index> place() const { return place_; }

  void multiply(const RowLoop& loop, const BlockMatrix& stiffness, std::span<const double> x,
                std::span<double> y) const;
  // displacements += factor G^T multipliers.
  void add_row_forces(const RowLoop& loop, double factor, std::span<const double> multipliers,
                      std::span<double> displacements) const;
  double compliance_diagonal(Index row) const { return row_diagonal_[at(row)]; }
  Index row_nodes(Index row) const {
    return static_cast<Index>(row_start_[at(row) + 1] - row_start_[at(row)]);
  }
  // Calls visit(node, the three numbers of the gradient) for the nodes of a row, and visit(row, numbers) for
  // the rows of a node; both ascending.
  template <class Visit>
  void for_gradient(Index row, const Visit& visit) const {
    for (auto e = static_cast<std::size_t>(row_start_[at(row)]);
         e < static_cast<std::size_t>(row_start_[at(row) + 1]); ++e)
      visit(row_node_[e], gradient_.data() + 3 * e);
  }
  template <class Visit>
  void for_rows_of(Index node, const Visit& visit) const {
    for (auto e = static_cast<std::size_t>(node_start_[at(node)]);
         e < static_cast<std::size_t>(node_start_[at(node) + 1]); ++e)
      visit(node_row_[e], gradient_.data() + 3 * node_block_[e]);
  }
  // Calls visit(column, entry) for what a row has of the lower right block, with the sign of the matrix.
  template <class Visit>
  void for_compliance(Index row, const Visit& visit) const {
    for (auto e = static_cast<std::size_t>(compliance_start_[at(row)]);
         e < static_cast<std::size_t>(compliance_start_[at(row) + 1]); ++e)
      visit(compliance_column_[e], compliance_[e]);
  }
  // The gradient of a row, over the displacements.
  void row_gradient(Index row, std::span<double> displacements) const;
  std::size_t bytes() const;

 private:
  void number_nodes(const SymmetricPattern& pattern, std::span<const UnknownGeometry> geometry);

  Index nodes_ = 0, rows_ = 0;
  std::vector<Index> place_;
  BlockMatrix stiffness_pattern_;
  // Where the value of each entry goes: its own place, and that of its mirror image (-1: none). Which of the
  // three parts it belongs to follows from the unknowns.
  std::vector<std::int64_t> slot_, mirror_;
  std::vector<std::uint8_t> part_;  // 0 stiffness, 1 gradient, 2 compliance
  // Gradients: blocks of three by row, and the same blocks by node.
  std::vector<std::int64_t> row_start_, node_start_, node_block_;
  std::vector<Index> row_node_, node_row_;
  std::vector<double> gradient_;
  // Compliance, both triangles, with the sign of the matrix.
  std::vector<std::int64_t> compliance_start_;
  std::vector<Index> compliance_column_;
  std::vector<double> compliance_, row_diagonal_;
  std::vector<std::int64_t> compliance_diagonal_;
};

}  // namespace isochor
