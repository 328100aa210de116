#include "engine/solvers/two_level/two_level.h"

#include <algorithm>
#include <cmath>

#include "engine/solvers/iterative/multigrid_blocks.h"

namespace isochor {
namespace {

constexpr Index grain = 256;

// to += block times the first three numbers of x.
inline void add_block(const float* block, const float* x, float* to) {
  for (int i = 0; i < 4; ++i) to[i] += block[i] * x[0] + block[4 + i] * x[1] + block[8 + i] * x[2];
}

void narrow(const double* block, float* to) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) to[4 * j + i] = static_cast<float>(block[3 * i + j]);
  }
}

}  // namespace

TwoLevel::TwoLevel(std::unique_ptr<LinearSolver> pivoting, const TwoLevelOptions& options)
    : options_(options), coarse_solver_(std::move(pivoting), {}) {}

void TwoLevel::set_parallel(const Parallel& parallel) {
  loop_ = RowLoop(&parallel);
  coarse_solver_.set_parallel(parallel);
}

bool TwoLevel::analyze(const SymmetricPattern& pattern, std::span<const UnknownGeometry> geometry) {
  matrix_.analyze(pattern, geometry);
  stiffness_ = matrix_.take_stiffness_pattern();
  prolongation_.analyze(matrix_, find_edge_nodes(matrix_, stiffness_, geometry), geometry);
  if (matrix_.rows() == 0 || middles() < matrix_.nodes() / 2) return false;
  stiffness_.allocate();
  coarse_.analyze(pattern, matrix_, stiffness_, prolongation_);
  list_blocks();
  inverse_.assign(9 * at(matrix_.nodes()), 0);
  middle_inverse_.assign(12 * middle_.size(), 0);
  for (auto* v : {&x_, &r_, &d_}) v->assign(4 * middle_.size(), 0);
  at_corners_.assign(4 * corner_.size(), 0);
  coarse_vector_.assign(at(prolongation_.size()), 0);
  return coarse_solver_.analyze(coarse_.pattern()).status == FactorStatus::ok;
}

// The stiffness in parts: between middles, and both ways between middles and corners.
void TwoLevel::list_blocks() {
  middle_.clear();
  corner_.clear();
  std::vector<Index> number(at(matrix_.nodes()));
  for (Index i = 0; i < matrix_.nodes(); ++i) {
    auto& list = prolongation_.is_middle(i) ? middle_ : corner_;
    number[at(i)] = static_cast<Index>(list.size());
    list.push_back(i);
  }
  const auto list = [&](const std::vector<Index>& rows, bool to_middles) {
    Narrow part;
    for (const Index i : rows) {
      for (auto k = stiffness_.start[at(i)]; k < stiffness_.start[at(i) + 1]; ++k) {
        const Index j = stiffness_.column[static_cast<std::size_t>(k)];
        if (prolongation_.is_middle(j) != to_middles) continue;
        part.column.push_back(number[at(j)]);
        part.source.push_back(k);
      }
      part.start.push_back(static_cast<std::int64_t>(part.column.size()));
    }
    part.value.assign(12 * part.column.size(), 0);
    return part;
  };
  middles_ = list(middle_, true);
  to_middles_ = list(middle_, false);
  to_corners_ = list(corner_, true);
}

void TwoLevel::fill(Narrow& part) const {
  loop_(static_cast<Index>(part.source.size()), 8192, [&](Index begin, Index end) {
    for (Index k = begin; k < end; ++k)
      narrow(stiffness_.value.data() + 9 * part.source[at(k)],
             part.value.data() + 12 * static_cast<std::ptrdiff_t>(k));
  });
}

FactorReport TwoLevel::factor(std::span<const double> values, std::span<const double> scale) {
  matrix_.set_values(values, stiffness_);
  invert_diagonal_blocks(loop_, stiffness_, inverse_);
  for (std::size_t m = 0; m < middle_.size(); ++m)
    narrow(inverse_.data() + 9 * at(middle_[m]), middle_inverse_.data() + 12 * m);
  for (Narrow* part : {&middles_, &to_middles_, &to_corners_}) fill(*part);
  estimate_bound();
  prolongation_.weigh(scale);
  coarse_.assemble(loop_, matrix_, stiffness_, scale, inverse_);
  return coarse_solver_.factor(coarse_.values());
}

