#include "engine/system/assembly.h"

#include <algorithm>
#include <cmath>

namespace isochor {

namespace {

constexpr Index kGatherGrain = 512;

Index as_index(std::int64_t n) {
  return static_cast<Index>(n);
}

// Weighted sum of scalar slots into each of the destinations [begin, begin + out.size()).
void gather_scalars(const Gather& g, std::int64_t begin, std::span<const double> slots, std::span<double> out,
                    const Parallel& parallel) {
  parallel.run(static_cast<Index>(out.size()), kGatherGrain, [&](Index b, Index e) {
    for (Index d = b; d < e; ++d) {
      const auto from = static_cast<std::size_t>(g.offset[static_cast<std::size_t>(begin + d)]);
      const auto to = static_cast<std::size_t>(g.offset[static_cast<std::size_t>(begin + d) + 1]);
      double sum = 0;
      for (std::size_t k = from; k < to; ++k)
        sum += g.weight[k] * slots[static_cast<std::size_t>(g.source[k])];
      out[at(d)] = sum;
    }
  });
}

}  // namespace

Assembly::Assembly(std::shared_ptr<const System> system, const Parallel& parallel)
    : system_(std::move(system)), parallel_(parallel) {
  const PoolPlace& total = system_->pools().total;
  energy_.resize(at(total.energy));
  value_.resize(static_cast<std::size_t>(total.function));
  multiplier_.resize(static_cast<std::size_t>(total.function));
  gradient_.resize(static_cast<std::size_t>(total.gradient));
  product_.resize(static_cast<std::size_t>(total.gradient));
  jacobian_.resize(static_cast<std::size_t>(total.jacobian));
  hessian_.resize(static_cast<std::size_t>(total.hessian));
  if (system_->has_lag()) {
    lag_x_.resize(at(system_->nodes()));
    lag_multiplier_.resize(static_cast<std::size_t>(total.function));
  }
  if (system_->shares()) {
    sums_.resize(2 + at(system_->rows() + system_->prescribed_rows()));
    forces_.resize(4 * at(system_->nodes()));
  }
}

// Multiplier of every function: sum over rows of weight times multiplier.
void Assembly::gather_multipliers(std::span<const double> lambda, std::span<const double> prescribed,
                                  std::span<double> out) const {
  const Gather& g = system_->gathers().function;
  const Index m = system_->rows();
  parallel_.run(as_index(g.count()), kGatherGrain, [&](Index b, Index e) {
    for (Index f = b; f < e; ++f) {
      double sum = 0;
      const auto to = static_cast<std::size_t>(g.offset[at(f) + 1]);
      for (auto k = static_cast<std::size_t>(g.offset[at(f)]); k < to; ++k) {
        const Index row = as_index(g.source[k]);
        sum += g.weight[k] * (row < m ? lambda[at(row)] : prescribed[at(row - m)]);
      }
      out[at(f)] = sum;
    }
  });
}

void Assembly::renew_lag(std::span<const Vec3> x, std::span<const double> lambda,
                         std::span<const double> prescribed) {
  if (!system_->has_lag()) return;
  std::copy(x.begin(), x.end(), lag_x_.begin());
  gather_multipliers(lambda, prescribed, lag_multiplier_);
  lagged_ = true;
}

StencilRequest Assembly::request(Index p, Want want, std::span<const Vec3> x) const {
  const StencilPool& pool = *system_->parts().stencil_pools[at(p)];
  const auto first = static_cast<std::size_t>(system_->pools().slots[at(p)].function);
  const auto functions = at(pool.stencils()) * static_cast<std::size_t>(pool.functions());
  StencilRequest q{want,
                   Definiteness::exact,
                   0,
                   pool.stencils(),
                   x,
                   system_->parts().rest,
                   {multiplier_.data() + first, functions},
                   increment_,
                   {},
                   {}};
  if (lagged_ && pool.facets().lagged) q.lag = {lag_x_, std::span(lag_multiplier_).subspan(first, functions)};
  if (!memory_.empty()) q.memory = system_->stencil_memory(p, memory_);
  return q;
}

void Assembly::evaluate(Want want, Definiteness definiteness, std::span<const Vec3> x,
                        std::span<const double> lambda, std::span<const double> prescribed) {
  const System& s = *system_;
  if (want != Want::value) gather_multipliers(lambda, prescribed, multiplier_);
  for (std::size_t p = 0; p < s.parts().stencil_pools.size(); ++p) evaluate_pool(p, want, definiteness, x);
  if (s.shares()) exchange(want);
}

void Assembly::evaluate_lagging(Want want, std::span<const Vec3> x) {
  for (const auto& lagged : system_->facets().lagged)
    evaluate_pool(at(lagged.pool), want, Definiteness::exact, x);
  if (system_->shares()) exchange(want);
}

void Assembly::evaluate_pool(std::size_t p, Want want, Definiteness definiteness, std::span<const Vec3> x) {
  const StencilPool& pool = *system_->parts().stencil_pools[p];
  const PoolPlace& place = system_->pools().slots[p];
  const auto slots = pool.nodes().item.size();
  const auto functions = static_cast<std::size_t>(pool.functions());
  const auto stencils = at(pool.stencils());
  const auto blocks = pool.has_hessian() ? static_cast<std::size_t>(pool.hessian_offset().back()) : 0;
  const auto part = [](auto& all, std::int64_t first, std::size_t count) {
    return std::span(all.data() + first, count);
  };
  StencilRequest whole = request(static_cast<Index>(p), want, x);
  whole.definiteness = definiteness;
  for (const StencilRun& run : system_->pools().runs[p]) {
    // Pools write as to a place for every stencil; the run is where they do.
    const StencilSlots out{
        part(energy_, place.energy, stencils), part(value_, place.function, stencils * functions),
        part(gradient_, run.gradient, slots), part(jacobian_, run.jacobian, slots * functions),
        part(hessian_, run.hessian, blocks)};
    parallel_.run(run.end - run.begin, pool.grain(), [&](Index b, Index e) {
      StencilRequest part_of = whole;
      part_of.begin = run.begin + b;
      part_of.end = run.begin + e;
      pool.evaluate(part_of, out);
    });
    // Those who answer for them add these energies up.
    if (!run.own) std::fill_n(energy_.begin() + place.energy + run.begin, run.end - run.begin, 0.0);
  }
}

// One sum of what belongs to nobody alone, and what falls on nodes from their owners.
void Assembly::exchange(Want want) {
  const Shares& shares = *system_->shares();
  sums_[0] = ordered_sum(energy_);
  sums_[1] = 0;
  for (const double e : energy_) sums_[1] += std::abs(e);
  gather_scalars(system_->gathers().row, 0, value_, std::span(sums_).subspan(2), parallel_);
  shares.sum(sums_);
  if (want == Want::value) return;
  const Gather& g = system_->gathers().residual;
  for (const Index i : shares.own_nodes()) {
    Vec3 sum{};
    double magnitude = 0;
    const auto to = static_cast<std::size_t>(g.offset[at(i) + 1]);
    for (auto k = static_cast<std::size_t>(g.offset[at(i)]); k < to; ++k) {
      const Vec3& force = gradient_[static_cast<std::size_t>(g.source[k])];
      sum += force;
      magnitude += norm(force);
    }
    double* const at_node = forces_.data() + 4 * at(i);
    for (int c = 0; c < 3; ++c) at_node[c] = sum[c];
    at_node[3] = magnitude;
  }
  shares.gather_nodes(forces_, 4);
}

double Assembly::energy() const {
  return system_->shares() ? sums_[0] : ordered_sum(energy_);
}

double Assembly::absolute_energy() const {
  if (system_->shares()) return sums_[1];
  double sum = 0;
  for (const double e : energy_) sum += std::abs(e);
  return sum;
}

void Assembly::row_values(std::span<double> phi) const {
  if (system_->shares()) {
    std::copy_n(sums_.begin() + 2, phi.size(), phi.begin());
    return;
  }
  gather_scalars(system_->gathers().row, 0, value_, phi, parallel_);
}

void Assembly::prescribed_row_values(std::span<double> phi) const {
  if (system_->shares()) {
    std::copy_n(sums_.begin() + 2 + system_->rows(), phi.size(), phi.begin());
    return;
  }
  gather_scalars(system_->gathers().row, system_->rows(), value_, phi, parallel_);
}

void Assembly::residual(std::span<Vec3> r) const {
  if (system_->shares()) {
    for (std::size_t i = 0; i < r.size(); ++i)
      r[i] = {forces_[4 * i], forces_[4 * i + 1], forces_[4 * i + 2]};
    return;
  }
  const Gather& g = system_->gathers().residual;
  parallel_.run(system_->nodes(), kGatherGrain, [&](Index b, Index e) {
    for (Index i = b; i < e; ++i) {
      Vec3 sum{};
      const auto to = static_cast<std::size_t>(g.offset[at(i) + 1]);
      for (auto k = static_cast<std::size_t>(g.offset[at(i)]); k < to; ++k) {
        sum += gradient_[static_cast<std::size_t>(g.source[k])];
      }
      r[at(i)] = sum;
    }
  });
}

void Assembly::residual_magnitude(std::span<double> r) const {
  if (system_->shares()) {
    for (std::size_t i = 0; i < r.size(); ++i) r[i] = forces_[4 * i + 3];
    return;
  }
  const Gather& g = system_->gathers().residual;
  parallel_.run(system_->nodes(), kGatherGrain, [&](Index b, Index e) {
    for (Index i = b; i < e; ++i) {
      double sum = 0;
      const auto to = static_cast<std::size_t>(g.offset[at(i) + 1]);
      for (auto k = static_cast<std::size_t>(g.offset[at(i)]); k < to; ++k) {
        sum += norm(gradient_[static_cast<std::size_t>(g.source[k])]);
      }
      r[at(i)] = sum;
    }
  });
}

void Assembly::constraint_force(std::span<const double> lambda, std::span<Vec3> r) const {
  // Serial: rows meet at nodes. Only reports and studies ask for it.
  const Shares* const shares = system_->shares();
  std::fill(r.begin(), r.end(), Vec3{});
  const Gather& g = system_->gathers().jacobian;
  const auto& ends = system_->gathers().jacobian_ends;
  for (std::size_t d = 0; d < ends.size(); ++d) {
    if (shares && !shares->owns(ends[d][1])) continue;
    Vec3 sum{};
    for (auto k = static_cast<std::size_t>(g.offset[d]); k < static_cast<std::size_t>(g.offset[d + 1]); ++k) {
      sum += g.weight[k] * jacobian_[static_cast<std::size_t>(g.source[k])];
    }
    r[at(ends[d][1])] += lambda[at(ends[d][0])] * sum;
  }
  if (shares) shares->gather_nodes(r);
}

void Assembly::hessian_times(std::span<const Vec3> v, std::span<Vec3> y) {
  const auto& pools = system_->parts().stencil_pools;
  for (std::size_t p = 0; p < pools.size(); ++p) {
    const StencilPool& pool = *pools[p];
    for (const StencilRun& run : system_->pools().runs[p]) {
      parallel_.run(run.end - run.begin, pool.grain(), [&](Index begin, Index end) {
        for (Index s = run.begin + begin; s < run.begin + end; ++s) {
          const auto nodes = pool.nodes()[s];
          const auto first = static_cast<std::size_t>(run.gradient + pool.nodes().offset[at(s)]);
          for (std::size_t a = 0; a < nodes.size(); ++a) product_[first + a] = Vec3{};
          if (!pool.has_hessian()) continue;
          auto block = static_cast<std::size_t>(run.hessian + pool.hessian_offset()[at(s)]);
          for (std::size_t a = 0; a < nodes.size(); ++a) {
            for (std::size_t b = 0; b <= a; ++b, ++block) {
              product_[first + a] += hessian_[block] * v[at(nodes[b])];
              if (a != b) product_[first + b] += transposed_times(hessian_[block], v[at(nodes[a])]);
            }
          }
        }
      });
    }
  }
  const Gather& g = system_->gathers().residual;
  for (Index i = 0; i < system_->nodes(); ++i) {
    Vec3 sum{};
    const auto to = static_cast<std::size_t>(g.offset[at(i) + 1]);
    for (auto k = static_cast<std::size_t>(g.offset[at(i)]); k < to; ++k) {
      sum += product_[static_cast<std::size_t>(g.source[k])];
    }
    y[at(i)] = sum;
  }
  if (system_->shares()) system_->shares()->gather_nodes(y);
}

void Assembly::jacobian_times(std::span<const Vec3> v, std::span<double> y) const {
  std::fill(y.begin(), y.end(), 0.0);
  const Gather& g = system_->gathers().jacobian;
  const auto& ends = system_->gathers().jacobian_ends;
  const Shares* const shares = system_->shares();
  for (std::size_t d = 0; d < ends.size(); ++d) {
    if (shares && !shares->owns(ends[d][1])) continue;
    Vec3 sum{};
    for (auto k = static_cast<std::size_t>(g.offset[d]); k < static_cast<std::size_t>(g.offset[d + 1]); ++k) {
      sum += g.weight[k] * jacobian_[static_cast<std::size_t>(g.source[k])];
    }
    y[at(ends[d][0])] += dot(sum, v[at(ends[d][1])]);
  }
  if (shares) shares->sum(y);
}

void Assembly::gather_block(std::int64_t block, Mat3& sum) const {
  constexpr std::size_t ahead = 16;
  const Gather& g = system_->gathers().block;
  const auto to = static_cast<std::size_t>(g.offset[static_cast<std::size_t>(block) + 1]);
  for (auto k = static_cast<std::size_t>(g.offset[static_cast<std::size_t>(block)]); k < to; ++k) {
    const std::int64_t source = g.source[k];
    // The slots of a block lie far apart.
    if (k + ahead < g.source.size()) {
      const std::int64_t next = g.source[k + ahead];
      __builtin_prefetch(&hessian_[static_cast<std::size_t>(next >= 0 ? next : ~next)]);
    }
    if (source >= 0) {
      const Mat3& h = hessian_[static_cast<std::size_t>(source)];
      for (std::size_t i = 0; i < 9; ++i) sum.m[i] += h.m[i];
    } else {
      const Mat3& h = hessian_[static_cast<std::size_t>(~source)];
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) sum(i, j) += h(j, i);
      }
    }
  }
}

