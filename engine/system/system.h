// The compiled, immutable form of a scene: what the stepper reads. It holds only what the scene calls for.
#pragma once

#include "engine/solvers/linear_solver.h"
#include "engine/system/system_facets.h"

namespace isochor {

// What an author's scene hands over to compile().
struct SystemParts {
  std::vector<Vec3> rest;    // [m]
  std::vector<double> mass;  // lumped, one a node [kg]
  // What makes the mass matrix consistent: added to the lumped one. Empty: it stays lumped.
  std::vector<MassEntry> mass_entries;
  std::vector<std::shared_ptr<const StencilPool>> stencil_pools;
  std::vector<std::shared_ptr<const RowPool>> row_pools;
  std::vector<std::shared_ptr<const Prescriber>> prescribers;
  std::vector<std::shared_ptr<const LoadPool>> loads;
  // How rows are treated whose pools leave it to us; where it does not fit, the closest that does.
  RowTreatment treatment = RowTreatment::automatic;
  bool border_wide_rows = true;  // rather than dual, where `treatment` is dual
  // Of a system whose stencils are renewed: made with the first one, for those that replace it.
  std::shared_ptr<OrderingBase> ordering_base;
};

// Where a pool's slots begin in the arrays over all pools.
struct PoolPlace {
  Index energy = 0;
  std::int64_t function = 0, gradient = 0, jacobian = 0, hessian = 0;
};

// For every destination the sources that add up to it, in fixed order.
struct Gather {
  std::vector<std::int64_t> offset{0};
  std::vector<std::int64_t> source;
  std::vector<double> weight;  // empty: all 1

  std::int64_t count() const { return static_cast<std::int64_t>(offset.size()) - 1; }
};

// A node that is not free in all directions.
struct FreeBasis {
  int count = 3;    // free directions
  Mat3 directions;  // columns 0..count-1 are the free directions, the others the given ones
};

class System {
 public:
  // Builds patterns and gather lists. Fails with a message when parts contradict each other.
  static Result<std::shared_ptr<const System>> compile(SystemParts parts);

  const SystemParts& parts() const { return parts_; }
  Index nodes() const { return static_cast<Index>(parts_.rest.size()); }
  Index free_unknowns() const { return first_unknown_.back(); }
  Index rows() const { return rows_; }                        // compliant: unknowns of the system
  Index prescribed_rows() const { return prescribed_rows_; }  // their multipliers are data
  // Compliant rows without compliance that no free coordinate enters: given a compliance of their own.
  std::span<const Index> idle_rows() const { return idle_rows_; }
  std::uint64_t layout() const { return layout_; }
  double length() const { return length_; }  // diagonal of the rest bounding box [m]

  // Rows by treatment. Kept rows are unknowns of kkt(), in order behind the displacements; row_unknown() is
  // their index there, -1 for the others.
  std::span<const Index> row_unknown() const { return row_unknown_; }
  std::span<const Index> kept_rows() const { return kept_rows_; }
  std::span<const Index> condensed_rows() const { return condensed_rows_; }
  std::span<const Index> bordered_rows() const { return bordered_rows_; }
  std::span<const Index> dual_rows() const { return dual_rows_; }
  // Rows that add blocks to the stiffness: the condensed ones, then the augmented ones (which are dual too).
  std::span<const Index> filled_rows() const { return filled_rows_; }
  // compliance() entries between dual rows.
  std::span<const std::size_t> dual_compliance() const { return dual_compliance_; }
  // jacobian_ends() of row r: [row_jacobian_begin()[r], row_jacobian_begin()[r + 1]).
  std::span<const std::size_t> row_jacobian_begin() const { return row_jacobian_begin_; }
  // Where the columns of the blocks of filled_rows() go, in the order of rows and of their pairs of nodes.
  std::span<const std::int64_t> filled_place() const { return filled_place_; }
  // compliance() entry of each row's own diagonal, and the entries between bordered rows.
  std::span<const std::size_t> diagonal_compliance() const { return diagonal_compliance_; }
  struct BorderCompliance {
    std::size_t entry = 0;
    Index row = 0, col = 0;  // into bordered_rows()
  };
  std::span<const BorderCompliance> border_compliance() const { return border_compliance_; }

  const SymmetricPattern& kkt() const { return kkt_; }
  std::span<const PoolPlace> places() const { return places_; }
  const PoolPlace& totals() const { return totals_; }
  std::span<const Index> first_unknown() const { return first_unknown_; }
  // Index into free_bases() or -1 for a node that is free in all directions.
  std::span<const Index> basis_of() const { return basis_of_; }
  std::span<const FreeBasis> free_bases() const { return bases_; }

  // Rows of all compliant pools, then of all prescribed ones, share this numbering of the gather lists.
  const Gather& row_gather() const { return row_gather_; }            // row <- function slots
  const Gather& function_gather() const { return function_gather_; }  // function <- rows
  const Gather& residual_gather() const { return residual_gather_; }  // node <- gradient slots
  const Gather& block_gather() const { return block_gather_; }  // node pair <- Hessian slots, ~s: transposed
  const Gather& jacobian_gather() const { return jacobian_gather_; }  // (row, node) <- Jacobian slots

