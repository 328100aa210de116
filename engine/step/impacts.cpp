#include "engine/step/impacts.h"

#include <algorithm>

namespace isochor {

Impacts::Impacts(const StepContext& context) : context_(context) {
  const auto& pools = context_.system().parts().row_pools;
  if (std::none_of(pools.begin(), pools.end(),
                   [](const auto& p) { return p->looks_back() && p->rows() > 0; }))
    return;
  no_past_.assign(context_.layout.scheme, 0);
  row_work_.resize(2 * at(context_.system().rows()));
}

bool Impacts::look(double t, double h, Trial& trial) {
  if (row_work_.empty()) return false;
  const State& state = context_.state;
  const System& system = context_.system();
  for (std::size_t i = 0; i < trial.x.size(); ++i) trial.predicted[i] = state.x[i] + h * state.v[i];
  std::fill(trial.x.begin(), trial.x.end(), Vec3{});
  bool jumps = false;
  for (Index p = 0; p < static_cast<Index>(system.parts().row_pools.size()); ++p) {
    const RowPool& pool = *system.parts().row_pools[at(p)];
    if (!pool.looks_back() || pool.law != RowLaw::compliant) continue;
    const auto first = at(system.first_row(p)), count = at(pool.rows());
    const RowStart start{state.t,
                         t,
                         state.x,
                         state.v,
                         trial.predicted,
                         system.parts().mass,
                         context_.data.target().subspan(first, count),
                         std::span(row_work_).subspan(2 * first, 2 * count)};
    jumps = pool.look_back(start, trial.x) || jumps;
  }
  return jumps;
}

}  // namespace isochor
