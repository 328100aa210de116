#include "engine/solve/position_based.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace isochor {

namespace {

// Rows over more nodes, and what does not fit into so many colors, are visited one after the other.
constexpr std::size_t wide = 128;
constexpr Index most_colors = 256;
using ColorSet = std::array<std::uint64_t, most_colors / 64>;

Index first_free(const ColorSet& taken) {
  for (Index c = 0; c < most_colors; ++c) {
    if ((taken[at(c / 64)] >> (c % 64) & 1) == 0) return c;
  }
  return most_colors;
}

}  // namespace

std::string PositionBased::unsupported(const System& system) {
  for (const auto& law : system.laws()) {
    const RowPool& pool = *system.parts().row_pools[at(law.row_pool)];
    if (pool.facets().law->local()) continue;
    return "rows \"" + std::string(pool.name()) + "\" have a law of their own in place of a compliance";
  }
  return {};
}

PositionBased::PositionBased(std::shared_ptr<const System> system, const Parallel& parallel,
                             std::unique_ptr<LinearSolver> solver, int sweeps)
    : SaddlePoint(system, parallel, std::move(solver)), parallel_(parallel), sweeps_(sweeps) {
  const System& s = *system;
  const PoolPlace& total = s.pools().total;
  energy_.resize(at(total.energy));
  energy_strength_.resize(at(total.energy));
  value_.resize(static_cast<std::size_t>(total.function));
  zero_.resize(std::max(static_cast<std::size_t>(total.function), at(s.prescribed_rows())));
  gradient_.resize(static_cast<std::size_t>(total.gradient));
  jacobian_.resize(static_cast<std::size_t>(total.jacobian));
  inverse_mass_.resize(at(s.nodes()));
  force_.resize(at(s.nodes()));
  std::vector<std::vector<Index>> entries(at(s.rows()));
  for (std::size_t k = 0; k < s.compliance().size(); ++k) {
    const ComplianceEntry& e = s.compliance()[k];
    entries[at(e.row)].push_back(static_cast<Index>(k));
    if (e.row != e.col) entries[at(e.col)].push_back(static_cast<Index>(k));
  }
  for (const auto& list : entries) row_compliance_.push(list);
  // Of local laws the slope at zero.
  for (const ComplianceEntry& e : s.compliance()) compliance_.push_back(e.value);
  for (const auto& law : s.laws()) {
    const auto& linear = s.parts().row_pools[at(law.row_pool)]->compliance;
    for (std::size_t k = 0; k < linear.size(); ++k) compliance_[law.first_entry + k] = linear[k].value;
  }
  for (const auto& pool : s.parts().row_pools) {
    if (pool->law != RowLaw::compliant) continue;
    const Index functions = s.parts().stencil_pools[at(pool->stencil_pool)]->functions();
    for (Index r = 0; r < pool->rows(); ++r) {
      std::vector<Index> stencils;
      for (const Index f : pool->map[r]) stencils.push_back(f / functions);
      std::sort(stencils.begin(), stencils.end());
      stencils.erase(std::unique(stencils.begin(), stencils.end()), stencils.end());
      row_stencils_.push(stencils);
      row_pool_.push_back(pool->stencil_pool);
    }
  }
  color();
}

// Greedy in the order of pools, then of rows.
void PositionBased::color() {
  const System& s = system();
  std::vector<ColorSet> taken(at(s.nodes()), ColorSet{});
  std::vector<Index> color_of_row(at(s.rows()), most_colors), colors;
  std::vector<Constraint> all;
  const auto add = [&](const Constraint& c, ColorSet used, const auto& nodes) {
    Index color = most_colors;
    if (nodes.size() <= wide) {
      for (const Index i : nodes) {
        for (std::size_t w = 0; w < used.size(); ++w) used[w] |= taken[at(i)][w];
      }
      color = first_free(used);
    }
    if (color < most_colors) {
      for (const Index i : nodes) taken[at(i)][at(color / 64)] |= std::uint64_t{1} << (color % 64);
    }
    all.push_back(c);
    colors.push_back(color);
    return color;
  };
  const auto& pools = s.parts().stencil_pools;
  for (std::size_t p = 0; p < pools.size(); ++p) {
    if (!pools[p]->has_energy()) continue;
    for (Index k = 0; k < pools[p]->stencils(); ++k) {
      add({static_cast<Index>(p), k}, {}, pools[p]->nodes()[k]);
    }
  }
  std::vector<Index> nodes;
  for (Index r = 0; r < s.rows(); ++r) {
    nodes.clear();
    for (auto d = s.gathers().row_begin[at(r)]; d < s.gathers().row_begin[at(r) + 1]; ++d) {
      nodes.push_back(s.gathers().jacobian_ends[d][1]);
    }
    ColorSet used{};
    for (const Index k : row_compliance_[r]) {
      const ComplianceEntry& e = s.compliance()[at(k)];
      const Index c = color_of_row[at(e.row == r ? e.col : e.row)];
      if (c < most_colors) used[at(c / 64)] |= std::uint64_t{1} << (c % 64);
    }
    color_of_row[at(r)] = add({-1, r}, used, nodes);
  }
  // Sorted by color; the last bin are those without one.
  std::vector<std::size_t> bin(at(most_colors) + 2, 0);
  for (const Index c : colors) ++bin[at(c) + 1];
  for (std::size_t c = 0; c + 1 < bin.size(); ++c) bin[c + 1] += bin[c];
  color_start_.assign(1, 0);
  for (std::size_t c = 0; c < at(most_colors) && bin[c + 1] > bin[c]; ++c) color_start_.push_back(bin[c + 1]);
  constraints_.resize(all.size());
  for (std::size_t k = 0; k < all.size(); ++k) constraints_[bin[at(colors[k])]++] = all[k];
}

