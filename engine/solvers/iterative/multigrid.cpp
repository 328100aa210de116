#include "engine/solvers/iterative/multigrid.h"

#include <algorithm>
#include <cmath>

#include "engine/solvers/iterative/aggregates.h"
#include "engine/solvers/iterative/multigrid_blocks.h"

namespace isochor {
namespace {

// Dense solves up to this many unknowns; a coarsest level that is larger is only smoothed.
constexpr Index dense_limit = 1800;

// Rows of unions of lists: unite(i, add) calls add(column) for everything in row i.
template <class Unite>
void fill_pattern(BlockMatrix& m, const Unite& unite) {
  std::vector<Index> seen(at(m.columns), -1), row;
  m.start.assign(1, 0);
  m.start.reserve(at(m.rows) + 1);
  m.column.clear();
  for (Index i = 0; i < m.rows; ++i) {
    row.clear();
    unite(i, [&](Index c) {
      if (seen[at(c)] == i) return;
      seen[at(c)] = i;
      row.push_back(c);
    });
    std::sort(row.begin(), row.end());
    m.column.insert(m.column.end(), row.begin(), row.end());
    m.start.push_back(static_cast<std::int64_t>(m.column.size()));
  }
  m.column.shrink_to_fit();
}

}  // namespace

void Multigrid::analyze(BlockMatrix fine) {
  levels_.clear();
  levels_.emplace_back();
  levels_.front().a = std::move(fine);
  levels_.front().a.allocate();
  for (;;) {
    Level& level = levels_.back();
    const std::size_t n = at(level.a.rows) * static_cast<std::size_t>(level.a.height);
    level.diagonal_inverse.resize(n * static_cast<std::size_t>(level.a.height));
    level.modes.resize(n * modes_per_node);
    for (auto* v : {&level.x, &level.b, &level.r, &level.d}) v->resize(n);
    if (level.a.rows <= options_.coarsest) break;
    level.aggregates = aggregate_nodes(level.a, level.aggregate);
    if (level.aggregates > level.a.rows * 4 / 5) break;  // it does not pay: mostly single nodes
    Level coarse;
    build_pattern(level, coarse);
    levels_.push_back(std::move(coarse));
  }
  dot_.allocate(levels_.front().x.size());
  const std::size_t n = levels_.back().x.size();
  dense_ = n <= static_cast<std::size_t>(dense_limit);
  coarse_.resize(dense_ ? n * n : 0);
  coarse_work_.resize(n);
}

// Patterns of P, of A P and of the coarse matrix, and P by columns.
void Multigrid::build_pattern(Level& level, Level& coarse) {
  const BlockMatrix& a = level.a;
  const Index n = a.rows, m = level.aggregates;
  BlockMatrix &p = level.p, &ap = level.ap, &c = coarse.a;
  p.rows = ap.rows = n;
  p.columns = ap.columns = c.rows = c.columns = m;
  p.height = ap.height = a.height;
  p.width = ap.width = c.height = c.width = modes_per_node;
  fill_pattern(p, [&](Index i, const auto& add) {
    for_row(a, i, [&](auto, Index j) { add(level.aggregate[at(j)]); });
  });
  fill_pattern(ap, [&](Index i, const auto& add) {
    for_row(a, i, [&](auto, Index j) { for_row(p, j, [&](auto, Index k) { add(k); }); });
  });
  level.p_start.assign(at(m) + 1, 0);
  for (const Index k : p.column) ++level.p_start[at(k) + 1];
  for (std::size_t k = 0; k < at(m); ++k) level.p_start[k + 1] += level.p_start[k];
  std::vector<std::int64_t> next(level.p_start.begin(), level.p_start.end() - 1);
  level.p_by_column.resize(p.column.size());
  level.p_row.resize(p.column.size());
  for (Index i = 0; i < n; ++i) {
    for_row(p, i, [&](std::int64_t k, Index column) {
      const auto to = static_cast<std::size_t>(next[at(column)]++);
      level.p_by_column[to] = k;
      level.p_row[to] = i;
    });
  }
  fill_pattern(c, [&](Index column, const auto& add) {
    for (auto k = level.p_start[at(column)]; k < level.p_start[at(column) + 1]; ++k) {
      for_row(ap, level.p_row[static_cast<std::size_t>(k)], [&](auto, Index j) { add(j); });
    }
  });
  for (BlockMatrix* matrix : {&p, &ap, &c}) matrix->allocate();
  level.member_start.assign(at(m) + 1, 0);
  for (const Index g : level.aggregate) ++level.member_start[at(g) + 1];
  for (std::size_t k = 0; k < at(m); ++k) level.member_start[k + 1] += level.member_start[k];
  std::vector<Index> place(level.member_start.begin(), level.member_start.end() - 1);
  level.member.resize(at(n));
  for (Index i = 0; i < n; ++i) level.member[at(place[at(level.aggregate[at(i)])]++)] = i;
  level.tentative.resize(at(n) * static_cast<std::size_t>(a.height * modes_per_node));
}

void Multigrid::factor(const RowLoop& loop, std::span<const double> modes, double caution) {
  std::copy(modes.begin(), modes.end(), levels_.front().modes.begin());
  for (std::size_t l = 0; l < levels_.size(); ++l) {
    Level& level = levels_[l];
    invert_diagonal_blocks(loop, level.a, level.diagonal_inverse);
    level.bound = caution * estimate_bound(loop, level);
    if (l + 1 == levels_.size()) break;
    prolongate_tentative(loop, level, levels_[l + 1]);
    smooth_prolongation(loop, level);
    project(loop, level, levels_[l + 1]);
  }
  if (dense_) factor_coarsest();
}

namespace {

// y = D^-1 x, or y = alpha y + beta D^-1 x.
void diagonal_solve(const RowLoop& loop, int size, Index rows, const double* inverse, const double* x,
                    double* y, double alpha, double beta) {
  with_size(size, [&]<int B>(std::integral_constant<int, B>) {
    loop(rows, 1024, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) {
        const auto first = static_cast<std::ptrdiff_t>(i) * B;
        const double* const block = inverse + first * B;
        for (int p = 0; p < B; ++p) {
          double sum = 0;
          for (int q = 0; q < B; ++q) sum += block[p * B + q] * x[first + q];
          y[first + p] = alpha == 0 ? beta * sum : alpha * y[first + p] + beta * sum;
        }
      }
    });
  });
}

}  // namespace

