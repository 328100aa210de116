#include "engine/step/increment_data.h"

#include <algorithm>

namespace isochor {

IncrementData::IncrementData(const System& system, const Gravity& gravity, const State& state,
                             std::vector<double> weight)
    : gravity_(gravity),
      state_(state),
      weight_(std::move(weight)),
      force_(at(system.nodes())),
      target_(at(system.rows())),
      prescribed_(at(system.prescribed_rows())),
      prescribed_before_(prescribed_.size()),
      position_(system.free_bases().size()) {
  evaluate(system, state.t);
}

void IncrementData::evaluate(const System& system, double t) {
  const SystemParts& parts = system.parts();
  const Vec3 g = gravity(t);
  for (std::size_t i = 0; i < force_.size(); ++i) force_[i] = weight_[i] * g;
  for (const auto& load : parts.loads) load->add(t, force_);
  for (std::size_t i = 0; i < state_.forces.size(); ++i) force_[i] += state_.forces[i];
  for (std::size_t p = 0; p < parts.row_pools.size(); ++p) {
    const RowPool& pool = *parts.row_pools[p];
    auto& all = pool.law == RowLaw::compliant ? target_ : prescribed_;
    pool.update(t, std::span(all).subspan(at(system.first_row(static_cast<Index>(p))), at(pool.rows())));
  }
  std::size_t first = 0;
  for (const auto& p : parts.prescribers) {
    p->target(t, std::span(position_).subspan(first, p->nodes.size()));
    first += p->nodes.size();
  }
}

SaddleProblem IncrementData::problem(const System& system, const State& state, double t) {
  evaluate(system, state.t);
  std::copy(prescribed_.begin(), prescribed_.end(), prescribed_before_.begin());
  evaluate(system, t);
  SaddleProblem problem;
  problem.force = force_;
  problem.target = target_;
  problem.prescribed = prescribed_;
  problem.prescribed_before = prescribed_before_;
  problem.position = position_;

  problem.memory = std::span<const double>(state.extra).first(at(system.memory()));
  problem.increment = {0, state.x, state.t, t};
  return problem;
}

}  // namespace isochor
