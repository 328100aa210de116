#include "engine/solvers/two_level/coarse_matrix.h"

#include <algorithm>
#include <cmath>

namespace isochor {
namespace {

// Of the compliance between the ends of an edge. Anything from a half to 6 takes the same iterations within a
// tenth; a fifth takes half as many again.
constexpr double compliance_factor = 1;

// block += w_i^T k w_j, w the parts that two nodes take of two corners.
void add_product(const Prolongation::Part& pi, const double* k, const Prolongation::Part& pj, double* block) {
  if (pi.even && pj.even) {
    const double f = pi.factor * pj.factor;
    for (int e = 0; e < 9; ++e) block[e] += f * k[e];
    return;
  }
  const auto whole = [](const Prolongation::Part& p) {
    return p.even ? std::array<double, 9>{p.factor, 0, 0, 0, p.factor, 0, 0, 0, p.factor} : p.block;
  };
  const auto wi = whole(pi), wj = whole(pj);
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c) {
      double sum = 0;
      for (std::size_t m = 0; m < 3; ++m) sum += k[3 * r + m] * wj[3 * m + c];
      for (std::size_t q = 0; q < 3; ++q) block[3 * q + c] += wi[3 * r + q] * sum;
    }
  }
}

// Sorts what was marked, remembers its places and clears the marks.
void take_marked(std::vector<Index>& marked, std::vector<Index>& mark, std::vector<Index>& to) {
  std::sort(marked.begin(), marked.end());
  for (std::size_t k = 0; k < marked.size(); ++k) mark[at(marked[k])] = static_cast<Index>(k);
  to.insert(to.end(), marked.begin(), marked.end());
}

}  // namespace

void CoarseMatrix::list_stiffness(const BlockMatrix& k) {
  stiffness_ = {};
  product_.clear();
  product_start_.assign(1, 0);
  std::vector<Index> mark(at(p_->corners()), -1), marked;
  const auto for_products = [&](Index a, const auto& visit) {
    for (const auto& pi : p_->of_corner(a)) {
      for (auto e = k.start[at(pi.node)]; e < k.start[at(pi.node) + 1]; ++e) {
        for (const Index part : p_->of_node(k.column[static_cast<std::size_t>(e)])) {
          if (part >= 0) visit(p_->part(part).corner);
        }
      }
    }
  };
  for (Index a = 0; a < p_->corners(); ++a) {
    marked.clear();
    for_products(a, [&](Index b) {
      if (b < a || mark[at(b)] >= 0) return;
      mark[at(b)] = 0;
      marked.push_back(b);
    });
    take_marked(marked, mark, stiffness_.other);
    for_products(a, [&](Index b) { product_.push_back(b < a ? -1 : mark[at(b)]); });
    for (const Index b : marked) mark[at(b)] = -1;
    stiffness_.start.push_back(static_cast<std::int64_t>(stiffness_.other.size()));
    product_start_.push_back(static_cast<std::int64_t>(product_.size()));
  }
  stiffness_.value.assign(9 * stiffness_.other.size(), 0);
}

void CoarseMatrix::list_gradients(const SaddleMatrix& matrix) {
  gradient_ = {};
  gradient_product_.clear();
  std::vector<Index> mark(at(p_->corners()), -1), marked;
  for (Index r = 0; r < rows_; ++r) {
    marked.clear();
    const auto for_corners = [&](const auto& visit) {
      matrix.for_gradient(r, [&](Index node, const double*) {
        for (const Index part : p_->of_node(node)) {
          if (part >= 0) visit(p_->part(part).corner);
        }
      });
    };
    for_corners([&](Index b) {
      if (mark[at(b)] >= 0) return;
      mark[at(b)] = 0;
      marked.push_back(b);
    });
    take_marked(marked, mark, gradient_.other);
    for_corners([&](Index b) { gradient_product_.push_back(mark[at(b)]); });
    for (const Index b : marked) mark[at(b)] = -1;
    gradient_.start.push_back(static_cast<std::int64_t>(gradient_.other.size()));
  }
  gradient_.value.assign(3 * gradient_.other.size(), 0);
}

