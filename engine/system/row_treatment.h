// Sorts the rows of a system by how the linear systems take them.
#pragma once

#include "engine/system/system.h"

namespace isochor {

inline constexpr std::size_t local_row_nodes = 256;  // a row over more nodes does not count as local
inline constexpr Index most_bordered_rows = 64;      // of a scene: each costs a solve a factorization

class RowTreatments {
 public:
  // `system`: whose compliance and Jacobian places are known; `rows`: to be filled.
  RowTreatments(const System& system, TreatedRows& rows) : system_(system), rows_(rows) {}

  // Fails with a message where a pool asks for a treatment that does not fit its rows.
  Result<void> sort();

 private:
  Result<void> check_wish(const RowPool& pool) const;
  RowTreatment choose(const RowPool& pool) const;
  void collect_compliance();
  bool over_several_stencils(const RowPool& pool) const;
  bool couples(const RowPool& pool) const;
  bool few_wide_rows(const RowPool& pool) const;
  Index index_of(const RowPool& pool) const;
  std::size_t nodes_of_row(Index row) const;
  std::vector<Index>& list_of(RowTreatment treatment);
  static Result<void> check_condensed(const RowPool& pool, const std::string& who);

  const System& system_;
  TreatedRows& rows_;
};

}  // namespace isochor