// The part of a vector in the free directions of a node.
Vec3 PositionBased::mobile(Index node, const Vec3& v) const {
  const Index b = system().basis_of()[at(node)];
  if (b < 0) return v;
  const FreeBasis& basis = system().free_bases()[at(b)];
  Vec3 q = transposed_times(basis.directions, v);
  for (int c = basis.count; c < 3; ++c) q[c] = 0;
  return basis.directions * q;
}

void PositionBased::evaluate_stencil(Index pool, Index stencil, std::span<const Vec3> x) {
  const System& s = system();
  const StencilPool& stencils = *s.parts().stencil_pools[at(pool)];
  const PoolPlace& place = s.pools().slots[at(pool)];
  const std::size_t count = at(stencils.stencils()),
                    functions = static_cast<std::size_t>(stencils.functions());
  const std::size_t nodes = stencils.nodes().item.size();
  StencilRequest q = slots().request(pool, Want::gradient, x);
  q.function_multiplier =
      std::span<const double>(zero_).subspan(static_cast<std::size_t>(place.function), count * functions);
  q.begin = stencil;
  q.end = stencil + 1;
  const auto part = [](auto& all, std::int64_t first, std::size_t n) {
    return std::span(all.data() + first, n);
  };
  stencils.evaluate(q, {part(energy_, place.energy, count),
                        part(value_, place.function, count * functions),
                        part(gradient_, place.gradient, nodes),
                        part(jacobian_, place.jacobian, nodes * functions),
                        {}});
}

// With C = sqrt(2 energy), energy = C^2 / 2: the multiplier L of C heads for C itself.
void PositionBased::visit_energy(const Constraint& c, std::span<Vec3> x) {
  const System& s = system();
  evaluate_stencil(c.pool, c.item, x);
  const PoolPlace& place = s.pools().slots[at(c.pool)];
  const std::size_t own = at(place.energy + c.item);
  const double energy = energy_[own];
  // Nothing to push against, or outside of where the energy is defined: the neighbors have to help.
  if (!(energy > 0) || !std::isfinite(energy)) return;
  const Lists& lists = s.parts().stencil_pools[at(c.pool)]->nodes();
  const auto nodes = lists[c.item];
  const Vec3* const gradient = gradient_.data() + place.gradient + lists.offset[at(c.item)];
  const double value = std::sqrt(2 * energy);
  double give = 0;
  for (std::size_t a = 0; a < nodes.size(); ++a) {
    const Vec3 g = mobile(nodes[a], gradient[a]);
    give += inverse_mass_[at(nodes[a])] * dot(g, g);
  }
  const double change = (value - energy_strength_[own]) / (1 + give / (value * value));
  if (!std::isfinite(change)) return;
  energy_strength_[own] += change;
  for (std::size_t a = 0; a < nodes.size(); ++a) {
    x[at(nodes[a])] -= (inverse_mass_[at(nodes[a])] * change / value) * mobile(nodes[a], gradient[a]);
  }
}