void CoarseMatrix::list_compliance(const SymmetricPattern& fine, const SaddleMatrix& matrix) {
  // The row that shares a group with the unknowns of a node.
  std::vector<Index> row_of_group(at(fine.groups), -1), group_of(at(matrix.nodes()), -1);
  const Index displacements = 3 * matrix.nodes();
  for (std::size_t u = 0; u < fine.group.size(); ++u) {
    const Index place = matrix.place()[u];
    if (place < displacements)
      group_of[at(place / 3)] = fine.group[u];
    else if (Index& row = row_of_group[at(fine.group[u])]; row < 0)
      row = place - displacements;
  }
  edge_rows_.clear();
  std::vector<std::vector<Index>> below(at(rows_));
  for (Index i = 0; i < matrix.nodes() && !fine.group.empty(); ++i) {
    if (!p_->is_middle(i)) continue;
    const auto [a, b] = p_->edges().ends[at(i)];
    const Index ra = row_of_group[at(group_of[at(a)])], rb = row_of_group[at(group_of[at(b)])];
    if (ra < 0 || rb < 0) continue;
    edge_rows_.push_back({i, std::min(ra, rb), std::max(ra, rb)});
    below[at(std::min(ra, rb))].push_back(std::max(ra, rb));
  }
  compliance_ = {};
  compliance_diagonal_.clear();
  for (Index r = 0; r < rows_; ++r) {
    auto& list = below[at(r)];
    list.push_back(r);
    matrix.for_compliance(r, [&](Index c, double) {
      if (c > r) list.push_back(c);
    });
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    compliance_diagonal_.push_back(compliance_.start.back());  // the first of its column
    compliance_.other.insert(compliance_.other.end(), list.begin(), list.end());
    compliance_.start.push_back(static_cast<std::int64_t>(compliance_.other.size()));
  }
  compliance_.value.assign(compliance_.other.size(), 0);
  for (EdgeRows& e : edge_rows_) {
    const auto begin = compliance_.other.begin() + compliance_.start[at(e.first)],
               end = compliance_.other.begin() + compliance_.start[at(e.first) + 1];
    e.between = std::lower_bound(begin, end, e.second) - compliance_.other.begin();
  }
}

// The lower triangle by columns: of a corner its own blocks and those of later corners, then its rows.
void CoarseMatrix::build_pattern(const SymmetricPattern& fine, const SaddleMatrix& matrix) {
  SymmetricPattern& to = pattern_;
  to = {};
  to.size = p_->size();
  to.column_start = {0};
  stiffness_.place.assign(stiffness_.value.size(), -1);
  gradient_.place.assign(gradient_.value.size(), -1);
  compliance_.place.assign(compliance_.value.size(), -1);
  // Gradients by corner.
  std::vector<std::vector<std::array<std::int64_t, 2>>> rows_of(at(p_->corners()));
  for (Index r = 0; r < rows_; ++r) {
    for (auto e = gradient_.start[at(r)]; e < gradient_.start[at(r) + 1]; ++e)
      rows_of[at(gradient_.other[static_cast<std::size_t>(e)])].push_back({r, e});
  }
  const auto add = [&](Index row, std::int64_t& place) {
    place = static_cast<std::int64_t>(to.row.size());
    to.row.push_back(row);
  };
  for (Index a = 0; a < p_->corners(); ++a) {
    for (int i = 0; i < 3; ++i) {
      if (p_->coarse_unknown(a, i) < 0) continue;
      for (auto e = stiffness_.start[at(a)]; e < stiffness_.start[at(a) + 1]; ++e) {
        const Index b = stiffness_.other[static_cast<std::size_t>(e)];
        for (int j = a == b ? i : 0; j < 3; ++j) {
          if (const Index u = p_->coarse_unknown(b, j); u >= 0)
            add(u, stiffness_.place[static_cast<std::size_t>(9 * e + 3 * i + j)]);
        }
      }
      for (const auto& [r, e] : rows_of[at(a)])
        add(p_->displacements() + static_cast<Index>(r),
            gradient_.place[static_cast<std::size_t>(3 * e + i)]);
      to.column_start.push_back(static_cast<std::int64_t>(to.row.size()));
    }
  }
  for (Index r = 0; r < rows_; ++r) {
    for (auto e = compliance_.start[at(r)]; e < compliance_.start[at(r) + 1]; ++e)
      add(p_->displacements() + compliance_.other[static_cast<std::size_t>(e)],
          compliance_.place[static_cast<std::size_t>(e)]);
    to.column_start.push_back(static_cast<std::int64_t>(to.row.size()));
  }
  to.multiplier.assign(at(to.size), 0);
  std::fill(to.multiplier.begin() + p_->displacements(), to.multiplier.end(), std::uint8_t{1});
  // Groups as they were, without those of middles alone.
  to.group.assign(at(to.size), -1);
  std::vector<Index> renumbered(at(fine.groups), -1);
  const Index displacements = 3 * matrix.nodes();
  for (std::size_t u = 0; u < fine.group.size(); ++u) {
    const Index place = matrix.place()[u];
    Index coarse = p_->displacements() + place - displacements;
    if (place < displacements) {
      const Index corner = p_->corner_of(place / 3);
      if (corner < 0) continue;
      coarse = p_->coarse_unknown(corner, place % 3);
    }
    Index& group = renumbered[at(fine.group[u])];
    if (group < 0) group = to.groups++;
    to.group[at(coarse)] = group;
  }
  values_.assign(to.row.size(), 0);
}