// r -= part x.
void TwoLevel::subtract(const Narrow& part, std::span<const float> x, std::span<float> r) const {
  loop_(static_cast<Index>(part.start.size()) - 1, grain, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      float sum[4] = {};
      for (auto k = part.start[at(i)]; k < part.start[at(i) + 1]; ++k)
        add_block(part.value.data() + 12 * k, x.data() + 4 * at(part.column[static_cast<std::size_t>(k)]),
                  sum);
      float* const to = r.data() + 4 * at(i);
      for (int q = 0; q < 4; ++q) to[q] -= sum[q];
    }
  });
}

// d = alpha d + beta D^-1 r.
void TwoLevel::solve_diagonal(float alpha, float beta) {
  loop_(static_cast<Index>(middle_.size()), 1024, [&](Index begin, Index end) {
    for (Index m = begin; m < end; ++m) {
      float sum[4] = {};
      add_block(middle_inverse_.data() + 12 * at(m), r_.data() + 4 * at(m), sum);
      float* const d = d_.data() + 4 * at(m);
      for (int q = 0; q < 4; ++q) d[q] = alpha * d[q] + beta * sum[q];
    }
  });
}

// Largest eigenvalue of D^-1 K_mm by the power method, from the same start every time, with a margin for what
// a few iterations leave out.
void TwoLevel::estimate_bound() {
  constexpr int iterations = 10;
  constexpr double margin = 1.1;
  std::uint64_t seed = 0x9e3779b97f4a7c15ull;
  for (std::size_t i = 0; i < d_.size(); ++i) {
    seed = seed * 6364136223846793005ull + 1442695040888963407ull;
    d_[i] = i % 4 == 3 ? 0.0f : static_cast<float>(seed >> 40) * (1.0f / (1 << 24)) - 0.5f;
  }
  const auto size = [&] {
    double sum = 0;
    for (const float v : d_) sum += double{v} * double{v};
    return std::sqrt(sum);
  };
  double largest = 1;
  for (int k = 0; k < iterations; ++k) {
    const double norm = size();
    if (!(norm > 0)) break;
    for (float& v : d_) v = static_cast<float>(v / norm);
    std::fill(r_.begin(), r_.end(), 0.0f);
    subtract(middles_, d_, r_);
    solve_diagonal(0, -1);
    largest = size();
  }
  bound_ = std::isfinite(largest) ? margin * std::max(largest, 0.1) : 1;
}

// x += S r, by increments of which the last is left in d, and r without that.
void TwoLevel::smooth() {
  const double high = bound_, low = high / options_.smoother_range;
  const double theta = 0.5 * (high + low), delta = 0.5 * (high - low), sigma = theta / delta;
  double rho = 1 / sigma;
  const auto add = [&] {
    loop_(static_cast<Index>(x_.size()), 8192, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) x_[at(i)] += d_[at(i)];
    });
  };
  solve_diagonal(0, static_cast<float>(1 / theta));
  add();
  for (int k = 1; k < options_.smoother_degree; ++k) {
    subtract(middles_, d_, r_);
    const double next = 1 / (2 * sigma - rho);
    solve_diagonal(static_cast<float>(next * rho), static_cast<float>(2 * next / delta));
    rho = next;
    add();
  }
}

