#include "engine/step/surroundings.h"

#include <algorithm>

namespace isochor {

Surroundings::Surroundings(const StepContext& context) : context_(context) {}

Surroundings::Found Surroundings::renew(std::span<const Vec3> x, Around around) {
  Found found;
  const System& system = context_.system();
  if (!system.renews_stencils()) return found;
  const bool solved = around == Around::solution;
  auto pools = system.parts().stencil_pools;
  for (const auto& [p, stencils] : system.facets().renewed) {
    RenewalRequest request{{}, context_.state.x, x, solved, &context_.parallel};
    if (!solved) request.memory = system.stencil_memory(p, context_.pool_memory());
    Renewal answer = stencils->renewed(request);
    found.crossed += answer.crossed;
    found.passing += answer.passing;
    if (!answer.pool) continue;
    found.changed = true;
    pools[at(p)] = std::move(answer.pool);
  }
  if (!found.changed) return found;
  if (auto r = context_.methods.replace_stencils(std::move(pools)); !r) found.error = r.error();
  return found;
}

void Surroundings::keep(std::vector<std::shared_ptr<const StencilPool>> pools, const SaddleProblem& problem,
                        const Allowance& allowance, Trial& trial, SaddleReport& report) {
  if (auto r = context_.methods.replace_stencils(std::move(pools)); !r) {
    report.status = SaddleStatus::singular;
    report.message = r.error();
    return;
  }
  SaddleReport again = context_.methods.chosen().solve(problem, saddle_options(context_.options, allowance),
                                                       trial.x, trial.lambda);
  again.add_work(report);
  report = std::move(again);
}

Result<void> Surroundings::restore(std::span<const double> memory) {
  const System& system = context_.system();
  if (!system.renews_stencils()) return {};
  const auto present = system.parts().stencil_pools;
  auto pools = present;
  bool changed = false;
  for (const auto& [index, stencils] : system.facets().renewed) {
    const auto kept = system.stencil_memory(index, memory);
    const auto p = at(index);
    // Zeros: no step has been accepted, and the stencils are those that the scene began with.
    if (std::all_of(kept.begin(), kept.end(), [](double v) { return v == 0; })) {
      pools[p] = context_.first_stencils[p];
    } else {
      auto restored = stencils->restored(kept);
      if (!restored) return restored.failure();
      pools[p] = std::move(restored).value();
    }
    changed = true;
  }
  if (!changed) return {};
  auto replaced = context_.methods.replace_stencils(std::move(pools));
  if (replaced) return {};
  // All is as it was.
  (void)context_.methods.replace_stencils(present);
  return replaced;
}

Index Surroundings::passing(const StencilIncrement& increment, std::span<Vec3> x, Passing passing) const {
  Index count = 0;
  for (const auto& [pool, barrier] : context_.system().facets().barriers)
    count += barrier->passing(increment, x, passing == Passing::stop ? x : std::span<Vec3>());
  return count;
}

}  // namespace isochor
