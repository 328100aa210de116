// The compiled, immutable form of a scene: what the stepper reads. It holds only what the scene calls for.
//
// It is made of parts, each a plain struct that compile() fills and nothing changes afterwards:
//
//   SystemTables   what follows from who is where, whatever the numbers; systems of one structure share them
//     NodeUnknowns   which unknowns nodes have
//     Gathers        what adds up to rows, functions, residuals, blocks of the stiffness and Jacobian vectors
//     TreatedRows    which rows the linear systems keep, condense, border or leave to a dual iteration
//     MatrixPlaces   the pattern of the saddle-point matrix, and where everything goes in it
//     PoolPlaces     where pools have their slots
//     Shares         who has what, where several processes solve it together
//   RowData        compliant rows: metric, measure, bounds, compliance, laws
//   SystemFacets   what few pools are, and what pools keep between steps
#pragma once

#include "engine/solvers/linear_solver.h"
#include "engine/system/shares.h"
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
  // Processes that it is shared out over; null: this one alone.
  std::shared_ptr<const Ranks> ranks;
  // Of a system whose stencils are renewed: made with the first one, for those that replace it.
  std::shared_ptr<OrderingBase> ordering_base;
};

// A node that is not free in all directions.
struct FreeBasis {
  int count = 3;    // free directions
  Mat3 directions;  // columns 0..count-1 are the free directions, the others the given ones
};

struct NodeUnknowns {
  std::vector<Index> first;     // unknown of each node, and the end: nodes + 1 entries
  std::vector<Index> basis_of;  // index into bases; -1: free in all directions
  std::vector<FreeBasis> bases;

  Index begin(Index node) const { return first[at(node)]; }
  Index end(Index node) const { return first[at(node) + 1]; }
  Index of(Index node) const { return end(node) - begin(node); }  // how many
  // A force or a gradient of a node, in its free directions first.
  Vec3 to_free(Index node, const Vec3& v) const {
    const Index b = basis_of[at(node)];
    return b >= 0 ? transposed_times(bases[at(b)].directions, v) : v;
  }
  // The way back.
  Vec3 from_free(Index node, const Vec3& q) const {
    const Index b = basis_of[at(node)];
    return b >= 0 ? bases[at(b)].directions * q : q;
  }
};

// Row pools with a law of their own, and where their compliance entries begin in RowData::compliance.
struct LawPlace {
  Index row_pool = 0;
  std::size_t first_entry = 0;
};

struct RowData {
  Index compliant = 0;       // unknowns of the system
  Index prescribed = 0;      // their multipliers are data
  std::vector<Index> first;  // of each row pool in its numbering: compliant rows, or prescribed rows
  // Of compliant rows, one each.
  std::vector<double> metric, measure;
  std::vector<double> lower, upper;  // bounds on the multipliers; empty when no row has any
  std::vector<double> overshoot;     // RowPool::largest_overshoot; empty when all are infinite
  std::vector<ComplianceEntry> compliance;
  std::vector<std::size_t> own_compliance;  // the entry of each row's own diagonal
  std::vector<LawPlace> laws;
  // Rows without compliance that no free coordinate enters: given a compliance of their own.
  std::vector<Index> idle;
};

// For every destination the sources that add up to it, in fixed order.
struct Gather {
  std::vector<std::int64_t> offset{0};
  std::vector<std::int64_t> source;
  std::vector<double> weight;  // empty: all 1

  std::int64_t count() const { return static_cast<std::int64_t>(offset.size()) - 1; }
};

// Rows of all compliant pools, then of all prescribed ones, share one numbering here.
struct Gathers {
  Gather row;                                       // row <- function slots
  Gather function;                                  // function <- rows
  Gather residual;                                  // node <- gradient slots
  Gather block;                                     // node pair <- Hessian slots, ~s: transposed
  Gather jacobian;                                  // (row, node) <- Jacobian slots
  std::vector<std::array<Index, 2>> block_ends;     // the larger node of a pair first
  std::vector<std::array<Index, 2>> jacobian_ends;  // row, node; by rows
  std::vector<std::size_t> row_begin;  // jacobian_ends of compliant row r begin at [r], end at [r + 1]
};

// Rows that add G_r^T w_r G_r to the stiffness, and where in the matrix the columns of their blocks go, in
// the order of rows and of their pairs of nodes (-1: nowhere).
struct FilledRows {
  std::vector<Index> row;
  std::vector<std::int64_t> place;
};

struct TreatedRows {
  // Unknowns of the matrix, in this order behind the displacements; `unknown` is a row's index there, -1 for
  // those of other treatments.
  std::vector<Index> kept, unknown;
  FilledRows condensed;
  std::vector<Index> bordered;
  struct BorderEntry {
    std::size_t entry = 0;   // of RowData::compliance
    Index row = 0, col = 0;  // into `bordered`
  };
  std::vector<BorderEntry> border_compliance;
  // Dual rows, the entries of RowData::compliance between them, and those of them that are local: they may
  // augment the stiffness.
  std::vector<Index> dual;
  std::vector<std::size_t> dual_compliance;
  FilledRows augmented;

  bool fill() const { return !condensed.row.empty() || !augmented.row.empty(); }
};

struct MatrixPlaces {
  SymmetricPattern pattern;
  // Of the first row of each column of a block or of a Jacobian vector: three each, -1 beyond the free
  // columns and for rows that are not kept.
  std::vector<std::int64_t> block, jacobian;
  std::vector<std::int64_t> compliance;  // one an entry of RowData::compliance, -1 for rows that are not kept
  std::vector<std::int64_t> diagonal;    // of each unknown, -1 for those of other ranks
};

