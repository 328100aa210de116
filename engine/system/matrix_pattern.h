// The pattern of the matrix of a system, and where its blocks and rows go in it.
#pragma once

#include "engine/system/system.h"

namespace isochor {

class MatrixPattern {
 public:
  // `system`: whose unknowns, gather lists and treated rows are known; `tables`: its own, to be filled.
  MatrixPattern(const System& system, SystemTables& tables) : system_(system), tables_(tables) {}

  // Entries, then the place of each contribution among them, then the groups of unknowns that orderings see.
  void build();

 private:
  // Unknowns ascend with nodes and then with rows, so columns come out sorted without a look at their
  // entries.
  void list_entries();
  void locate_entries();
  // The unknowns of a node share a group; a local row joins the node that most of its stencils have in
  // common, so that the ordering sees one vertex a node. Rows over large parts of a body stay apart.
  void group_unknowns();
  std::int64_t place(Index row, Index col) const;
  template <class Visit>
  void for_filled_blocks(const FilledRows& rows, Visit visit) const;

  // Without ranks this one has everything.
  bool owns(Index node) const { return !tables_.shares || tables_.shares->owns(node); }
  bool owns_row(Index row) const { return !tables_.shares || tables_.shares->owns_row(row); }

  const System& system_;
  SystemTables& tables_;
};

}  // namespace isochor