namespace {

// B_i^T S B_j in place; nodes free in all directions keep their block.
void to_free_basis(const System& s, Index i, Index j, Mat3& block) {
  const Index bi = s.basis_of()[at(i)], bj = s.basis_of()[at(j)];
  if (bj >= 0) {
    const Mat3& q = s.free_bases()[at(bj)].directions;
    Mat3 t;
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c)
        t(r, c) = block(r, 0) * q(0, c) + block(r, 1) * q(1, c) + block(r, 2) * q(2, c);
    }
    block = t;
  }
  if (bi >= 0) {
    const Mat3& q = s.free_bases()[at(bi)].directions;
    Mat3 t;
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c)
        t(r, c) = q(0, r) * block(0, c) + q(1, r) * block(1, c) + q(2, r) * block(2, c);
    }
    block = t;
  }
}

}  // namespace

void Assembly::kkt_values(double mass_scale, std::span<double> values) const {
  const System& s = *system_;
  const auto& first = s.first_unknown();
  parallel_.run(as_index(s.gathers().block.count()), kGatherGrain, [&](Index begin, Index end) {
    for (Index d = begin; d < end; ++d) {
      const auto [i, j] = s.gathers().block_ends[at(d)];
      const Index ki = first[at(i) + 1] - first[at(i)], kj = first[at(j) + 1] - first[at(j)];
      if (ki == 0 || kj == 0) continue;
      Mat3 block;
      gather_block(d, block);
      if (i == j) {
        for (int k = 0; k < 3; ++k) block(k, k) += mass_scale * s.parts().mass[at(i)];
      }
      if (!s.block_mass().empty()) {
        for (int k = 0; k < 3; ++k) block(k, k) += mass_scale * s.block_mass()[at(d)];
      }
      to_free_basis(s, i, j, block);
      for (Index c = 0; c < kj; ++c) {
        auto to = static_cast<std::size_t>(s.matrix().block[3 * at(d) + at(c)]);
        for (Index r = i == j ? c : 0; r < ki; ++r) values[to++] = block(r, c);
      }
    }
  });
  const Gather& g = s.gathers().jacobian;
  parallel_.run(as_index(g.count()), kGatherGrain, [&](Index begin, Index end) {
    for (Index d = begin; d < end; ++d) {
      const Index node = s.gathers().jacobian_ends[at(d)][1];
      const Index kj = first[at(node) + 1] - first[at(node)];
      if (kj == 0 || s.matrix().jacobian[3 * at(d)] < 0) continue;
      Vec3 sum{};
      const auto to = static_cast<std::size_t>(g.offset[at(d) + 1]);
      for (auto k = static_cast<std::size_t>(g.offset[at(d)]); k < to; ++k) {
        sum += g.weight[k] * jacobian_[static_cast<std::size_t>(g.source[k])];
      }
      const Index b = s.basis_of()[at(node)];
      if (b >= 0) sum = transposed_times(s.free_bases()[at(b)].directions, sum);
      for (Index c = 0; c < kj; ++c)
        values[static_cast<std::size_t>(s.matrix().jacobian[3 * at(d) + at(c)])] = sum[c];
    }
  });
  const auto& places = s.matrix().compliance;
  for (const std::int64_t p : places) {
    if (p >= 0) values[static_cast<std::size_t>(p)] = 0;
  }
  for (std::size_t k = 0; k < places.size(); ++k) {
    if (places[k] >= 0) values[static_cast<std::size_t>(places[k])] -= s.compliance()[k].value;
  }
}