// Where a pool's slots begin in the arrays over all pools.
struct PoolPlace {
  Index energy = 0;
  std::int64_t function = 0, gradient = 0, jacobian = 0, hessian = 0;
};

// Stencils [begin, end) of a pool that are evaluated here; runs of a pool ascend. Without ranks a pool is one
// run. Energies and functions have a place for every stencil; vectors and blocks for those that are
// evaluated, and the slots of stencil s begin at gradient + nodes().offset[s], jacobian + functions *
// offset[s] and hessian + hessian_offset()[s]: shifts, which may be negative.
struct StencilRun {
  Index begin = 0, end = 0;
  bool own = true;  // this rank answers for their energies and functions
  std::int64_t gradient = 0, jacobian = 0, hessian = 0;
};

struct PoolPlaces {
  std::vector<PoolPlace> slots;  // of each stencil pool
  PoolPlace total;
  std::vector<std::vector<StencilRun>> runs;  // of each stencil pool

  // The run of a stencil; null where others evaluate it.
  const StencilRun* run_of(Index pool, Index stencil) const;
};

struct SystemTables {
  NodeUnknowns unknowns;
  Gathers gathers;
  TreatedRows treated;
  MatrixPlaces matrix;
  PoolPlaces pools;
  std::unique_ptr<Shares> shares;  // null: this process has all
  std::uint64_t layout = 0;        // a number for all of it
};

class System {
 public:
  // Builds patterns and gather lists, or takes those of `like` where the parts have the same structure. Fails
  // with a message when parts contradict each other.
  static Result<std::shared_ptr<System>> compile(SystemParts parts, const System* like = nullptr);

  const SystemParts& parts() const { return parts_; }
  const NodeUnknowns& unknowns() const { return tables_->unknowns; }
  const RowData& row_data() const { return row_data_; }
  const Gathers& gathers() const { return tables_->gathers; }
  const TreatedRows& treated() const { return tables_->treated; }
  const MatrixPlaces& matrix() const { return tables_->matrix; }
  const PoolPlaces& pools() const { return tables_->pools; }
  const SystemFacets& facets() const { return facets_; }
  // Null: this process has all.
  const Shares* shares() const { return tables_->shares.get(); }
  std::size_t table_bytes() const;
  bool shares_tables(const System& other) const { return tables_ == other.tables_; }

  std::uint64_t layout() const { return tables_->layout; }
  double length() const { return length_; }  // diagonal of the rest bounding box [m]

  // What is asked of the parts most often.
  Index nodes() const { return static_cast<Index>(parts_.rest.size()); }
  Index free_unknowns() const { return unknowns().first.back(); }
  Index rows() const { return row_data_.compliant; }
  Index prescribed_rows() const { return row_data_.prescribed; }
  Index first_row(Index row_pool) const { return row_data_.first[at(row_pool)]; }
  const SymmetricPattern& kkt() const { return matrix().pattern; }
  bool has_bounds() const { return !row_data_.lower.empty(); }
  bool has_prescribers() const { return !parts_.prescribers.empty(); }
  std::span<const double> row_metric() const { return row_data_.metric; }
  std::span<const double> row_measure() const { return row_data_.measure; }
  std::span<const double> row_lower() const { return row_data_.lower; }
  std::span<const double> row_upper() const { return row_data_.upper; }
  std::span<const double> row_overshoot() const { return row_data_.overshoot; }
  std::span<const ComplianceEntry> compliance() const { return row_data_.compliance; }
  std::span<const LawPlace> laws() const { return row_data_.laws; }
  std::span<const Index> idle_rows() const { return row_data_.idle; }
  std::span<const Index> first_unknown() const { return unknowns().first; }
  std::span<const Index> basis_of() const { return unknowns().basis_of; }
  std::span<const FreeBasis> free_bases() const { return unknowns().bases; }
  bool has_lag() const { return !facets_.lagged.empty(); }
  bool couples() const { return facets_.coupled; }
  bool has_barrier() const { return !facets_.barriers.empty(); }
  bool renews_stencils() const { return !facets_.renewed.empty(); }
  std::span<const Index> row_unknown() const { return treated().unknown; }
  std::span<const Index> kept_rows() const { return treated().kept; }
  std::span<const Index> condensed_rows() const { return treated().condensed.row; }
  std::span<const Index> bordered_rows() const { return treated().bordered; }
  std::span<const Index> dual_rows() const { return treated().dual; }
  // What the mass matrix has beside the lumped masses [kg], one a block; empty when the mass is lumped.
  std::span<const double> block_mass() const { return block_mass_; }
  std::span<const std::array<Index, 2>> jacobian_ends() const { return gathers().jacobian_ends; }

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
  // LawRows::evaluate_law() of one of laws(), from the multipliers of all compliant rows and the memory of
  // all pools; `strain` and `tangent` are those of the pool.
  double evaluate_law(const LawPlace& place, double t0, double t1, std::span<const double> memory,
                      std::span<const double> lambda, std::span<double> strain,
                      std::span<double> tangent) const;

 private:
  template <class List, class T>
  static std::span<T> part_of(const List& remembering, Index pool, std::span<T> all) {
    for (const auto& r : remembering) {
      if (r.pool == pool) return r.in(all);
    }
    return {};
  }

  friend class SystemCompiler;
  SystemParts parts_;
  std::shared_ptr<const SystemTables> tables_;
  RowData row_data_;
  SystemFacets facets_;
  std::vector<double> block_mass_;
  double length_ = 0;
};

}  // namespace isochor
