#include "engine/step/stepper.h"

#include <algorithm>
#include <cmath>

#include "engine/step/time_scheme.h"

namespace isochor {

// An increment on its way: its problem, how it was left by the last solve, and what is close.
struct Stepper::Attempt {
  double h = 0;
  SaddleProblem problem;
  Allowance left;  // a budget is one for all that an increment takes
  bool jumps = false, from_guess = false;
  SaddleReport report;
  Surroundings::Found around;
};

namespace {

constexpr int most_climbs = 8;  // of one increment, as stencils are renewed around its end

// Within a percent of balance, and no step leads further.
bool stuck_close_by(const SaddleReport& r) {
  constexpr double close = 1e-2;
  return r.status == SaddleStatus::line_search_failed && r.force_residual < close && r.row_residual < close;
}

// A budget is one for all that an increment takes; without one every solve has the same allowance.
Allowance what_is_left(Allowance all, const SaddleReport& spent) {
  if (!all.keep_unfinished) return all;
  all.iterations = all.patient_iterations = all.iterations - spent.iterations;
  all.factorizations = all.patient_factorizations = all.factorizations - spent.factorizations;
  return all;
}

// Whether a solve ended in a way that leaves an iterate which a budget may keep.
bool leaves_iterate(const SaddleReport& r) {
  return r.iterations > 0 && r.status != SaddleStatus::diverged && r.status != SaddleStatus::inadmissible &&
         r.status != SaddleStatus::passed_through;
}

}  // namespace

Stepper::Stepper(const StepContext& context)
    : context_(context),
      surroundings_(context),
      impacts_(context),
      end_(context),
      memory_before_(context.layout.pools) {
  const System& system = context_.system();
  trial_.x.resize(at(system.nodes()));
  trial_.predicted.resize(at(system.nodes()));
  trial_.lambda.resize(at(system.rows()));
}

void Stepper::show_progress(double t) {
  SaddlePoint& method = context_.methods.chosen();
  method.progress = nullptr;
  if (!progress_) return;
  method.progress = [this, t](int iteration, double force, double row) {
    progress_(ProgressInfo{t, t, iteration, force, row});
  };
}

SaddleReport Stepper::solve(const SaddleProblem& problem, const SaddleOptions& options) {
  return context_.methods.chosen().solve(problem, options, trial_.x, trial_.lambda);
}

// The method of the world ends an increment that another one solved: its assembly holds the state, and its
// tolerances are met.
SaddleReport Stepper::solve_by(SaddlePoint& other, const SaddleProblem& problem,
                               const SaddleOptions& options) {
  SaddlePoint& method = context_.methods.chosen();
  other.progress = method.progress;
  const StageSeconds before = other.seconds();
  SaddleReport report = other.solve(problem, options, trial_.x, trial_.lambda);
  StageSeconds spent = other.seconds();
  spent -= before;
  method.add_seconds(spent);
  if (report.status != SaddleStatus::converged) return report;
  SaddleReport last = solve(problem, options);
  last.add_work(report);
  if (last.status == SaddleStatus::converged) last.dual.stand_ins = 1;
  return last;
}

// It would fail in the next one too, mostly at the price of all its iterations.
bool Stepper::gives_up_on(Method method) const {
  constexpr int most_failures = 2;
  const auto stand_ins = context_.methods.stand_ins();
  return !stand_ins.empty() && method != stand_ins.back() &&
         failures_[static_cast<std::size_t>(method)] >= most_failures;
}

// A solve that converged to where no state may be has failed like any other.
void Stepper::judge(double h, const SaddleProblem& problem, SaddleReport& report) {
  if (report.status != SaddleStatus::converged) return;
  if (surroundings_.passing(problem.increment, trial_.x, Surroundings::Passing::count) > 0)
    report.status = SaddleStatus::passed_through;
  else
    end_.admits(h, problem, trial_, report);
}

// From the trial positions and multipliers up the ladder, until a rung solves it.
SaddleReport Stepper::climb(Attempt& a) {
  Climb c{a.h, a.problem, a.left, a.from_guess, false, false, gives_up_on(Method::automatic), {}};
  const auto stand_ins = context_.methods.stand_ins();
  const Method last = stand_ins.empty() ? Method::automatic : stand_ins.back();
  show_progress(a.problem.increment.t1);
  c.stopped = surroundings_.passing(a.problem.increment, trial_.x, Surroundings::Passing::stop) > 0;
  if (c.own_given_up) {
    c.stuck = true;
    c.report.status = SaddleStatus::iteration_limit;
  }
  bool first = !c.own_given_up;
  std::array<bool, 8> tried{};
  Method by = Method::automatic;
  for (const Rung& rung : ladder()) {
    if (!rung.applies(*this, c)) continue;
    const Allowance left = what_is_left(a.left, c.report);
    if (left.iterations <= 0 || left.factorizations <= 0) break;
    SaddleOptions options = saddle_options(context_.options, left);
    // Persistence is for what is tried last.
    options.persistent = a.left.persistent && rung.method == last && !(first && c.from_guess);
    SaddleReport next = rung.run(*this, c, options);
    judge(a.h, a.problem, next);
    next.add_work(c.report);
    c.report = std::move(next);
    by = rung.method;
    tried[static_cast<std::size_t>(by)] = true;
    const SaddleStatus status = c.report.status;
    if (first) {
      c.stuck = status != SaddleStatus::converged && status != SaddleStatus::cancelled &&
                status != SaddleStatus::out_of_memory &&
                !(a.left.keep_unfinished && leaves_iterate(c.report));
    }
    first = false;
    if (!c.stuck || status == SaddleStatus::converged) break;
  }
  for (std::size_t m = 0; m < tried.size(); ++m) {
    const bool solved = c.report.status == SaddleStatus::converged && static_cast<Method>(m) == by;
    if (tried[m]) failures_[m] = solved ? 0 : failures_[m] + 1;
  }
  if (c.report.status == SaddleStatus::converged)
    refine_gradients(a.problem, saddle_options(context_.options, a.left), c.report);
  return std::move(c.report);
}

// Conjugate gradients leave an error that counts where a body is soft, as next to a limit point; factors go
// well below the tolerance with their last iteration. A few more iterations of the former make up for that,
// and where they do not, or a budget leaves none, the solution stays as it was.
void Stepper::refine_gradients(const SaddleProblem& problem, SaddleOptions options, SaddleReport& report) {
  const Method method = context_.options.method;
  if (context_.system().dual_rows().empty() ||
      (method != Method::dual_gradients && method != Method::augmented_gradients))
    return;
  const SaddleOptions as_asked = options;
  options.force_tolerance *= 0.1;
  options.max_iterations = options.patient_iterations =
      std::min(2, options.max_iterations - report.iterations);
  if (options.max_iterations <= 0) return;
  found_.x = trial_.x;
  found_.lambda = trial_.lambda;
  const SaddleReport finer = solve(problem, options);
  report.add_work(finer);
  if (finer.status == SaddleStatus::converged) {
    report.force_residual = finer.force_residual;
    report.row_residual = finer.row_residual;
    return;
  }
  trial_.begin_at(found_.x, found_.lambda);
  // In balance already: this evaluates the state and leaves it.
  solve(problem, as_asked);
}

// Data, prediction and stencils; leaves the trial where the first solve begins.
Stepper::Attempt Stepper::begin(double h) {
  const TimeScheme& scheme = *context_.options.scheme;
  State& state = context_.state;
  Attempt a;
  a.h = h;
  const double h_evaluated = scheme.evaluated_at() * h, t_new = state.t + h_evaluated;
  a.problem = context_.data.problem(context_.system(), state, t_new);
  a.jumps = impacts_.jump(t_new, h_evaluated, trial_);
  const std::span<const double> past =
      a.jumps ? impacts_.no_past() : std::span<const double>(context_.layout.of_scheme(state.extra));
  a.problem.mass_scale = scheme.begin(state, past, h, trial_.predicted);
  for (std::size_t i = 0; i < trial_.predicted.size() && a.jumps; ++i) trial_.predicted[i] += h * trial_.x[i];
  a.problem.predicted = trial_.predicted;
  const bool dynamic = dynamic_ = a.problem.mass_scale > 0;
  if (dynamic) a.problem.increment.h = h_evaluated;
  // Inertia's guess first; where it fails (it may turn elements over, or leads through a surface) the old
  // positions are a safe start.
  a.from_guess = dynamic;
  a.around = surroundings_.renew(dynamic ? trial_.predicted : state.x, Surroundings::Around::guess);
  end_.begin(a.problem, a.jumps);
  if (a.around.crossed > 0) a.from_guess = false;
  trial_.begin_at(a.from_guess ? trial_.predicted : state.x, state.lambda);
  return a;
}

// One climb, and stencils renewed around its end; true when it has to be made once more.
bool Stepper::solve_and_renew(Attempt& a, const Allowance& allowance, int climbs) {
  const bool last = climbs + 1 == most_climbs;
  a.left = what_is_left(allowance, a.report);
  if (a.left.iterations <= 0 || a.left.factorizations <= 0) {
    a.report.status = SaddleStatus::iteration_limit;
    return false;
  }
  SaddleReport solved = climb(a);
  solved.add_work(a.report);
  a.report = std::move(solved);
  if (stuck_close_by(a.report) && !last) {
    // What is nearest has changed on the way: stencils around it have no jump there.
    a.around = surroundings_.renew(trial_.x, Surroundings::Around::guess);
    if (a.around.changed && a.around.crossed == 0) {
      a.from_guess = false;
      return true;
    }
  }
  if (a.report.status != SaddleStatus::converged) return false;
  std::vector<std::shared_ptr<const StencilPool>> solved_with;
  if (last) solved_with = context_.system().parts().stencil_pools;
  a.around = surroundings_.renew(trial_.x, Surroundings::Around::solution);
  if (a.around.passing > 0 || (a.around.crossed > 0 && last)) a.report.status = SaddleStatus::passed_through;
  if (!a.around.changed || a.report.status != SaddleStatus::converged) return false;
  // What is nearest goes to and fro, as beside an edge: the solution is kept, with the stencils that it
  // solves.
  if (last) {
    surroundings_.keep(std::move(solved_with), a.problem, a.left, trial_, a.report);
    return false;
  }
  // What was seen too late is met on the way there.
  end_.begin(a.problem, a.jumps);
  a.from_guess = false;
  if (a.around.crossed > 0) begin_at_state();
  return true;
}

// Whether an iterate that a budget cut short may become the state.
bool Stepper::may_keep(Attempt& a, const Allowance& allowance) {
  const SaddleStatus status = a.report.status;
  if (!allowance.keep_unfinished || a.report.iterations == 0 || status == SaddleStatus::diverged ||
      status == SaddleStatus::passed_through || stop_wanted_() ||
      !std::all_of(trial_.x.begin(), trial_.x.end(), finite) ||
      surroundings_.passing(a.problem.increment, trial_.x, Surroundings::Passing::count) > 0)
    return false;
  SaddleReport unfinished = a.report;
  if (!end_.admits(a.h, a.problem, trial_, unfinished)) {
    given_back_ = unfinished.message;
    return false;
  }
  a.around = surroundings_.renew(trial_.x, Surroundings::Around::solution);
  return a.around.error.empty() && a.around.crossed + a.around.passing == 0;
}

SaddleReport Stepper::attempt(double h, const Allowance& allowance) {
  given_back_.clear();
  Attempt a = begin(h);
  a.left = allowance;
  for (int climbs = 0; a.around.error.empty(); ++climbs) {
    if (!solve_and_renew(a, allowance, climbs)) break;
  }
  if (!a.around.error.empty()) {
    a.report.status = SaddleStatus::singular;
    a.report.message = a.around.error;
  }
  if (a.report.status == SaddleStatus::converged || may_keep(a, allowance)) {
    take(h, a.jumps);
  } else if (a.around.error.empty()) {
    // Stencils were renewed around positions that are not to be; results are about those of the state.
    if (auto r = surroundings_.restore(context_.pool_memory()); !r) a.report.message = r.error();
  }
  return std::move(a.report);
}

// What pools keep from one step to the next, from the positions and multipliers that the step arrived at.
void Stepper::take_memory(const StencilIncrement& increment) {
  const System& system = context_.system();
  if (system.memory() == 0) return;
  auto& extra = context_.state.extra;
  std::copy_n(extra.begin(), memory_before_.size(), memory_before_.begin());
  const std::span<const double> before = memory_before_;
  const std::span<double> after = extra;
  for (const auto& rows : system.facets().remembering_rows) {
    const auto first = at(system.first_row(rows.pool));
    const auto count = at(system.parts().row_pools[at(rows.pool)]->rows());
    rows.facet->accept({increment.t0, increment.t1, rows.in(before)},
                       std::span<const double>(trial_.lambda).subspan(first, count), rows.in(after));
  }
  const Assembly& assembly = context_.methods.chosen().assembly();
  for (const auto& stencils : system.facets().remembering) {
    StencilRequest request = assembly.request(stencils.pool, Want::value, trial_.x);
    request.increment = increment;
    request.memory = stencils.in(before);
    stencils.facet->accept(request, stencils.in(after));
  }
}

void Stepper::take_multipliers() {
  State& state = context_.state;
  std::copy(trial_.lambda.begin(), trial_.lambda.end(), state.lambda.begin());
  const auto residual = context_.methods.chosen().residual();
  std::copy(residual.begin(), residual.end(), state.reactions.begin());
}

// Makes the trial positions and multipliers the state.
void Stepper::take(double h, bool jumps) {
  const TimeScheme& scheme = *context_.options.scheme;
  State& state = context_.state;
  take_memory({dynamic_ ? h : 0, state.x, state.t, state.t + h});
  const auto past = context_.layout.of_scheme(state.extra);
  // No past in the increment itself, and none behind it: it would hold the velocities before the jump.
  if (jumps) std::fill(past.begin(), past.end(), 0.0);
  moved_ = 0;
  for (std::size_t i = 0; i < trial_.x.size(); ++i) {
    const Vec3 d = trial_.x[i] - state.x[i];
    moved_ = std::max(moved_, dot(d, d));
  }
  moved_ = std::sqrt(moved_);
  scheme.finish(h, trial_.x, trial_.predicted, state, past);
  if (jumps) std::fill(past.begin(), past.end(), 0.0);
  take_multipliers();
}

void Stepper::take_equilibrium(double t) {
  State& state = context_.state;
  take_memory({0, state.x, state.t, t});
  std::copy(trial_.x.begin(), trial_.x.end(), state.x.begin());
  take_multipliers();
  state.t = t;
  moved_ = 0;
}

}  // namespace isochor