// Largest eigenvalue of D^-1 A by the power method, from the same start every time, with a margin for what a
// few iterations leave out.
double Multigrid::estimate_bound(const RowLoop& loop, Level& level) {
  constexpr int iterations = 12;
  constexpr double margin = 1.1;
  auto& x = level.x;
  std::uint64_t seed = 0x9e3779b97f4a7c15ull;
  for (double& v : x) {
    seed = seed * 6364136223846793005ull + 1442695040888963407ull;
    v = static_cast<double>(seed >> 40) * (1.0 / (1 << 24)) - 0.5;
  }
  double largest = 1;
  for (int k = 0; k < iterations; ++k) {
    const double size = std::sqrt(dot_(loop, x, x));
    if (!(size > 0)) return 1;
    for (double& v : x) v /= size;
    multiply(loop, level.a, x, level.r);
    diagonal_solve(loop, level.a.height, level.a.rows, level.diagonal_inverse.data(), level.r.data(),
                   x.data(), 0, 1);
    largest = std::sqrt(dot_(loop, x, x));
  }
  return std::isfinite(largest) ? margin * std::max(largest, 0.1) : 1;
}

// Orthonormal bases of the modes on each aggregate; their coefficients are the modes of the coarse level.
// Motions that an aggregate cannot tell apart (all those of a single node but three) leave empty columns.
void Multigrid::prolongate_tentative(const RowLoop& loop, Level& level, Level& coarse) {
  const int b = level.a.height;
  constexpr int m = modes_per_node;
  loop(level.aggregates, 64, [&](Index begin, Index end) {
    for (Index g = begin; g < end; ++g) {
      const auto from = level.member_start[at(g)], to = level.member_start[at(g) + 1];
      double* const upper = coarse.modes.data() + static_cast<std::ptrdiff_t>(g) * (m * m);
      std::fill(upper, upper + m * m, 0.0);
      const auto row = [&](Index member) {
        return static_cast<std::ptrdiff_t>(level.member[at(member)]) * (b * m);
      };
      for (auto k = from; k < to; ++k)
        std::copy_n(level.modes.data() + row(k), b * m, level.tentative.data() + row(k));
      const auto dot = [&](int p, int q) {
        double sum = 0;
        for (auto k = from; k < to; ++k) {
          const double* const t = level.tentative.data() + row(k);
          for (int i = 0; i < b; ++i) sum += t[i * m + p] * t[i * m + q];
        }
        return sum;
      };
      for (int q = 0; q < m; ++q) {
        const double before = std::sqrt(dot(q, q));
        for (int pass = 0; pass < 2; ++pass) {
          for (int p = 0; p < q; ++p) {
            const double s = dot(p, q);
            upper[p * m + q] += s;
            for (auto k = from; k < to; ++k) {
              double* const t = level.tentative.data() + row(k);
              for (int i = 0; i < b; ++i) t[i * m + q] -= s * t[i * m + p];
            }
          }
        }
        const double after = std::sqrt(dot(q, q));
        const bool independent = after > 1e-6 * before && after > 0;
        upper[q * m + q] = independent ? after : 0;
        for (auto k = from; k < to; ++k) {
          double* const t = level.tentative.data() + row(k);
          for (int i = 0; i < b; ++i) t[i * m + q] = independent ? t[i * m + q] / after : 0;
        }
      }
    }
  });
}