void PositionBased::visit_row(Index row, std::span<Vec3> x, std::span<double> lambda,
                              std::span<const double> target) {
  const System& s = system();
  for (const Index k : row_stencils_[row]) evaluate_stencil(row_pool_[at(row)], k, x);
  const auto sum = [&](const Gather& gather, std::int64_t to, const auto& slots, auto total) {
    for (auto k = gather.offset[static_cast<std::size_t>(to)];
         k < gather.offset[static_cast<std::size_t>(to) + 1]; ++k) {
      const auto place = static_cast<std::size_t>(k);
      total += gather.weight[place] * slots[static_cast<std::size_t>(gather.source[place])];
    }
    return total;
  };
  double theta = sum(s.gathers().row, row, value_, 0.0) - target[at(row)], give = 0;
  for (const Index k : row_compliance_[row]) {
    const ComplianceEntry& e = s.compliance()[at(k)];
    const double c = compliance_[at(k)];
    theta -= c * lambda[at(e.row == row ? e.col : e.row)];
    if (e.row == e.col) give += c;
  }
  const auto begin = s.gathers().row_begin[at(row)], end = s.gathers().row_begin[at(row) + 1];
  for (auto d = begin; d < end; ++d) {
    const Index i = s.gathers().jacobian_ends[d][1];
    const Vec3 g = mobile(i, sum(s.gathers().jacobian, static_cast<std::int64_t>(d), jacobian_, Vec3{}));
    give += inverse_mass_[at(i)] * dot(g, g);
  }
  if (!(give > 0) || !std::isfinite(theta)) return;
  double next = lambda[at(row)] + theta / give;
  if (s.has_bounds()) next = std::clamp(next, s.row_lower()[at(row)], s.row_upper()[at(row)]);
  const double change = next - lambda[at(row)];
  lambda[at(row)] = next;
  for (auto d = begin; d < end; ++d) {
    const Index i = s.gathers().jacobian_ends[d][1];
    const Vec3 g = mobile(i, sum(s.gathers().jacobian, static_cast<std::int64_t>(d), jacobian_, Vec3{}));
    x[at(i)] -= (inverse_mass_[at(i)] * change) * g;
  }
}

void PositionBased::visit(const Constraint& c, std::span<Vec3> x, std::span<double> lambda,
                          std::span<const double> target) {
  if (c.pool >= 0)
    visit_energy(c, x);
  else
    visit_row(c.item, x, lambda, target);
}

// Where inertia and forces that are known beforehand carry the nodes: loads, and rows with given multipliers
// at the old positions. Given coordinates go to their targets.
void PositionBased::start(const SaddleProblem& p, std::span<Vec3> x, std::span<const double> lambda) {
  const System& s = system();
  const auto old = p.increment.before;
  slots().renew_lag(old, lambda, p.prescribed);
  std::copy(p.force.begin(), p.force.end(), force_.begin());
  if (s.prescribed_rows() > 0) {
    // Forces with these multipliers less those without.
    const std::span<const double> none = std::span<const double>(zero_).first(at(s.prescribed_rows()));
    std::vector<Vec3>& work = gap_.way;
    for (const bool with : {true, false}) {
      slots().evaluate(Want::gradient, Definiteness::exact, old, lambda, with ? p.prescribed : none);
      slots().residual(work);
      for (std::size_t i = 0; i < work.size(); ++i) force_[i] -= (with ? 1.0 : -1.0) * work[i];
    }
  }
  for (Index i = 0; i < s.nodes(); ++i) {
    const double inertia = p.mass_scale * s.parts().mass[at(i)];
    inverse_mass_[at(i)] = inertia > 0 ? 1 / inertia : 0;
    x[at(i)] = p.predicted[at(i)] + inverse_mass_[at(i)] * force_[at(i)];
    const Index b = s.basis_of()[at(i)];
    if (b >= 0) x[at(i)] = p.position[at(b)] + mobile(i, x[at(i)] - p.position[at(b)]);
  }
}

SaddleReport PositionBased::solve_from_here(const SaddleProblem& p, const SaddleOptions& options) {
  SaddleReport report;
  const auto fail = [&](SaddleStatus status) {
    report.status = status;
    return report;
  };
  std::vector<Vec3>& x = now_.x;
  std::vector<double>& lambda = now_.lambda;
  start(p, x, lambda);
  std::fill(lambda.begin(), lambda.end(), 0.0);
  std::fill(energy_strength_.begin(), energy_strength_.end(), 0.0);
  evaluator_.clamp(lambda);
  for (int sweep = 0; sweep < sweeps_; ++sweep) {
    if (interrupted()) return fail(SaddleStatus::cancelled);
    for (std::size_t c = 0; c + 1 < color_start_.size(); ++c) {
      const std::size_t first = color_start_[c];
      parallel_.run(static_cast<Index>(color_start_[c + 1] - first), 32, [&](Index b, Index e) {
        for (Index k = b; k < e; ++k) visit(constraints_[first + at(k)], x, lambda, p.target);
      });
    }
    for (std::size_t k = color_start_.back(); k < constraints_.size(); ++k) {
      visit(constraints_[k], x, lambda, p.target);
    }
    ++report.iterations;
  }
  if (!std::all_of(x.begin(), x.end(), finite)) return fail(SaddleStatus::diverged);
  evaluator_.evaluate(p, Want::gradient, Definiteness::exact, now_);
  evaluator_.balanced(p, options, now_, report);
  // Elements may be left turned over where their energy has no value; it is the sweeps that bring them back.
  if (!std::isfinite(report.force_residual) || !std::isfinite(report.row_residual)) {
    return fail(SaddleStatus::diverged);
  }
  return report;
}

}  // namespace isochor
