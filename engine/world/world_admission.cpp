// What the end of an increment is tested for before it becomes the state: whoever solved it.
#include <algorithm>
#include <cmath>

#include "engine/base/text.h"
#include "engine/world/world_impl.h"

namespace isochor {

namespace {

// Rows at the end of an increment of a scheme that meets them inside of it (relative, as row_tolerance).
constexpr double largest_row_at_end = 0.02;
// Rows that a fixed number of sweeps leaves unmet: beyond this it is no longer their solution in any sense.
constexpr double largest_row_of_sweeps = 0.5;
// Of a fixed number of sweeps, which end where they end.
constexpr double energy_gain_of_sweeps = 0.1;
// An unfinished iterate may not have cells flatter than this and than those it began with. Where rows have
// bounds (contact), nor miss rows by more than that: held and free rows change about there, and the next step
// may not find its way.
constexpr double nearly_flat = 0.05, nearly_flat_with_bounds = 0.2;
constexpr double largest_row_with_bounds = 0.03;

double energy_of_motion(const Assembly& assembly, std::span<const Vec3> v, std::span<Vec3> momentum) {
  assembly.mass_times(v, momentum);
  double energy = 0;
  for (std::size_t i = 0; i < v.size(); ++i) energy += 0.5 * dot(momentum[i], v[i]);
  return energy;
}

}  // namespace

// True when something that moves by itself (an obstacle on its way) could do work on the bodies: functions or
// energies differ between the beginning and the end of the increment at the same positions.
bool World::Impl::moved_from_outside(const SaddleProblem& problem) {
  // A given multiplier on functions that hold on to something is a load without a potential.
  const SystemParts& parts = system->parts();
  const bool without_potential =
      std::any_of(parts.row_pools.begin(), parts.row_pools.end(), [&](const auto& rows) {
        return rows->law == RowLaw::prescribed && parts.stencil_pools[at(rows->stencil_pool)]->has_lag();
      });
  if (without_potential) return true;
  if (!system->has_bounds() && !system->has_barrier()) return false;
  Assembly& assembly = newton->assembly();
  double energy[2] = {};
  for (const int end : {0, 1}) {
    const double t = end == 0 ? problem.t0 : problem.t1;
    assembly.set_increment({0, {}, t, t}, problem.memory);
    assembly.evaluate(Want::value, Definiteness::exact, state.x, state.lambda, problem.prescribed);
    assembly.row_values(row_values[static_cast<std::size_t>(end)]);
    energy[end] = assembly.energy();
  }
  return energy[0] != energy[1] || row_values[0] != row_values[1];
}

// The energy that an increment begins with, under the loads of its end.
void World::Impl::begin_energy(const SaddleProblem& problem) {
  energy_before = {};
  if (!(problem.mass_scale > 0) || starts_anew || moved_from_outside(problem)) return;
  // As at the end, with what friction holds on to here.
  newton->assembly().set_increment(problem.increment, problem.memory);
  if (system->has_lag()) newton->assembly().renew_lag(state.x, state.lambda, problem.prescribed);
  const SaddlePoint::Stored stored = newton->stored_at(problem, state.x, state.lambda);
  // Supports and targets on their way do work; so may whatever a host has put out of balance.
  if (!stored.met || !std::isfinite(stored.energy)) return;
  energy_before.known = true;
  energy_before.stored = stored;
  energy_before.kinetic = energy_of_motion(newton->assembly(), state.v, ahead.v);
}

// Why the energy at the end (`stored` there) cannot be; empty where it can, or where outside forces did work.
std::string World::Impl::energy_gained(double h, const SaddlePoint::Stored& stored) {
  if (!energy_before.known) return {};
  ahead.t = state.t;
  std::copy(state.x.begin(), state.x.end(), ahead.x.begin());
  std::copy(state.v.begin(), state.v.end(), ahead.v.begin());
  std::copy(state.extra.begin(), state.extra.end(), ahead.extra.begin());
  const auto memory =
      std::span(ahead.extra).subspan(at(system->memory()), options.scheme->memory(state.x.size()));
  options.scheme->finish(h, x_trial, predicted, ahead, memory);
  const double kinetic = energy_of_motion(newton->assembly(), ahead.v, momentum);
  const double gain = kinetic + stored.energy - energy_before.kinetic - energy_before.stored.energy;
  const double around = kinetic + stored.elastic + energy_before.kinetic + energy_before.stored.elastic;
  double most = options.scheme->largest_energy_gain();
  if (options.method == Method::position_based) most = std::max(most, energy_gain_of_sweeps);
  if (gain <= most * around + 100 * (stored.noise + energy_before.stored.noise)) return {};
  return std::string(options.scheme->name()) + " would gain " + number(gain) + " J from nothing in " +
         number(h) + " s, where " + number(0.5 * around) +
         " J move and are stored: take shorter steps, or implicit_euler";
}

// Whether the trial positions, with which a solve converged, may become the state; otherwise the report is
// that of a rejection.
bool World::Impl::admissible(double h, const SaddleProblem& problem, SaddleReport& report) {
  const double part = options.scheme->evaluated_at();
  const auto refuse = [&](std::string why) {
    report.status = SaddleStatus::inadmissible;
    report.message = std::move(why);
    return false;
  };
  std::span<const Vec3> end = x_trial;
  if (part != 1) {
    for (std::size_t i = 0; i < x_trial.size(); ++i)
      momentum[i] = state.x[i] + (1 / part) * (x_trial[i] - state.x[i]);
    end = momentum;
  }
  verdict = admission->look(state.x, end);
  if (verdict.forbidden > 0) return refuse(admission->refusal(verdict));
  const SaddlePoint::Stored stored = part == 1 ? newton->stored(problem, x_trial, lambda_trial)
                                               : newton->stored_at(problem, end, lambda_trial);
  if (!std::isfinite(stored.energy)) return refuse("the energy has no value there");
  // What a budget cut short is on its way to its rows and its energy; but cells that go flat leave a matrix
  // that the next step cannot use.
  if (report.status != SaddleStatus::converged) {
    const bool bounds = system->has_bounds();
    const bool flatter = verdict.min_J < (bounds ? nearly_flat_with_bounds : nearly_flat) &&
                         verdict.min_J < admission->look(state.x, state.x).min_J;
    if (flatter) return refuse("its iterate crushes cells to J = " + number(verdict.min_J));
    if (bounds && stored.row > largest_row_with_bounds)
      return refuse("its iterate misses rows by " + number(stored.row) + " of their measure");
    return true;
  }
  const bool sweeps = options.method == Method::position_based;
  const double most = !sweeps ? largest_row_at_end : part == 1 ? largest_row_of_sweeps : 0.1;
  if ((part != 1 || sweeps) && !(stored.row <= most)) {
    return refuse("rows are off by " + number(stored.row) + " of their measure at the end of the step" +
                  (sweeps ? ": take more sweeps, shorter steps or another method"
                          : ", as " + std::string(options.scheme->name()) +
                                " meets them in its middle: take shorter steps or another scheme"));
  }
  if (const std::string why = energy_gained(h, stored); !why.empty()) return refuse(why);
  return true;
}

// What the report of a step says about the state that its last increment arrived at. What an earlier one said
// about the way there stays.
void World::Impl::describe_end(const SaddleReport& solve, StepReport& report) {
  report.min_J = verdict.min_J;
  report.inverted_cells = verdict.inverted;
  std::string text = admission->warning(verdict);
  const auto add = [&text](const std::string& more) {
    if (!more.empty()) text += (text.empty() ? "" : "; ") + more;
  };
  if (options.method == Method::position_based && solve.row_residual > options.row_tolerance) {
    add("the sweeps leave rows unmet by up to " + number(solve.row_residual) +
        " of their measure and forces by " + number(solve.force_residual) +
        ": position_based is cheap, and not the solution");
  }
  // Newton's method stays near where it begins unless it is led away.
  constexpr int many = 40;
  constexpr double far = 0.25;
  if (!options.scheme->has_inertia() && solve.iterations > many && moved > far * system->length()) {
    led_away = "the equilibrium at t = " + number(state.t) +
               " lies far from the last one (nodes moved by up to " + number(moved) + " m in " +
               std::to_string(solve.iterations) +
               " iterations): there may be a fold or a snap between them, and other equilibria; take more "
               "steps, or continuation()";
  }
  add(led_away);
  report.warning = std::move(text);
}

}  // namespace isochor
