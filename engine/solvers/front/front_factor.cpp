#include "engine/solvers/front/front_factor.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "engine/base/base.h"

namespace isochor {
namespace {

constexpr Index panel_block = 64;   // columns that are factored at once
constexpr Index update_block = 64;  // columns of an update that are computed at once
constexpr Index row_block = 256;    // rows that are divided by a block at once

template <class Real>
using Dense = Eigen::Map<Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>, 0, Eigen::OuterStride<>>;

template <class Real>
Dense<Real> dense(Real* a, Index rows, Index columns, Index stride) {
  return {a, rows, columns, Eigen::OuterStride<>(stride)};
}

template <class Real>
Eigen::Map<Eigen::Matrix<Real, Eigen::Dynamic, 1>> vector(Real* v, Index size) {
  return {v, size};
}

// L D L^T of a small lower triangle, in place: L below the diagonal, which holds D.
template <class Real>
bool factor_diagonal(Real* a, Index n, Index stride, Real smallest) {
  for (Index j = 0; j < n; ++j) {
    Real* const column = a + std::ptrdiff_t{j} * stride;
    const Real d = column[j];
    if (!(std::abs(d) > smallest) || !std::isfinite(d)) return false;
    const Real inverse = 1 / d;
    for (Index c = j + 1; c < n; ++c) {
      Real* const other = a + std::ptrdiff_t{c} * stride;
      const Real factor = column[c] * inverse;
      for (Index i = c; i < n; ++i) other[i] -= factor * column[i];
    }
    for (Index i = j + 1; i < n; ++i) column[i] *= inverse;
  }
  return true;
}

// B = B L^-T D^-1 for a few rows, with L D L^T in `a`.
template <class Real>
void divide_rows(const Real* a, Index n, Index stride, Real* b, Index rows) {
  constexpr Index inner = 16;
  for (Index j0 = 0; j0 < n; j0 += inner) {
    const Index j1 = std::min(n, j0 + inner);
    if (j0 > 0) {
      dense(b + std::ptrdiff_t{j0} * stride, rows, j1 - j0, stride).noalias() -=
          dense(b, rows, j0, stride) * dense(const_cast<Real*>(a) + j0, j1 - j0, j0, stride).transpose();
    }
    for (Index j = j0; j < j1; ++j) {
      Real* const to = b + std::ptrdiff_t{j} * stride;
      for (Index p = j0; p < j; ++p) {
        const Real factor = a[j + std::ptrdiff_t{p} * stride];
        const Real* const from = b + std::ptrdiff_t{p} * stride;
        for (Index i = 0; i < rows; ++i) to[i] -= factor * from[i];
      }
    }
  }
  for (Index j = 0; j < n; ++j) {
    Real* const to = b + std::ptrdiff_t{j} * stride;
    const Real inverse = 1 / a[j + std::ptrdiff_t{j} * stride];
    for (Index i = 0; i < rows; ++i) to[i] *= inverse;
  }
}

// Scratch of the calling thread; grows to what the largest front needs and stays.
template <class Real>
Real* scratch(std::size_t size) {
  static thread_local std::vector<Real> buffer;
  if (buffer.size() < size) buffer.resize(size);
  return buffer.data();
}

// (D L^T) of rows [r, r + count) of a panel: depth x count.
template <class Real>
Real* scaled_rows(const Real* panel, const Real* pivot, Index r, Index count, Index depth, Index stride) {
  Real* const s = scratch<Real>(at(count) * at(depth));
  for (Index j = 0; j < depth; ++j) {
    const Real* const from = panel + std::ptrdiff_t{j} * stride + r;
    Real* const to = s + std::ptrdiff_t{j} * count;
    for (Index i = 0; i < count; ++i) to[i] = pivot[j] * from[i];
  }
  return s;
}

}  // namespace

template <class Real>
void FrontFactor<Real>::set_tree(const FrontTree& tree) {
  tree_ = &tree;
  sized_ = false;
}

// Memory comes with the first factorization, and what an earlier tree had is used again: fresh pages cost as
// much as a good part of an analysis.
template <class Real>
void FrontFactor<Real>::take_memory() {
  const FrontTree& t = *tree_;
  const auto take = [](std::vector<Real>& v, std::int64_t wanted) {
    const auto size = static_cast<std::size_t>(wanted);
    if (v.capacity() < size) {
      // What has grown once may grow again.
      const bool grows = v.capacity() > 0;
      v = {};
      if (grows) v.reserve(size + size / 8);
    }
    v.resize(size);
  };
  take(factor_, t.panel_start.back());
  take(work_, t.workspace);
  pivot_.resize(at(t.size));
  permuted_.resize(at(t.size));
  gathered_.resize(at(t.largest_panel));
  job_ok_.resize(t.job_start.size());
  sized_ = true;
}

template <class Real>
void FrontFactor<Real>::assemble(Index f, std::span<const double> values) {
  const FrontTree& t = *tree_;
  const Index k = t.pivots(f), h = t.height(f);
  Real* const panel = factor_.data() + t.panel_start[at(f)];
  std::fill_n(panel, static_cast<std::size_t>(k) * at(h), Real(0));
  for (auto e = static_cast<std::size_t>(t.entry_start[at(f)]);
       e < static_cast<std::size_t>(t.entry_start[at(f) + 1]); ++e) {
    panel[t.entry_place[e]] = static_cast<Real>(values[static_cast<std::size_t>(t.entry[e])]);
  }
  for (Index c = t.child_start[at(f)]; c < t.child_start[at(f) + 1]; ++c) {
    const Index child = t.child[at(c)], u = t.updates(child);
    const Index* const place = t.place_in_parent.data() + t.row_start[at(child)];
    const Real* from = work_.data() + t.update_start[at(child)];
    for (Index j = 0; j < u && place[j] < k; ++j, from += u) {
      Real* const to = panel + std::ptrdiff_t{place[j]} * h;
      for (Index i = j; i < u; ++i) to[place[i]] += from[i];
    }
  }
}

template <class Real>
bool FrontFactor<Real>::factor_panel(Index f, const RowLoop& loop, Real smallest) {
  const FrontTree& t = *tree_;
  const Index k = t.pivots(f), h = t.height(f);
  Real* const panel = factor_.data() + t.panel_start[at(f)];
  Real* const pivot = pivot_.data() + t.first_pivot[at(f)];
  for (Index j0 = 0; j0 < k; j0 += panel_block) {
    const Index n = std::min(panel_block, k - j0), j1 = j0 + n;
    Real* const block = panel + std::ptrdiff_t{j0} * h;
    if (!factor_diagonal(block + j0, n, h, smallest)) return false;
    for (Index j = 0; j < n; ++j) pivot[j0 + j] = block[j0 + j + std::ptrdiff_t{j} * h];
    loop((h - j1 + row_block - 1) / row_block, 1, [&](Index begin, Index end) {
      const Index r0 = j1 + begin * row_block, r1 = std::min(h, j1 + end * row_block);
      for (Index r = r0; r < r1; r += row_block)
        divide_rows(block + j0, n, h, block + r, std::min(row_block, r1 - r));
    });
    // What is left of the panel.
    loop((k - j1 + update_block - 1) / update_block, 1, [&](Index begin, Index end) {
      for (Index b = begin; b < end; ++b) {
        const Index c = j1 + b * update_block, count = std::min(update_block, k - c);
        Real* const s = scaled_rows(block, pivot + j0, c, count, n, h);
        dense(panel + std::ptrdiff_t{c} * h + c, h - c, count, h).noalias() -=
            dense(block + c, h - c, n, h) * dense(s, count, n, count).transpose();
      }
    });
  }
  return true;
}

// What a front leaves for its parent: what its children left, minus L D L^T.
template <class Real>
void FrontFactor<Real>::update(Index f, const RowLoop& loop) {
  const FrontTree& t = *tree_;
  const Index k = t.pivots(f), h = t.height(f), u = h - k;
  Real* const panel = factor_.data() + t.panel_start[at(f)];
  const Real* const pivot = pivot_.data() + t.first_pivot[at(f)];
  Real* const out = work_.data() + t.update_start[at(f)];
  loop((u + update_block - 1) / update_block, 1, [&](Index begin, Index end) {
    for (Index b = begin; b < end; ++b) {
      const Index c = b * update_block, count = std::min(update_block, u - c);
      Real* const s = scaled_rows(panel, pivot, k + c, count, k, h);
      dense(out + std::ptrdiff_t{c} * u + c, u - c, count, u).noalias() =
          dense(panel + k + c, u - c, k, h) * dense(s, count, k, count).transpose() * Real(-1);
      // Their columns that fall into this block.
      for (Index q = t.child_start[at(f)]; q < t.child_start[at(f) + 1]; ++q) {
        const Index child = t.child[at(q)], uc = t.updates(child);
        const Index* const place = t.place_in_parent.data() + t.row_start[at(child)];
        const Index* const from = std::lower_bound(place, place + uc, k + c);
        for (auto j = static_cast<Index>(from - place); j < uc && place[j] < k + c + count; ++j) {
          const Real* const column = work_.data() + t.update_start[at(child)] + std::ptrdiff_t{j} * uc;
          Real* const to = out + std::ptrdiff_t{place[j] - k} * u - k;
          for (Index i = j; i < uc; ++i) to[place[i]] += column[i];
        }
      }
    }
  });
}

template <class Real>
bool FrontFactor<Real>::eliminate(Index f, const RowLoop& loop, std::span<const double> values,
                                  Real smallest) {
  assemble(f, values);
  if (!factor_panel(f, loop, smallest)) return false;
  update(f, loop);
  return true;
}

template <class Real>
bool FrontFactor<Real>::factor(const RowLoop& loop, std::span<const double> values, Real smallest,
                               const std::function<bool()>& stop) {
  const FrontTree& t = *tree_;
  if (!sized_) take_memory();
  const RowLoop alone;
  loop(static_cast<Index>(t.job_start.size()), 1, [&](Index begin, Index end) {
    for (Index j = begin; j < end; ++j) {
      bool ok = true;
      for (Index f = t.job_start[at(j)]; ok && f < t.job_end[at(j)]; ++f)
        ok = !(stop && stop()) && eliminate(f, alone, values, smallest);
      job_ok_[at(j)] = ok ? 1 : 0;
    }
  });
  if (std::find(job_ok_.begin(), job_ok_.end(), 0) != job_ok_.end()) return false;
  for (const Index f : t.above) {
    if ((stop && stop()) || !eliminate(f, loop, values, smallest)) return false;
  }
  return true;
}

template <class Real>
Index FrontFactor<Real>::negative_pivots() const {
  return static_cast<Index>(std::count_if(pivot_.begin(), pivot_.end(), [](Real d) { return d < 0; }));
}

template <class Real>
void FrontFactor<Real>::solve(std::span<Real> x) {
  const FrontTree& t = *tree_;
  Real* const y = permuted_.data();
  Real* const g = gathered_.data();
  for (Index i = 0; i < t.size; ++i) y[i] = x[at(t.unknown[at(i)])];
  for (Index f = 0; f < t.fronts(); ++f) {
    const Index k = t.pivots(f), h = t.height(f), u = h - k;
    Real* const panel = factor_.data() + t.panel_start[at(f)];
    Real* const own = y + t.first_pivot[at(f)];
    const Index* const row = t.row.data() + t.row_start[at(f)];
    for (Index j = 0; j < k; ++j) {
      const Real* const column = panel + std::ptrdiff_t{j} * h;
      for (Index i = j + 1; i < k; ++i) own[i] -= column[i] * own[j];
    }
    if (u == 0) continue;
    vector(g, u).noalias() = dense(panel + k, u, k, h) * vector(own, k);
    for (Index i = 0; i < u; ++i) y[row[i]] -= g[i];
  }
  for (Index f = t.fronts() - 1; f >= 0; --f) {
    const Index k = t.pivots(f), h = t.height(f), u = h - k;
    Real* const panel = factor_.data() + t.panel_start[at(f)];
    Real* const own = y + t.first_pivot[at(f)];
    const Real* const pivot = pivot_.data() + t.first_pivot[at(f)];
    const Index* const row = t.row.data() + t.row_start[at(f)];
    for (Index j = 0; j < k; ++j) own[j] /= pivot[j];
    if (u > 0) {
      for (Index i = 0; i < u; ++i) g[i] = y[row[i]];
      vector(own, k).noalias() -= dense(panel + k, u, k, h).transpose() * vector(g, u);
    }
    for (Index j = k - 1; j >= 0; --j) {
      Real* const column = panel + std::ptrdiff_t{j} * h;
      own[j] -= vector(column + j + 1, k - j - 1).dot(vector(own + j + 1, k - j - 1));
    }
  }
  for (Index i = 0; i < t.size; ++i) x[at(t.unknown[at(i)])] = y[i];
}

template class FrontFactor<float>;
template class FrontFactor<double>;

}  // namespace isochor
