#include "engine/step/end_check.h"

#include <algorithm>
#include <cmath>

#include "engine/base/text.h"
#include "engine/step/time_scheme.h"

namespace isochor {

namespace {

// Rows at the end of an increment of a scheme that meets them inside of it (relative, as row_tolerance).
constexpr double largest_row_at_end = 0.02;
// Rows that a fixed number of sweeps leaves unmet: beyond this it is no longer their solution in any sense.
constexpr double largest_row_of_sweeps = 0.5;
// Cells that are inside out by more than their volume are no way through an inversion, they are sweeps that
// have blown up; what moves from outside hides that from the balance of energy.
constexpr double most_inverted_of_sweeps = -1;
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

EndCheck::EndCheck(const StepContext& context)
    : context_(context),
      admission_(context.bodies, context.system().parts()),
      momentum_(context.state.x.size()) {
  if (context_.options.scheme->has_inertia()) ahead_ = context_.state;
}

// True when something that moves by itself (an obstacle on its way) could do work on the bodies.
bool EndCheck::moved_from_outside(const SaddleProblem& problem) const {
  const System& system = context_.system();
  // A given multiplier on functions that hold on to something is a load without a potential.
  const SystemParts& parts = system.parts();
  const bool without_potential =
      std::any_of(parts.row_pools.begin(), parts.row_pools.end(), [&](const auto& rows) {
        return rows->law == RowLaw::prescribed &&
               parts.stencil_pools[at(rows->stencil_pool)]->facets().lagged;
      });
  if (without_potential) return true;
  const auto& moving = system.facets().moving;
  return std::any_of(moving.begin(), moving.end(), [&](const auto& of) {
    return of.facet->moves(problem.increment.t0, problem.increment.t1);
  });
}

// The energy that an increment begins with, under the loads of its end.
void EndCheck::begin(const SaddleProblem& problem, bool jumps) {
  before_ = {};
  if (!(problem.mass_scale > 0) || jumps || moved_from_outside(problem)) return;
  const State& state = context_.state;
  SaddlePoint& method = context_.methods.chosen();
  // As at the end, with what friction holds on to here.
  method.assembly().set_increment(problem.increment, problem.memory);
  if (context_.system().has_lag()) method.assembly().renew_lag(state.x, state.lambda, problem.prescribed);
  const StoredEnergy stored = method.stored_at(problem, state.x, state.lambda);
  // Supports and targets on their way do work; so may whatever a host has put out of balance.
  if (!stored.met || !std::isfinite(stored.energy)) return;
  before_.known = true;
  before_.stored = stored;
  before_.kinetic = energy_of_motion(method.assembly(), state.v, ahead_.v);
}

// Why the energy at the end (`stored` there) cannot be; empty where it can, or where outside forces did work.
std::string EndCheck::energy_gained(double h, const Trial& trial, const StoredEnergy& stored) {
  if (!before_.known) return {};
  const State& state = context_.state;
  const WorldOptions& options = context_.options;
  ahead_.t = state.t;
  std::copy(state.x.begin(), state.x.end(), ahead_.x.begin());
  std::copy(state.v.begin(), state.v.end(), ahead_.v.begin());
  std::copy(state.extra.begin(), state.extra.end(), ahead_.extra.begin());
  options.scheme->finish(h, trial.x, trial.predicted, ahead_, context_.layout.of_scheme(ahead_.extra));
  const double kinetic = energy_of_motion(context_.methods.chosen().assembly(), ahead_.v, momentum_);
  const double gain = kinetic + stored.energy - before_.kinetic - before_.stored.energy;
  const double around = kinetic + stored.elastic + before_.kinetic + before_.stored.elastic;
  double most = options.scheme->largest_energy_gain();
  if (options.method == Method::position_based) most = std::max(most, energy_gain_of_sweeps);
  if (gain <= most * around + 100 * (stored.noise + before_.stored.noise)) return {};
  return std::string(options.scheme->name()) + " would gain " + number(gain) + " J from nothing in " +
         number(h) + " s, where " + number(0.5 * around) +
         " J move and are stored: take shorter steps, or implicit_euler";
}

// What a budget cut short is on its way to its rows and its energy; but cells that go flat leave a matrix
// that the next step cannot use.
bool EndCheck::may_stay_unfinished(const StoredEnergy& stored, SaddleReport& report) const {
  const bool bounds = context_.system().has_bounds();
  const bool flatter = verdict_.min_J < (bounds ? nearly_flat_with_bounds : nearly_flat) &&
                       verdict_.min_J < judge_state().min_J;
  std::string why;
  if (flatter)
    why = "its iterate crushes cells to J = " + number(verdict_.min_J);
  else if (bounds && stored.row > largest_row_with_bounds)
    why = "its iterate misses rows by " + number(stored.row) + " of their measure";
  else
    return true;
  report.status = SaddleStatus::inadmissible;
  report.message = std::move(why);
  return false;
}

bool EndCheck::admits_cells(std::span<const Vec3> x, SaddleReport& report) {
  verdict_ = admission_.judge(context_.state.x, x);
  if (verdict_.forbidden == 0) return true;
  report.status = SaddleStatus::inadmissible;
  report.message = admission_.refusal(verdict_);
  return false;
}

bool EndCheck::admits(double h, const SaddleProblem& problem, const Trial& trial, SaddleReport& report) {
  const TimeScheme& scheme = *context_.options.scheme;
  const double part = scheme.evaluated_at();
  const auto refuse = [&](std::string why) {
    report.status = SaddleStatus::inadmissible;
    report.message = std::move(why);
    return false;
  };
  std::span<const Vec3> end = trial.x;
  if (part != 1) {
    const State& state = context_.state;
    for (std::size_t i = 0; i < trial.x.size(); ++i)
      momentum_[i] = state.x[i] + (1 / part) * (trial.x[i] - state.x[i]);
    end = momentum_;
  }
  if (!admits_cells(end, report)) return false;
  SaddlePoint& method = context_.methods.chosen();
  const StoredEnergy stored =
      part == 1 ? method.stored(problem) : method.stored_at(problem, end, trial.lambda);
  if (!std::isfinite(stored.energy)) return refuse("the energy has no value there");
  // Numbers may be finite and their squares not: of sweeps that blow up, say.
  if (!std::isfinite(report.force_residual) || !std::isfinite(report.row_residual))
    return refuse("forces are beyond the range of numbers there");
  if (report.status != SaddleStatus::converged) return may_stay_unfinished(stored, report);
  const bool sweeps = context_.options.method == Method::position_based;
  if (sweeps && verdict_.min_J < most_inverted_of_sweeps) {
    return refuse("sweeps have turned cells inside out to J = " + number(verdict_.min_J) +
                  ": take more sweeps, shorter steps or another method");
  }
  const double most = !sweeps ? largest_row_at_end : part == 1 ? largest_row_of_sweeps : 0.1;
  if ((part != 1 || sweeps) && !(stored.row <= most)) {
    return refuse("rows are off by " + number(stored.row) + " of their measure at the end of the step" +
                  (sweeps ? ": take more sweeps, shorter steps or another method"
                          : ", as " + std::string(scheme.name()) +
                                " meets them in its middle: take shorter steps or another scheme"));
  }
  if (std::string why = energy_gained(h, trial, stored); !why.empty()) return refuse(std::move(why));
  return true;
}

// Newton's method stays near where it begins unless it is led away.
std::string EndCheck::far_away(const SaddleReport& solve, double moved) const {
  constexpr int many = 40;
  constexpr double far = 0.25;
  if (context_.options.scheme->has_inertia() || solve.iterations <= many ||
      !(moved > far * context_.system().length()))
    return {};
  return "the equilibrium at t = " + number(context_.state.t) +
         " lies far from the last one (nodes moved by up to " + number(moved) + " m in " +
         std::to_string(solve.iterations) +
         " iterations): there may be a fold or a snap between them, and other equilibria; take more "
         "steps, or continuation()";
}

void EndCheck::describe(const SaddleReport& solve, double moved, StepReport& report) {
  report.min_J = verdict_.min_J;
  report.inverted_cells = verdict_.inverted;
  std::string text = admission_.warning(verdict_);
  const auto add = [&text](const std::string& more) {
    if (!more.empty()) text += (text.empty() ? "" : "; ") + more;
  };
  if (context_.options.method == Method::position_based &&
      solve.row_residual > context_.options.row_tolerance) {
    add("the sweeps leave rows unmet by up to " + number(solve.row_residual) +
        " of their measure and forces by " + number(solve.force_residual) +
        ": position_based is cheap, and not the solution");
  }
  if (std::string away = far_away(solve, moved); !away.empty()) led_away_ = std::move(away);
  add(led_away_);
  report.warning = std::move(text);
}

}  // namespace isochor
