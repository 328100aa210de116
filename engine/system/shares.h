// Who has what of a system that several processes solve together.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "engine/base/base.h"
#include "isochor/ranks.h"

namespace isochor {

// Every node, unknown and row has an owner, and all ranks know it. A rank evaluates the stencils that touch a
// node of its own, so that what falls on its nodes is whole and was added up in the order of one process;
// then owners hand over what all need.
class Shares {
 public:
  Shares(std::shared_ptr<const Ranks> ranks, std::vector<Index> node_owner);
  // Unknowns of the matrix: those of the nodes, `first` as NodeUnknowns::first.
  void share_unknowns(std::span<const Index> first);
  void share_rows(std::vector<Index> row_owner);

  const Ranks& ranks() const { return *ranks_; }
  Index rank() const { return rank_; }
  bool owns(Index node) const { return nodes_.owner[at(node)] == rank_; }
  bool owns_row(Index row) const { return rows_.owner[at(row)] == rank_; }
  Index owner(Index node) const { return nodes_.owner[at(node)]; }
  Index row_owner(Index row) const { return rows_.owner[at(row)]; }
  // Of this rank, ascending.
  std::span<const Index> own_nodes() const { return nodes_.of(rank_); }

  void sum(std::span<double> values) const { ranks_->sum(values); }
  // From what is right at owners to what is right everywhere.
  void gather_nodes(std::span<Vec3> values) const;
  void gather_nodes(std::span<double> values, std::size_t numbers_a_node = 1) const;
  void gather_unknowns(std::span<double> values) const;  // of nodes
  void gather_rows(std::span<double> values) const;      // all compliant rows

  // Rows whose Jacobian vectors are summed over the ranks: wide ones, of which each has a part.
  std::vector<Index> summed_rows;

  std::size_t bytes() const;

 private:
  struct Plan {
    std::vector<Index> owner, item;   // item: by owner, ascending
    std::vector<std::int64_t> begin;  // into item, one a rank and the end
    std::span<const Index> of(Index rank) const;
  };
  Plan plan(std::vector<Index> owner) const;
  void gather(const Plan& plan, double* values, std::size_t numbers) const;

  std::shared_ptr<const Ranks> ranks_;
  Index rank_ = 0;
  Plan nodes_, unknowns_, rows_;
};

}  // namespace isochor
