#include "engine/system/matrix_pattern.h"

#include <algorithm>

#include "engine/system/gather_lists.h"
#include "engine/system/row_treatment.h"

namespace isochor {

void MatrixPattern::build() {
  list_entries();
  locate_entries();
  if (!tables_.shares) group_unknowns();
}

// Visits all blocks that rows add to the stiffness. Nodes of a row ascend, so the blocks (i, j) are those
// of the lower triangle.
template <class Visit>
void MatrixPattern::for_filled_blocks(const FilledRows& rows, Visit visit) const {
  for (const Index row : rows.row) {
    const auto begin = tables_.gathers.row_begin[at(row)], end = tables_.gathers.row_begin[at(row) + 1];
    for (auto a = begin; a < end; ++a) {
      for (auto b = begin; b <= a; ++b)
        visit(tables_.gathers.jacobian_ends[a][1], tables_.gathers.jacobian_ends[b][1]);
    }
  }
}

void MatrixPattern::list_entries() {
  const auto& unknown = tables_.treated.unknown;
  std::vector<std::uint64_t> blocks, row_entries, compliance_entries;  // keys: column, row
  for (const auto& [i, j] : tables_.gathers.block_ends) blocks.push_back(key_of(j, i));
  for (const FilledRows* rows : {&tables_.treated.condensed, &tables_.treated.augmented}) {
    for_filled_blocks(*rows, [&](Index i, Index j) {
      if (owns(i)) blocks.push_back(key_of(j, i));
    });
  }
  for (const auto& [row, node] : tables_.gathers.jacobian_ends) {
    if (unknown[at(row)] >= 0 && owns(node)) row_entries.push_back(key_of(node, unknown[at(row)]));
  }
  for (const ComplianceEntry& e : system_.row_data().compliance) {
    if (unknown[at(e.row)] >= 0 && owns_row(e.row))
      compliance_entries.push_back(key_of(unknown[at(e.col)], unknown[at(e.row)]));
  }
  for (auto* keys : {&blocks, &row_entries, &compliance_entries}) {
    sort_by_destination(*keys);
    keys->erase(std::unique(keys->begin(), keys->end()), keys->end());
  }
  SymmetricPattern& kkt = tables_.matrix.pattern;
  const auto& first = tables_.unknowns.first;
  kkt.size = system_.free_unknowns() + static_cast<Index>(tables_.treated.kept.size());
  kkt.row.reserve(9 * blocks.size() + 3 * row_entries.size() + compliance_entries.size());
  kkt.column_start = {0};
  const auto end_of = [](const std::vector<std::uint64_t>& keys, std::size_t from, Index column) {
    while (from < keys.size() && static_cast<Index>(keys[from] >> 32) == column) ++from;
    return from;
  };
  const auto row_of = [](std::uint64_t key) { return static_cast<Index>(key & 0xffffffffu); };
  const auto end_column = [&] { kkt.column_start.push_back(static_cast<std::int64_t>(kkt.row.size())); };
  std::size_t block = 0, entry = 0;
  for (Index j = 0; j < system_.nodes(); ++j) {
    const std::size_t end_of_blocks = end_of(blocks, block, j),
                      end_of_entries = end_of(row_entries, entry, j);
    for (Index c = first[at(j)]; c < first[at(j) + 1]; ++c) {
      for (std::size_t k = block; k < end_of_blocks; ++k) {
        const Index i = row_of(blocks[k]);
        for (Index r = i == j ? c : first[at(i)]; r < first[at(i) + 1]; ++r) kkt.row.push_back(r);
      }
      for (std::size_t k = entry; k < end_of_entries; ++k) kkt.row.push_back(row_of(row_entries[k]));
      end_column();
    }
    block = end_of_blocks;
    entry = end_of_entries;
  }
  entry = 0;
  for (Index u = system_.free_unknowns(); u < kkt.size; ++u) {
    for (const std::size_t end = end_of(compliance_entries, entry, u); entry < end; ++entry)
      kkt.row.push_back(row_of(compliance_entries[entry]));
    end_column();
  }
}

std::int64_t MatrixPattern::place(Index row, Index col) const {
  const auto& kkt = tables_.matrix.pattern;
  const auto begin = kkt.row.begin() + kkt.column_start[at(col)];
  const auto end = kkt.row.begin() + kkt.column_start[at(col) + 1];
  return std::lower_bound(begin, end, row) - kkt.row.begin();
}

void MatrixPattern::locate_entries() {
  const auto& first = tables_.unknowns.first;
  const auto locate = [&](std::vector<std::int64_t>& places, Index row_or_node, Index node, bool is_row) {
    for (Index k = 0; k < 3; ++k) {
      const Index c = first[at(node)] + k;
      if (c >= first[at(node) + 1]) {
        places.push_back(-1);
      } else if (is_row) {
        const Index u = tables_.treated.unknown[at(row_or_node)];
        places.push_back(u < 0 || !owns(node) ? -1 : place(u, c));
      } else if (row_or_node == node) {
        places.push_back(place(c, c));
      } else {
        places.push_back(
            first[at(row_or_node)] < first[at(row_or_node) + 1] ? place(first[at(row_or_node)], c) : -1);
      }
    }
  };
  for (const auto& [i, j] : tables_.gathers.block_ends) locate(tables_.matrix.block, i, j, false);
  for (const auto& [row, node] : tables_.gathers.jacobian_ends)
    locate(tables_.matrix.jacobian, row, node, true);
  for (const ComplianceEntry& e : system_.row_data().compliance) {
    const Index row = tables_.treated.unknown[at(e.row)], col = tables_.treated.unknown[at(e.col)];
    tables_.matrix.compliance.push_back(row < 0 || !owns_row(e.row) ? -1 : place(row, col));
  }
  for (FilledRows* rows : {&tables_.treated.condensed, &tables_.treated.augmented}) {
    for_filled_blocks(*rows, [&](Index i, Index j) {
      for (Index c = first[at(j)]; c < first[at(j) + 1]; ++c) {
        const Index from = i == j ? c : first[at(i)];
        rows->place.push_back(owns(i) && from < first[at(i) + 1] ? place(from, c) : -1);
      }
    });
  }
  const auto& owner = tables_.matrix.pattern.owner;
  for (Index i = 0; i < tables_.matrix.pattern.size; ++i) {
    const bool here = owner.empty() || owner[at(i)] == tables_.shares->rank();
    tables_.matrix.diagonal.push_back(here ? tables_.matrix.pattern.column_start[at(i)] : -1);
  }
}

void MatrixPattern::group_unknowns() {
  SymmetricPattern& kkt = tables_.matrix.pattern;
  kkt.group.assign(at(kkt.size), -1);
  Index groups = 0;
  std::vector<Index> group_of_node(at(system_.nodes()), -1);
  for (Index i = 0; i < system_.nodes(); ++i) {
    for (Index c = tables_.unknowns.first[at(i)]; c < tables_.unknowns.first[at(i) + 1]; ++c) {
      if (group_of_node[at(i)] < 0) group_of_node[at(i)] = groups++;
      kkt.group[at(c)] = group_of_node[at(i)];
    }
  }
  std::vector<Index> rows_in(at(groups), 0);
  std::size_t e = 0;
  for (Index r = 0; r < system_.row_data().compliant; ++r) {
    const std::size_t begin = e;
    while (e < tables_.gathers.jacobian_ends.size() && tables_.gathers.jacobian_ends[e][0] == r) ++e;
    if (tables_.treated.unknown[at(r)] < 0) continue;
    Index best = -1;
    std::int64_t best_count = 0;
    if (e - begin <= local_row_nodes) {
      for (std::size_t k = begin; k < e; ++k) {
        const Index g = group_of_node[at(tables_.gathers.jacobian_ends[k][1])];
        if (g < 0) continue;
        const std::int64_t count =
            tables_.gathers.jacobian.offset[k + 1] - tables_.gathers.jacobian.offset[k];
        if (best < 0 || count > best_count || (count == best_count && rows_in[at(g)] < rows_in[at(best)])) {
          best = g;
          best_count = count;
        }
      }
    }
    if (best < 0) {
      best = groups++;
      rows_in.push_back(0);
    }
    ++rows_in[at(best)];
    kkt.group[at(tables_.treated.unknown[at(r)])] = best;
  }
  kkt.groups = groups;
}

}  // namespace isochor