// v -= A x where x does not live: at the corners and rows; the middles of v become r.
void TwoLevel::leave_middles(std::span<double> v) const {
  loop_(static_cast<Index>(corner_.size()), grain, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      float sum[4] = {};
      for (auto k = to_corners_.start[at(i)]; k < to_corners_.start[at(i) + 1]; ++k)
        add_block(to_corners_.value.data() + 12 * k,
                  x_.data() + 4 * at(to_corners_.column[static_cast<std::size_t>(k)]), sum);
      double* const to = v.data() + 3 * at(corner_[at(i)]);
      for (int q = 0; q < 3; ++q) to[q] -= double{sum[q]};
    }
  });
  loop_(static_cast<Index>(middle_.size()), 1024, [&](Index begin, Index end) {
    for (Index m = begin; m < end; ++m) {
      for (std::size_t q = 0; q < 3; ++q) v[3 * at(middle_[at(m)]) + q] = double{x_[4 * at(m) + q]};
    }
  });
  const std::size_t first = 3 * at(matrix_.nodes());
  loop_(matrix_.rows(), grain, [&](Index begin, Index end) {
    for (Index r = begin; r < end; ++r) {
      double sum = 0;
      matrix_.for_gradient(r, [&](Index node, const double* g) {
        if (!prolongation_.is_middle(node)) return;
        for (std::size_t q = 0; q < 3; ++q) sum += g[q] * v[3 * at(node) + q];
      });
      v[first + at(r)] -= sum;
    }
  });
  loop_(static_cast<Index>(middle_.size()), 1024, [&](Index begin, Index end) {
    for (Index m = begin; m < end; ++m) {
      for (std::size_t q = 0; q < 3; ++q) v[3 * at(middle_[at(m)]) + q] = double{r_[4 * at(m) + q]};
    }
  });
}

// r -= A v, v what the coarse level has found: at the corners, the rows and between the corners.
void TwoLevel::take_corners(std::span<const double> v) {
  loop_(static_cast<Index>(corner_.size()), 1024, [&](Index begin, Index end) {
    for (Index c = begin; c < end; ++c) {
      for (std::size_t q = 0; q < 3; ++q)
        at_corners_[4 * at(c) + q] = static_cast<float>(v[3 * at(corner_[at(c)]) + q]);
    }
  });
  const std::size_t first = 3 * at(matrix_.nodes());
  loop_(static_cast<Index>(middle_.size()), grain, [&](Index begin, Index end) {
    for (Index m = begin; m < end; ++m) {
      double sum[3] = {};
      matrix_.for_rows_of(middle_[at(m)], [&](Index r, const double* g) {
        for (std::size_t q = 0; q < 3; ++q) sum[q] += g[q] * v[first + at(r)];
      });
      for (std::size_t q = 0; q < 3; ++q) {
        d_[4 * at(m) + q] = static_cast<float>(v[3 * at(middle_[at(m)]) + q]);
        r_[4 * at(m) + q] -= static_cast<float>(sum[q]);
      }
    }
  });
  subtract(to_middles_, at_corners_, r_);
  subtract(middles_, d_, r_);
}

bool TwoLevel::precondition(std::span<double> v) {
  // Single precision has a narrow range.
  double largest = 0;
  for (const double u : v) largest = std::max(largest, std::abs(u));
  if (largest == 0) return true;
  if (!std::isfinite(largest) || !std::isfinite(1 / largest)) return false;
  for (std::size_t m = 0; m < middle_.size(); ++m) {
    for (std::size_t q = 0; q < 3; ++q)
      r_[4 * m + q] = static_cast<float>(v[3 * at(middle_[m]) + q] / largest);
  }
  for (double& u : v) u /= largest;
  std::fill(x_.begin(), x_.end(), 0.0f);
  smooth();
  subtract(middles_, d_, r_);
  leave_middles(v);
  prolongation_.restrict_to(loop_, v, coarse_vector_);
  if (!coarse_solver_.precondition(coarse_vector_)) return false;
  std::fill(v.begin(), v.end(), 0.0);
  prolongation_.prolong(loop_, coarse_vector_, v);
  take_corners(v);
  smooth();
  for (std::size_t m = 0; m < middle_.size(); ++m) {
    for (std::size_t q = 0; q < 3; ++q) v[3 * at(middle_[m]) + q] += double{x_[4 * m + q]};
  }
  for (double& u : v) u *= largest;
  return true;
}

double TwoLevel::direction_work() const {
  const auto blocks = [](const Narrow& part) { return static_cast<double>(part.column.size()); };
  const int products = 2 * options_.smoother_degree;
  return 9 * (products * blocks(middles_) + blocks(to_middles_) + blocks(to_corners_) +
              2 * static_cast<double>(stiffness_.blocks())) +
         2 * static_cast<double>(coarse_solver_.tree().panel_start.back());
}

}  // namespace isochor