void Assembly::mass_times(std::span<const Vec3> v, std::span<Vec3> y) const {
  const System& s = *system_;
  const bool shared_blocks = s.shares() && !s.block_mass().empty();
  for (std::size_t i = 0; i < v.size(); ++i) y[i] = shared_blocks ? Vec3{} : s.parts().mass[i] * v[i];
  for (std::size_t d = 0; d < s.block_mass().size(); ++d) {
    const auto [i, j] = s.gathers().block_ends[d];
    const double m = s.block_mass()[d];
    y[at(i)] += m * v[at(j)];
    if (i != j) y[at(j)] += m * v[at(i)];
  }
  if (!shared_blocks) return;
  s.shares()->sum({&y.data()->x, 3 * y.size()});
  for (std::size_t i = 0; i < v.size(); ++i) y[i] += s.parts().mass[i] * v[i];
}

void Assembly::row_jacobian(std::span<Vec3> jacobian) const {
  const System& s = *system_;
  const Gather& g = s.gathers().jacobian;
  parallel_.run(as_index(g.count()), kGatherGrain, [&](Index begin, Index end) {
    for (Index d = begin; d < end; ++d) {
      Vec3 sum{};
      const auto to = static_cast<std::size_t>(g.offset[at(d) + 1]);
      for (auto k = static_cast<std::size_t>(g.offset[at(d)]); k < to; ++k) {
        sum += g.weight[k] * jacobian_[static_cast<std::size_t>(g.source[k])];
      }
      const Index b = s.basis_of()[at(s.gathers().jacobian_ends[at(d)][1])];
      jacobian[at(d)] = b >= 0 ? transposed_times(s.free_bases()[at(b)].directions, sum) : sum;
    }
  });
  if (!s.shares()) return;
  for (const Index r : s.shares()->summed_rows) {
    const std::size_t from = s.gathers().row_begin[at(r)], to = s.gathers().row_begin[at(r) + 1];
    if (from < to) s.shares()->sum({&jacobian[from].x, 3 * (to - from)});
  }
}

std::span<const double> Assembly::function_multipliers(Index pool) const {
  const StencilPool& p = *system_->parts().stencil_pools[at(pool)];
  return {multiplier_.data() + system_->pools().slots[at(pool)].function,
          at(p.stencils()) * static_cast<std::size_t>(p.functions())};
}

void Assembly::stiffness_diagonal(std::span<double> k) const {
  const auto& ends = system_->gathers().block_ends;
  for (std::size_t d = 0; d < ends.size(); ++d) {
    if (ends[d][0] != ends[d][1]) continue;
    Mat3 block;
    gather_block(static_cast<std::int64_t>(d), block);
    k[at(ends[d][0])] = std::max({std::abs(block(0, 0)), std::abs(block(1, 1)), std::abs(block(2, 2))});
  }
  if (system_->shares()) system_->shares()->gather_nodes(k);
}

std::size_t Assembly::memory_bytes() const {
  return (energy_.size() + value_.size() + multiplier_.size() + sums_.size() + forces_.size()) *
             sizeof(double) +
         (gradient_.size() + jacobian_.size() + product_.size()) * sizeof(Vec3) +
         hessian_.size() * sizeof(Mat3);
}

}  // namespace isochor
