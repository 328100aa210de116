#include "engine/step/impacts.h"

#include <algorithm>

namespace isochor {

Impacts::Impacts(const StepContext& context) : context_(context) {
  if (context_.system().facets().impacts.empty()) return;
  no_past_.assign(context_.layout.scheme, 0);
  row_work_.resize(2 * at(context_.system().rows()));
}

bool Impacts::jump(double t, double h, Trial& trial) {
  if (row_work_.empty()) return false;
  const State& state = context_.state;
  const System& system = context_.system();
  for (std::size_t i = 0; i < trial.x.size(); ++i) trial.predicted[i] = state.x[i] + h * state.v[i];
  std::fill(trial.x.begin(), trial.x.end(), Vec3{});
  bool jumps = false;
  for (const auto& [p, impact] : system.facets().impacts) {
    const auto first = at(system.first_row(p)), count = at(system.parts().row_pools[at(p)]->rows());
    const ImpactStart start{state.t,
                            t,
                            state.x,
                            state.v,
                            trial.predicted,
                            system.parts().mass,
                            context_.data.target().subspan(first, count),
                            std::span(row_work_).subspan(2 * first, 2 * count)};
    jumps = impact->add_jumps(start, trial.x) || jumps;
  }
  return jumps;
}

}  // namespace isochor