  // Places in kkt() of the first row of each column of a block; three a block, -1 beyond the free columns,
  // and for rows that are not kept.
  std::span<const std::int64_t> block_place() const { return block_place_; }
  std::span<const std::int64_t> jacobian_place() const { return jacobian_place_; }
  std::span<const std::array<Index, 2>> block_nodes() const { return block_nodes_; }
  // Mass of each block beside the lumped one [kg]; empty when the mass is lumped.
  std::span<const double> block_mass() const { return block_mass_; }
  std::span<const std::array<Index, 2>> jacobian_ends() const { return jacobian_ends_; }  // row, node

  std::span<const ComplianceEntry> compliance() const { return compliance_; }  // system rows
  std::span<const std::int64_t> compliance_place() const { return compliance_place_; }
  // Row pools with a law of their own, and where their compliance entries begin in compliance().
  struct LawPlace {
    Index row_pool = 0;
    std::size_t first_entry = 0;
  };
  std::span<const LawPlace> laws() const { return laws_; }
  // LawRows::evaluate_law() of one of them, from the multipliers of all compliant rows and the memory of all
  // pools; `strain` and `tangent` are those of the pool.
  double evaluate_law(const LawPlace& place, double t0, double t1, std::span<const double> memory,
                      std::span<const double> lambda, std::span<double> strain,
                      std::span<double> tangent) const;
  // Bounds on the multipliers of all compliant rows; empty when no row has any.
  std::span<const double> row_lower() const { return row_lower_; }
  std::span<const double> row_upper() const { return row_upper_; }
  bool has_bounds() const { return !row_lower_.empty(); }
  // RowPool::largest_overshoot of all compliant rows; empty when all are infinite.
  std::span<const double> row_overshoot() const { return row_overshoot_; }
  const SystemFacets& facets() const { return facets_; }
  // Numbers that row and stencil pools keep between steps: all, and those of a pool among them.
  Index memory() const { return static_cast<Index>(facets_.memory); }
  template <class T>
  std::span<T> row_memory(Index row_pool, std::span<T> all) const {
    return part_of(facets_.remembering_rows, row_pool, all);
  }
  template <class T>
  std::span<T> stencil_memory(Index stencil_pool, std::span<T> all) const {
    return part_of(facets_.remembering, stencil_pool, all);
  }
  // As a scene begins.
  void start_memory(std::span<double> memory) const;
  // Some stencils hold on to positions and multipliers within an iteration; nodes could pass through some.
  bool has_lag() const { return !facets_.lagged.empty(); }
  bool couples() const { return facets_.coupled; }
  bool has_barrier() const { return !facets_.barriers.empty(); }
  bool renews_stencils() const { return !facets_.renewed.empty(); }
  std::span<const double> row_metric() const { return row_metric_; }
  std::span<const double> row_measure() const { return row_measure_; }
  std::span<const std::int64_t> diagonal_place() const { return diagonal_place_; }

  // First row of a row pool in its numbering: compliant rows, or prescribed rows.
  Index first_row(Index row_pool) const { return first_row_[at(row_pool)]; }
  bool has_prescribers() const { return !parts_.prescribers.empty(); }

 private:
  template <class List, class T>
  static std::span<T> part_of(const List& remembering, Index pool, std::span<T> all) {
    for (const auto& r : remembering) {
      if (r.pool == pool) return r.in(all);
    }
    return {};
  }

  friend class SystemCompiler;
  friend class RowTreatments;
  SystemParts parts_;
  Index rows_ = 0, prescribed_rows_ = 0;
  std::uint64_t layout_ = 0;
  double length_ = 0;
  SymmetricPattern kkt_;
  std::vector<PoolPlace> places_;
  PoolPlace totals_;
  std::vector<Index> first_unknown_, basis_of_, first_row_;
  std::vector<FreeBasis> bases_;
  Gather row_gather_, function_gather_, residual_gather_, block_gather_, jacobian_gather_;
  std::vector<std::int64_t> block_place_, jacobian_place_, compliance_place_, diagonal_place_;
  std::vector<std::array<Index, 2>> block_nodes_, jacobian_ends_;
  std::vector<ComplianceEntry> compliance_;
  std::vector<double> block_mass_, row_metric_, row_measure_, row_lower_, row_upper_, row_overshoot_;
  std::vector<LawPlace> laws_;
  std::vector<Index> idle_rows_;
  std::vector<Index> row_unknown_, kept_rows_, condensed_rows_, bordered_rows_, dual_rows_, filled_rows_;
  std::vector<std::size_t> row_jacobian_begin_, diagonal_compliance_, dual_compliance_;
  std::vector<std::int64_t> filled_place_;
  std::vector<BorderCompliance> border_compliance_;
  SystemFacets facets_;
};

}  // namespace isochor