// x += q(D^-1 A) D^-1 (b - A x), a Chebyshev polynomial.
void Multigrid::smooth(const RowLoop& loop, Level& level, std::span<const double> b, std::span<double> x,
                       bool from_zero) {
  const double high = level.bound, low = high / options_.smoother_range;
  const double theta = 0.5 * (high + low), delta = 0.5 * (high - low), sigma = theta / delta;
  double rho = 1 / sigma;
  const auto solve = [&](double alpha, double beta) {
    diagonal_solve(loop, level.a.height, level.a.rows, level.diagonal_inverse.data(), level.r.data(),
                   level.d.data(), alpha, beta);
  };
  const auto n = static_cast<Index>(x.size());
  const auto add = [&] {
    loop(n, 8192, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) x[at(i)] += level.d[at(i)];
    });
  };
  if (from_zero) {
    std::fill(x.begin(), x.end(), 0.0);
    std::copy(b.begin(), b.end(), level.r.begin());
  } else {
    residual(loop, level.a, b, x, level.r);
  }
  solve(0, 1 / theta);
  add();
  for (int k = 1; k < options_.smoother_degree; ++k) {
    residual(loop, level.a, b, x, level.r);
    const double next = 1 / (2 * sigma - rho);
    solve(next * rho, 2 * next / delta);
    rho = next;
    add();
  }
}

void Multigrid::apply(const RowLoop& loop, std::span<const double> b, std::span<double> x) {
  cycle(loop, 0, b, x);
}

void Multigrid::cycle(const RowLoop& loop, std::size_t index, std::span<const double> b,
                      std::span<double> x) {
  Level& level = levels_[index];
  if (index + 1 == levels_.size()) {
    if (dense_) return solve_coarsest(b, x);
    return smooth(loop, level, b, x, true);
  }
  smooth(loop, level, b, x, true);
  residual(loop, level.a, b, x, level.r);
  Level& coarse = levels_[index + 1];
  constexpr int m = modes_per_node;
  const int h = level.a.height;
  loop(level.aggregates, 64, [&](Index begin, Index end) {
    for (Index g = begin; g < end; ++g) {
      double sum[m] = {};
      for (auto k = level.p_start[at(g)]; k < level.p_start[at(g) + 1]; ++k) {
        const auto place = static_cast<std::size_t>(k);
        const double* const block = level.p.value.data() + level.p_by_column[place] * (h * m);
        const double* const r = level.r.data() + static_cast<std::ptrdiff_t>(level.p_row[place]) * h;
        for (int p = 0; p < h; ++p) {
          for (int q = 0; q < m; ++q) sum[q] += block[p * m + q] * r[p];
        }
      }
      std::copy_n(sum, m, coarse.b.data() + static_cast<std::ptrdiff_t>(g) * m);
    }
  });
  cycle(loop, index + 1, coarse.b, coarse.x);
  loop(level.a.rows, block_grain, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      double* const xi = x.data() + static_cast<std::ptrdiff_t>(i) * h;
      for_row(level.p, i, [&](std::int64_t k, Index g) {
        const double* const block = level.p.value.data() + k * (h * m);
        const double* const xc = coarse.x.data() + static_cast<std::ptrdiff_t>(g) * m;
        for (int p = 0; p < h; ++p) {
          for (int q = 0; q < m; ++q) xi[p] += block[p * m + q] * xc[q];
        }
      });
    }
  });
  smooth(loop, level, b, x, false);
}

std::int64_t Multigrid::nonzeros() const {
  std::int64_t sum = 0;
  for (const Level& level : levels_) sum += static_cast<std::int64_t>(level.a.value.size());
  return sum;
}

std::size_t Multigrid::bytes() const {
  std::size_t sum = coarse_.size() * sizeof(double);
  for (const Level& level : levels_) {
    sum +=
        level.a.bytes() + level.p.bytes() + level.ap.bytes() +
        level.p_by_column.size() * (sizeof(std::int64_t) + sizeof(Index)) +
        (level.diagonal_inverse.size() + level.tentative.size() + level.modes.size() + 4 * level.x.size()) *
            sizeof(double);
  }
  return sum;
}

}  // namespace isochor