void CoarseMatrix::analyze(const SymmetricPattern& fine, const SaddleMatrix& matrix,
                           const BlockMatrix& stiffness, const Prolongation& prolongation) {
  p_ = &prolongation;
  rows_ = matrix.rows();
  list_stiffness(stiffness);
  list_gradients(matrix);
  list_compliance(fine, matrix);
  build_pattern(fine, matrix);
}

void CoarseMatrix::project_stiffness(const RowLoop& loop, const BlockMatrix& k) {
  std::fill(stiffness_.value.begin(), stiffness_.value.end(), 0.0);
  loop(p_->corners(), 64, [&](Index begin, Index end) {
    for (Index a = begin; a < end; ++a) {
      double* const blocks = stiffness_.value.data() + 9 * stiffness_.start[at(a)];
      const Index* product = product_.data() + product_start_[at(a)];
      for (const auto& pi : p_->of_corner(a)) {
        for (auto e = k.start[at(pi.node)]; e < k.start[at(pi.node) + 1]; ++e) {
          for (const Index part : p_->of_node(k.column[static_cast<std::size_t>(e)])) {
            if (part < 0) continue;
            if (*product >= 0)
              add_product(pi, k.value.data() + 9 * e, p_->part(part), blocks + 9 * std::ptrdiff_t{*product});
            ++product;
          }
        }
      }
    }
  });
}

void CoarseMatrix::project_gradients(const SaddleMatrix& matrix) {
  std::fill(gradient_.value.begin(), gradient_.value.end(), 0.0);
  const Index* product = gradient_product_.data();
  for (Index r = 0; r < rows_; ++r) {
    double* const row = gradient_.value.data() + 3 * gradient_.start[at(r)];
    matrix.for_gradient(r, [&](Index node, const double* g) {
      for (const Index k : p_->of_node(node)) {
        if (k < 0) continue;
        const Prolongation::Part& p = p_->part(k);
        double* const to = row + 3 * std::ptrdiff_t{*product++};
        for (int j = 0; j < 3; ++j) {
          if (p.even) {
            to[j] += p.factor * g[j];
          } else {
            for (int i = 0; i < 3; ++i) to[j] += p.block[at(3 * i + j)] * g[i];
          }
        }
      }
    });
  }
}

void CoarseMatrix::fill_compliance(const SaddleMatrix& matrix, std::span<const double> scale,
                                   std::span<const double> middle_inverse) {
  for (Index r = 0; r < rows_; ++r) {
    for (auto e = static_cast<std::size_t>(compliance_.start[at(r)]);
         e < static_cast<std::size_t>(compliance_.start[at(r) + 1]); ++e)
      compliance_.value[e] = 0;
    auto e = static_cast<std::size_t>(compliance_.start[at(r)]);
    matrix.for_compliance(r, [&](Index c, double value) {
      if (c < r) return;
      while (compliance_.other[e] < c) ++e;
      compliance_.value[e] = value;
    });
  }
  std::vector<double> row_scale(at(rows_), 1);
  const Index displacements = 3 * matrix.nodes();
  for (std::size_t u = 0; u < scale.size(); ++u) {
    if (const Index r = matrix.place()[u] - displacements; r >= 0) row_scale[at(r)] = scale[u];
  }
  for (const EdgeRows& edge : edge_rows_) {
    double square[2] = {};
    const double* const inverse = middle_inverse.data() + 9 * static_cast<std::ptrdiff_t>(edge.middle);
    matrix.for_rows_of(edge.middle, [&](Index r, const double* g) {
      if (r != edge.first && r != edge.second) return;
      double sum = 0;
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) sum += g[i] * inverse[3 * i + j] * g[j];
      }
      square[r == edge.first ? 0 : 1] = sum;
    });
    const double between = compliance_factor * std::sqrt(square[0] * square[1]);
    const double ratio = row_scale[at(edge.first)] / row_scale[at(edge.second)];
    const auto diagonal = [&](Index r) -> double& {
      return compliance_.value[static_cast<std::size_t>(compliance_diagonal_[at(r)])];
    };
    diagonal(edge.first) -= between * ratio;
    diagonal(edge.second) -= between / ratio;
    compliance_.value[static_cast<std::size_t>(edge.between)] += between;
  }
}

void CoarseMatrix::assemble(const RowLoop& loop, const SaddleMatrix& matrix, const BlockMatrix& stiffness,
                            std::span<const double> scale, std::span<const double> middle_inverse) {
  project_stiffness(loop, stiffness);
  project_gradients(matrix);
  fill_compliance(matrix, scale, middle_inverse);
  for (const Part* part : {&stiffness_, &gradient_, &compliance_}) {
    for (std::size_t k = 0; k < part->value.size(); ++k) {
      if (part->place[k] >= 0) values_[static_cast<std::size_t>(part->place[k])] = part->value[k];
    }
  }
}

}  // namespace isochor
