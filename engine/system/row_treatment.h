// Sorts the rows of a system by how the linear systems take them.
#pragma once

#include "engine/system/system.h"

namespace isochor {

inline constexpr std::size_t local_row_nodes = 256;  // a row over more nodes does not count as local
inline constexpr Index most_bordered_rows = 64;      // of a scene: each costs a solve a factorization

class RowTreatments {
 public:
  explicit RowTreatments(System& system) : system_(system) {}

  // Fills the lists of rows of the system, whose compliance and Jacobian places are known. Fails with a
  // message where a pool asks for a treatment that does not fit its rows.
  Result<void> sort();

 private:
  Result<void> check_wish(const RowPool& pool) const;
  RowTreatment choose(const RowPool& pool) const;
  void collect_compliance();
  bool couples(const RowPool& pool) const;
  bool few_wide_rows(const RowPool& pool) const;
  Index index_of(const RowPool& pool) const;
  std::size_t nodes_of_row(Index row) const;
  std::vector<Index>& list_of(RowTreatment treatment);
  static Result<void> check_condensed(const RowPool& pool, const std::string& who);

  System& system_;
};

}  // namespace isochor
