// One increment: from the state to an end that may become the next one, or to a reason why there is none.
//
//   attempt          data and prediction at the end of the increment, stencils around the guess, then
//     solve_increment  the method of the world from the guess, from the old positions, then stand-ins
//       judge          what converged is looked at: nothing passed through, admissible (world_admission.cpp)
//     look_around      stencils that follow what is close look again; others: once more
//     accept           the trial positions become the state
#include <algorithm>
#include <cmath>

#include "engine/solve/newton/newton.h"
#include "engine/step/time_scheme.h"
#include "engine/world/world_impl.h"

namespace isochor {

// A solve that converged to where no state may be has failed like any other.
void World::Impl::judge(double h, const SaddleProblem& problem, SaddleReport& report) {
  if (report.status != SaddleStatus::converged) return;
  if (count_passing(problem.increment, false) > 0)
    report.status = SaddleStatus::passed_through;
  else
    admissible(h, problem, report);
}

// From the trial positions and multipliers.
SaddleReport World::Impl::solve_increment(double h, SaddleProblem& problem, const Allowance& allowance,
                                          bool from_guess) {
  // Persistence is for what is tried last.
  const SaddleOptions saddle = saddle_options(allowance);
  SaddleOptions last = saddle;
  last.persistent = allowance.persistent;
  newton->progress = nullptr;
  if (progress) {
    newton->progress = [this, t = problem.t1](int iteration, double f, double r) {
      progress(ProgressInfo{t, t, iteration, f, r});
    };
  }
  const bool stopped = count_passing(problem.increment, true) > 0;
  SaddleReport report =
      newton->solve(problem, from_guess || !stand_ins.empty() ? saddle : last, x_trial, lambda_trial);
  judge(h, problem, report);
  const bool out_of_budget =
      allowance.keep_unfinished && report.iterations > 0 && report.status != SaddleStatus::diverged &&
      report.status != SaddleStatus::inadmissible && report.status != SaddleStatus::passed_through;
  const bool stuck = report.status != SaddleStatus::converged && report.status != SaddleStatus::cancelled &&
                     report.status != SaddleStatus::out_of_memory && !out_of_budget;
  // Nodes that were put where they meet an obstacle may have turned over their cells.
  if (stuck && (from_guess || (stopped && report.status == SaddleStatus::not_finite))) {
    std::copy(state.lambda.begin(), state.lambda.end(), lambda_trial.begin());
    std::copy(state.x.begin(), state.x.end(), x_trial.begin());
    SaddleReport second = newton->solve(problem, stand_ins.empty() ? last : saddle, x_trial, lambda_trial);
    judge(h, problem, second);
    second.add_work(report);
    report = std::move(second);
  }
  for (StandIn& other : stand_ins) {
    if (!stuck || report.status == SaddleStatus::converged || report.status == SaddleStatus::cancelled ||
        report.status == SaddleStatus::out_of_memory)
      break;
    if (!other.solver) other.solver = make_stand_in(other.method);
    if (!other.solver) continue;
    std::copy(state.lambda.begin(), state.lambda.end(), lambda_trial.begin());
    std::copy(state.x.begin(), state.x.end(), x_trial.begin());
    SaddleReport next = solve_by(*other.solver, problem, &other == &stand_ins.back() ? last : saddle);
    judge(h, problem, next);
    next.add_work(report);
    report = std::move(next);
  }
  if (report.status == SaddleStatus::converged) refine_gradients(problem, saddle, report);
  return report;
}

// Conjugate gradients leave an error that counts where a body is soft, as next to a limit point; factors go
// well below the tolerance with their last iteration. A few more iterations of the former make up for that,
// and where they do not, or a budget leaves none, the solution stays as it was.
void World::Impl::refine_gradients(const SaddleProblem& problem, SaddleOptions saddle, SaddleReport& report) {
  if (system->dual_rows().empty() ||
      (options.method != Method::dual_gradients && options.method != Method::augmented_gradients))
    return;
  const SaddleOptions as_asked = saddle;
  saddle.force_tolerance *= 0.1;
  saddle.max_iterations = saddle.patient_iterations = std::min(2, saddle.max_iterations - report.iterations);
  if (saddle.max_iterations <= 0) return;
  x_found = x_trial;
  lambda_found = lambda_trial;
  const SaddleReport finer = newton->solve(problem, saddle, x_trial, lambda_trial);
  report.add_work(finer);
  if (finer.status == SaddleStatus::converged) {
    report.force_residual = finer.force_residual;
    report.row_residual = finer.row_residual;
    return;
  }
  std::copy(x_found.begin(), x_found.end(), x_trial.begin());
  std::copy(lambda_found.begin(), lambda_found.end(), lambda_trial.begin());
  // In balance already: this evaluates the state and leaves it.
  newton->solve(problem, as_asked, x_trial, lambda_trial);
}

// The method of this world ends an increment that another one solved: its assembly holds the state, and its
// tolerances are met.
SaddleReport World::Impl::solve_by(SaddlePoint& other, SaddleProblem& problem, const SaddleOptions& saddle) {
  other.progress = newton->progress;
  const StageSeconds before = other.seconds();
  SaddleReport report = other.solve(problem, saddle, x_trial, lambda_trial);
  StageSeconds spent = other.seconds();
  spent -= before;
  newton->add_seconds(spent);
  if (report.status != SaddleStatus::converged) return report;
  SaddleReport last = newton->solve(problem, saddle, x_trial, lambda_trial);
  last.add_work(report);
  if (last.status == SaddleStatus::converged) last.stood_in = 1;
  return last;
}

// Asks rows that look back for jumps of velocities, into the trial positions; true when there are any. The
// prediction is overwritten.
bool World::Impl::look_back(double t, double h) {
  if (row_work.empty()) return false;
  for (std::size_t i = 0; i < x_trial.size(); ++i) predicted[i] = state.x[i] + h * state.v[i];
  std::fill(x_trial.begin(), x_trial.end(), Vec3{});
  bool jumps = false;
  for (Index p = 0; p < static_cast<Index>(system->parts().row_pools.size()); ++p) {
    const RowPool& pool = *system->parts().row_pools[at(p)];
    if (!pool.looks_back() || pool.law != RowLaw::compliant) continue;
    const auto first = at(system->first_row(p)), count = at(pool.rows());
    const RowStart start{state.t,
                         t,
                         state.x,
                         state.v,
                         predicted,
                         system->parts().mass,
                         std::span<const double>(target).subspan(first, count),
                         std::span(row_work).subspan(2 * first, 2 * count)};
    jumps = pool.look_back(start, x_trial) || jumps;
  }
  return jumps;
}

namespace {

// Within a percent of balance, and no step leads further.
bool stuck_close_by(const SaddleReport& r) {
  constexpr double close = 1e-2;
  return r.status == SaddleStatus::line_search_failed && r.force_residual < close && r.row_residual < close;
}

}  // namespace

// Puts stencils back with which the trial positions are in balance.
void World::Impl::keep_stencils(std::vector<std::shared_ptr<const StencilPool>> pools,
                                const SaddleProblem& problem, const Allowance& allowance,
                                SaddleReport& report) {
  if (auto r = replace_stencils(std::move(pools)); !r) {
    report.status = SaddleStatus::singular;
    report.message = r.error();
    return;
  }
  SaddleReport again = newton->solve(problem, saddle_options(allowance), x_trial, lambda_trial);
  again.add_work(report);
  report = std::move(again);
}

SaddleReport World::Impl::attempt(double h, const Allowance& allowance) {
  given_back.clear();
  constexpr int most_looks = 8;
  const double h_evaluated = options.scheme->evaluated_at() * h, t_new = state.t + h_evaluated;
  SaddleProblem problem = problem_at(t_new);
  starts_anew = look_back(t_new, h_evaluated);
  problem.mass_scale = options.scheme->begin(
      state, starts_anew ? std::span<const double>(no_past) : scheme_memory(), h, predicted);
  for (std::size_t i = 0; i < predicted.size() && starts_anew; ++i) predicted[i] += h * x_trial[i];
  problem.predicted = predicted;
  const bool dynamic = problem.mass_scale > 0;
  if (dynamic) problem.increment.h = h_evaluated;
  // Inertia's guess first; where it fails (it may turn elements over, or leads through a surface) the old
  // positions are a safe start.
  bool from_guess = dynamic;
  const auto begin_at = [this](std::span<const Vec3> x) {
    std::copy(state.lambda.begin(), state.lambda.end(), lambda_trial.begin());
    std::copy(x.begin(), x.end(), x_trial.begin());
  };
  SaddleReport report;
  Surroundings around = look_around(dynamic ? predicted : state.x, false);
  begin_energy(problem);
  if (around.crossed > 0) from_guess = false;
  begin_at(from_guess ? predicted : state.x);
  Allowance left = allowance;
  for (int look = 0; around.error.empty(); ++look) {
    // A budget is one for all that an increment takes.
    if (allowance.keep_unfinished) {
      left.iterations = left.patient_iterations = allowance.iterations - report.iterations;
      left.factorizations = left.patient_factorizations = allowance.factorizations - report.factorizations;
      if (left.iterations <= 0 || left.factorizations <= 0) {
        report.status = SaddleStatus::iteration_limit;
        break;
      }
    }
    SaddleReport solved = solve_increment(h, problem, left, from_guess);
    solved.add_work(report);
    report = std::move(solved);
    if (stuck_close_by(report) && look + 1 < most_looks) {
      // What is nearest has changed on the way: stencils around it have no jump there.
      around = look_around(x_trial, false);
      if (around.changed && around.crossed == 0) {
        from_guess = false;
        continue;
      }
    }
    if (report.status != SaddleStatus::converged) break;
    std::vector<std::shared_ptr<const StencilPool>> solved_with;
    if (look + 1 == most_looks) solved_with = system->parts().stencil_pools;
    around = look_around(x_trial, true);
    if (around.passing > 0 || (around.crossed > 0 && look + 1 == most_looks))
      report.status = SaddleStatus::passed_through;
    if (!around.changed || report.status != SaddleStatus::converged) break;
    // What is nearest goes to and fro, as beside an edge: the solution is kept, with the stencils that it
    // solves.
    if (look + 1 == most_looks) {
      keep_stencils(std::move(solved_with), problem, left, report);
      break;
    }
    // What was seen too late is met on the way there.
    begin_energy(problem);
    from_guess = false;
    if (around.crossed > 0) begin_at(state.x);
  }
  if (!around.error.empty()) {
    report.status = SaddleStatus::singular;
    report.message = around.error;
  }
  const bool finite_iterate = std::all_of(x_trial.begin(), x_trial.end(), [](const Vec3& x) {
    return std::isfinite(x.x) && std::isfinite(x.y) && std::isfinite(x.z);
  });
  bool best_there_is = allowance.keep_unfinished && report.iterations > 0 && finite_iterate &&
                       report.status != SaddleStatus::diverged &&
                       report.status != SaddleStatus::passed_through && !asked_to_stop() &&
                       count_passing(problem.increment, false) == 0;
  if (best_there_is && report.status != SaddleStatus::converged) {
    SaddleReport unfinished = report;
    best_there_is = admissible(h, problem, unfinished);
    if (!best_there_is) given_back = unfinished.message;
  }
  if (best_there_is && report.status != SaddleStatus::converged) {
    around = look_around(x_trial, true);
    best_there_is = around.error.empty() && around.crossed + around.passing == 0;
  }
  if (report.status == SaddleStatus::converged || best_there_is) {
    accept(h, predicted);
  } else if (around.error.empty()) {
    // Stencils looked at positions that are not to be; results are about those of the state.
    if (auto r = restore_stencils(std::span<const double>(state.extra).first(at(system->memory()))); !r)
      report.message = r.error();
  }
  return report;
}

// Makes the trial positions and multipliers the state.
void World::Impl::accept(double h, std::span<const Vec3> prediction) {
  accept_memory({options.scheme->has_inertia() ? h : 0, state.x, state.t, state.t + h});
  // No past in the increment itself, and none behind it: it would hold the velocities before the jump.
  const auto forget = [this] { std::fill(scheme_memory().begin(), scheme_memory().end(), 0.0); };
  if (starts_anew) forget();
  moved = 0;
  for (std::size_t i = 0; i < x_trial.size(); ++i) {
    const Vec3 d = x_trial[i] - state.x[i];
    moved = std::max(moved, dot(d, d));
  }
  moved = std::sqrt(moved);
  options.scheme->finish(h, x_trial, prediction, state, scheme_memory());
  if (starts_anew) forget();
  std::copy(lambda_trial.begin(), lambda_trial.end(), state.lambda.begin());
  std::copy(newton->residual().begin(), newton->residual().end(), reactions.begin());
}

}  // namespace isochor
