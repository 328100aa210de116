#include "engine/step/controller.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/out_of_memory.h"
#include "engine/base/text.h"
#include "engine/step/step_report.h"
#include "engine/step/time_scheme.h"

namespace isochor {

struct Controller::Clock {
  explicit Clock(const StageSeconds& now) : before(now) {}
  double total() const { return std::chrono::duration<double>(Interrupt::Clock::now() - start).count(); }
  Interrupt::Clock::time_point start = Interrupt::Clock::now();
  StageSeconds before;
};

namespace {

std::string bad_length(const char* call, double h) {
  return std::string(call) + ": h = " + number(h) + "; it must be positive and finite";
}

// Whether a matrix is singular where the increment begins: it stays so however short that is. Rows that
// depend on each other do for good, a mechanism until it has inertia.
bool singular_at_once(const SaddleReport& r) {
  return r.status == SaddleStatus::singular && r.iterations == 0;
}

}  // namespace

Controller::Controller(const StepContext& context, Amounts& amounts, Interrupt& interrupt,
                       std::optional<State>& settled)
    : context_(context),
      amounts_(amounts),
      interrupt_(interrupt),
      stepper_(context),
      time_error_(context),
      settled_(settled) {
  if (context_.options.scheme->has_inertia()) ahead_.resize(context_.state.x.size());
  stepper_.set_stop_wanted([this] { return interrupt_.wanted(); });
}

double Controller::largest_turn(double t0, double t1) const {
  double largest = 0;
  for (const auto& p : context_.system().parts().prescribers) largest = std::max(largest, p->turn(t0, t1));
  for (const auto& rows : context_.system().facets().turning)
    largest = std::max(largest, rows.facet->turn(t0, t1));
  return largest;
}

// As BarrierStencils::intrusion(). A node that moves as it did and is then not run over does not count.
double Controller::largest_intrusion(double t0, double t1) {
  const State& state = context_.state;
  double largest = 0;
  for (const auto& [pool, barrier] : context_.system().facets().barriers) {
    const double still = barrier->intrusion(t0, t1, state.x, state.x);
    if (still <= largest) continue;
    if (ahead_.empty()) {
      largest = still;
      continue;
    }
    for (std::size_t i = 0; i < ahead_.size(); ++i) ahead_[i] = state.x[i] + (t1 - t0) * state.v[i];
    largest = std::max(largest, std::min(still, barrier->intrusion(t0, t1, state.x, ahead_)));
  }
  return largest;
}

// In dynamics a new value holds from the next step on; statics ramps to it.
void Controller::begin_amounts(double t0, double t1) {
  amounts_before_.clear();
  amounts_.save(amounts_before_);
  amounts_began_ = true;
  amounts_.begin(t0, t1, !context_.options.scheme->has_inertia());
}

void Controller::take_cancel(StepReport& report) {
  interrupt_.take();
  report.status = StepStatus::cancelled;
  report.reason = "cancelled by the host";
}

StepReport Controller::cancelled() {
  StepReport report;
  take_cancel(report);
  report.time = context_.state.t;
  return report;
}

// A step failed from a state that a budget had left unfinished: that is no state to go on from, and the last
// one in balance takes its place.
bool Controller::give_back_unfinished(StepReport& report) {
  if (!settled_ || report.status != StepStatus::rejected) return false;
  std::vector<Vec3> forces = std::move(context_.state.forces);
  context_.state = *settled_;
  context_.state.forces = std::move(forces);  // those are the host's
  settled_.reset();
  const auto stencils = stepper_.surroundings().restore(context_.pool_memory());
  report.reason +=
      "; the step began at a state that a budget had left unfinished, so the last one in balance, of t = " +
      number(context_.state.t) + ", is back";
  if (!stencils) report.reason += " (" + stencils.error() + ")";
  return true;
}

// Memory may run out anywhere in a step. Its work is on a trial, so that the state is none the worse for it:
// amounts go back where nothing was advanced, and what solves, which may be half made, is dropped for the
// next call to make again. False where the state had gone on by then.
bool Controller::give_back_memory(double t0, bool was_settled) {
  interrupt_.set_deadline({});
  context_.methods.drop();
  if (context_.state.t != t0) return false;
  if (amounts_began_) amounts_.load(amounts_before_);
  if (was_settled) settled_.reset();
  return true;
}

// `once`: of a single step, which has arrived where the state has gone on.
template <class Steps>
StepReport Controller::within_memory(const char* call, bool once, Steps&& steps) {
  const Clock clock(context_.methods.chosen().seconds());
  const double t0 = context_.state.t;
  const bool was_settled = !settled_;
  amounts_began_ = memory_ran_out_ = false;
  StepReport report;
  try {
    steps(report);
    if (report.status != StepStatus::invalid) finish(clock, report);
    if (memory_ran_out_) context_.methods.drop();
  } catch (const std::bad_alloc&) {
    const bool went_on = !give_back_memory(t0, was_settled);
    if (!once || !went_on) report.status = StepStatus::rejected;
    if (report.status != StepStatus::converged) report.reason = out_of_memory(call);
    report.seconds.total = clock.total();
    report.time = context_.state.t;
  }
  return report;
}

void Controller::add(StepReport& total, const SaddleReport& r) {
  add_solve(total, r);
  memory_ran_out_ = memory_ran_out_ || r.status == SaddleStatus::out_of_memory;
}

void Controller::finish(const Clock& clock, StepReport& report) {
  report.seconds = context_.methods.chosen().seconds();
  report.seconds -= clock.before;
  report.seconds.total = clock.total();
  report.expected_negative_pivots = context_.system().rows();
  report.time = context_.state.t;
  // What was rejected says how the state is that stays.
  if (report.status != StepStatus::converged && report.status != StepStatus::unfinished) {
    const Admission::Verdict now = stepper_.end().judge_state();
    report.min_J = now.min_J;
    report.inverted_cells = now.inverted;
  }
}

SaddleReport Controller::attempt_within(double h, const StepBudget& budget) {
  const int usual = context_.options.max_iterations;
  Allowance allowance{usual, 10 * usual, budget.iterations > 0 || budget.seconds > 0};
  if (budget.iterations > 0) allowance.iterations = budget.iterations;
  if (budget.seconds > 0) {
    constexpr double longest = 1e6;  // [s]
    interrupt_.set_deadline(Interrupt::Clock::now() +
                            std::chrono::duration_cast<Interrupt::Clock::duration>(
                                std::chrono::duration<double>(std::min(budget.seconds, longest))));
  }
  if (allowance.keep_unfinished && !settled_) settled_ = context_.state;
  SaddleReport r = stepper_.attempt(h, allowance);
  interrupt_.set_deadline({});
  return r;
}

// Status and reason of a single step that did not converge.
void Controller::describe_single(const SaddleReport& solve, double t_target, StepReport& report) {
  const std::string after = "the budget ran out after " + std::to_string(solve.iterations) + " iterations";
  if (report.status == StepStatus::unfinished) {
    report.reason = after;
    return;
  }
  if (interrupt_.wanted()) {
    take_cancel(report);
    return;
  }
  report.status = StepStatus::rejected;
  report.rejected_substeps = 1;
  if (!stepper_.given_back().empty())
    report.reason = after + ", and the state is as it was: " + stepper_.given_back() +
                    "; give more iterations or shorter steps";
  else if (solve.status == SaddleStatus::cancelled)
    report.reason = "the budget ran out before there was an iterate to keep";
  else
    report.reason = failure_text(solve, t_target, context_.bodies);
}

StepReport Controller::step(double h, const StepBudget& budget) {
  const State& state = context_.state;
  if (!(h > 0) || !std::isfinite(h)) return invalid_step(bad_length("step", h), state.t);
  if (budget.iterations < 0 || !(budget.seconds >= 0)) {
    return invalid_step("step: a budget of " + std::to_string(budget.iterations) + " iterations and " +
                            number(budget.seconds) + " s; both must be zero (no limit) or positive",
                        state.t);
  }
  if (interrupt_.requested()) return cancelled();
  return within_memory("step", true, [&](StepReport& report) { step_once(h, budget, report); });
}

void Controller::step_once(double h, const StepBudget& budget, StepReport& report) {
  State& state = context_.state;
  begin_amounts(state.t, state.t + h);
  if (const double turn = largest_turn(state.t, state.t + h); turn > 0.999 * std::numbers::pi) {
    amounts_.load(amounts_before_);
    report = invalid_step("step: something that is prescribed turns by " + number(turn) +
                              " rad within the step; from half a turn on its end does not tell the way "
                              "round: use advance(), or steps of less than 3.14 rad",
                          state.t);
    return;
  }
  stepper_.begin_step();
  stepper_.end().begin_step();
  const double t_target = state.t + h;
  const bool was_settled = !settled_;
  const SaddleReport r = attempt_within(h, budget);
  add(report, r);
  report.substeps = 1;
  const bool kept = state.t > t_target - 0.5 * h;
  if (kept && r.status != SaddleStatus::converged) report.status = StepStatus::unfinished;
  if (r.status != SaddleStatus::converged) describe_single(r, t_target, report);
  if (kept)
    stepper_.end().describe(r, stepper_.moved(), report);
  else
    amounts_.load(amounts_before_);
  // What is in balance needs nothing to fall back to, nor does what a rejected step left alone.
  if (r.status == SaddleStatus::converged || (!kept && was_settled)) settled_.reset();
  if (stepper_.given_back().empty() && r.status != SaddleStatus::cancelled) give_back_unfinished(report);
}

// advance() on its way.
struct Controller::Advance {
  double h, t0, t_end;
  double increment;   // that is tried next
  int successes = 1;  // in a row
  double lost = 0;    // work in increments that failed, in factorizations
  StepReport& report;
};

// Of the next increment: what is left at most; and no more than a turn or an intrusion allows.
double Controller::next_length(const Advance& a) {
  constexpr double most_turn = 2;  // [rad] an increment
  const double t = context_.state.t, remaining = a.t_end - t;
  // The last increment lands on the end exactly.
  double dt = a.increment > 0.999 * remaining ? remaining : a.increment;
  // The end of half a turn is that of half a turn the other way. And what an obstacle runs over within an
  // increment may come out on any side of it.
  while ((largest_turn(t, t + dt) > most_turn || largest_intrusion(t, t + dt) > 1) && dt > 1e-9 * a.h)
    dt *= 0.5;
  return dt;
}

// Whether increments that failed took so much work that no more are tried, however short they might get.
bool Controller::lost_too_much(const Advance& a) const {
  constexpr int few = 5;
  constexpr double most = 30;  // factorizations for each iteration that an increment may take
  return a.report.rejected_substeps > few && a.lost > most * context_.options.max_iterations;
}

// One increment; false when the advance is over.
bool Controller::make_increment(Advance& a) {
  const double dt = next_length(a);
  const int usual = context_.options.max_iterations;
  // While the increment can still be cut, patience has an end, unless the solve gets somewhere; less of it
  // where the whole one failed already.
  const bool last_chance = 0.5 * dt < context_.options.smallest_fraction * a.h;
  Allowance allowance{usual, (last_chance ? 2 : 3) * usual};
  if (!last_chance) {
    allowance.patient_iterations = a.successes > 0 ? 40 : 25;
    allowance.patient_factorizations = a.successes > 0 ? 70 : 35;
  }
  allowance.persistent = true;
  time_error_.begin();
  const SaddleReport r = stepper_.attempt(dt, allowance);
  add(a.report, r);
  return r.status == SaddleStatus::converged ? took_increment(a, dt, r) : go_on_after_failure(a, dt, r);
}

bool Controller::took_increment(Advance& a, double dt, const SaddleReport& solve) {
  stepper_.end().describe(solve, stepper_.moved(), a.report);
  if (!time_error_.controls()) {
    ++a.report.substeps;
    // Behind a failure the increment grows again only after two successes in a row.
    if (++a.successes >= 2) a.increment = std::min(2 * dt, a.h);
    return true;
  }
  const TimeError::Outcome o = time_error_.judge(dt);
  if (o.too_large && 0.5 * dt >= context_.options.smallest_fraction * a.h) {
    time_error_.take_back();
    ++a.report.error_rejections;
    a.increment = std::min(0.8, o.factor) * dt;
    return true;
  }
  a.report.time_error = o.error;
  ++a.report.substeps;
  // As short as increments may get, errors are taken as they are.
  a.increment = std::max(o.factor * dt, std::min(dt, context_.options.smallest_fraction * a.h));
  time_error_.keep(dt, a.increment);
  return true;
}

bool Controller::go_on_after_failure(Advance& a, double dt, const SaddleReport& solve) {
  a.successes = 0;
  if (solve.status == SaddleStatus::cancelled) {
    take_cancel(a.report);
    return false;
  }
  ++a.report.rejected_substeps;
  a.increment = 0.5 * dt;
  a.lost += solve.work();
  const bool statics = !context_.options.scheme->has_inertia();
  const bool singular = singular_at_once(solve);
  const bool hopeless = solve.status == SaddleStatus::out_of_memory || (singular && !solve.null_rows.empty());
  const bool as_short_as_need_be =
      a.increment < context_.options.smallest_fraction * a.h || (singular && statics);
  if (!as_short_as_need_be && !hopeless && !lost_too_much(a)) return true;
  constexpr int most_rescues = 3;
  if (statics && !hopeless && context_.options.transient_rescue && a.report.rescues < most_rescues) {
    if (rescued(a, dt)) return true;
    if (a.report.status == StepStatus::cancelled) return false;
  }
  give_up(a, dt, solve, hopeless);
  return false;
}

bool Controller::rescued(Advance& a, double dt) {
  const SaddleReport r = stepper_.damped_motion(dt);
  add(a.report, r);
  if (r.status == SaddleStatus::cancelled) take_cancel(a.report);
  if (r.status != SaddleStatus::converged) return false;
  stepper_.end().describe(r, stepper_.moved(), a.report);
  ++a.report.substeps;
  ++a.report.rescues;
  a.increment = dt;
  return true;
}

void Controller::give_up(Advance& a, double dt, const SaddleReport& solve, bool hopeless) {
  const double t = context_.state.t;
  a.report.status = StepStatus::rejected;
  a.report.reason = failure_text(solve, t + dt, context_.bodies);
  if (solve.status == SaddleStatus::singular || hopeless) return;
  a.report.reason +=
      "; increments shrank to " + number(a.increment / a.h) +
      " of the step, the last equilibrium is at t = " + number(t) +
      (lost_too_much(a) && a.increment >= context_.options.smallest_fraction * a.h
           ? ": increments that failed took as much work as " + std::to_string(std::lround(a.lost)) +
                 " factorizations, and no more of them are tried; take more steps, or another method"
       : context_.system().has_bounds()
           ? ": the solver found no way on, which where things touch need not mean that there is none; "
             "more "
             "steps, finer or rounder surfaces may help"
           : ": there may be none beyond (a limit point, or a load that nothing can carry), or none "
             "that this method reaches; try more steps, another method, or continuation() in statics");
}

StepReport Controller::advance(double h) {
  if (!(h > 0) || !std::isfinite(h)) return invalid_step(bad_length("advance", h), context_.state.t);
  if (interrupt_.requested()) return cancelled();
  return within_memory("advance", false, [&](StepReport& report) { advance_by(h, report); });
}

void Controller::advance_by(double h, StepReport& report) {
  State& state = context_.state;
  Advance a{h, state.t, state.t + h, h, 1, 0, report};
  begin_amounts(a.t0, a.t_end);
  stepper_.begin_step();
  stepper_.end().begin_step();
  if (time_error_.controls() && time_error_.suggested() > 0)
    a.increment = std::min(h, time_error_.suggested());
  while (state.t < a.t_end - 1e-12 * h) {
    if (!make_increment(a)) break;
  }
  if (report.status == StepStatus::converged) state.t = a.t_end;
  if (report.substeps > 0) settled_.reset();
  give_back_unfinished(report);
  if (state.t == a.t0) amounts_.load(amounts_before_);  // nothing was advanced
}

// A step along the path from the state; the state is its end where it converges to one that may be.
SaddleReport Controller::follow_once(double length, StepReport& report) {
  constexpr int patience = 12;
  constexpr double load_weight = 0.1;  // of the scene's length
  State& state = context_.state;
  const auto problem_at = [this](double t) {
    return context_.data.problem(context_.system(), context_.state, t);
  };
  double t = state.t;
  stepper_.begin_at_state();
  Trial& trial = stepper_.trial();
  SaddleReport r = context_.methods.path_follower()->follow(
      problem_at, length, load_weight * context_.system().length(),
      saddle_options(context_.options, Allowance{patience, patience}), trial.x, trial.lambda, t,
      context_.layout.of_scheme(state.extra));
  add(report, r);
  if (r.status == SaddleStatus::converged && stepper_.end().admits_cells(trial.x, r)) {
    stepper_.take_equilibrium(t);
    stepper_.end().describe(r, 0, report);
    report.substeps = 1;
    if (r.negative_pivots >= 0) report.unstable_directions = r.negative_pivots - context_.system().rows();
  } else {
    ++report.rejected_substeps;
  }
  return r;
}

StepReport Controller::follow(double length) {
  const State& state = context_.state;
  if (!context_.methods.path_follower()) {
    return invalid_step("follow: the scheme of this world is " +
                            std::string(context_.options.scheme->name()) +
                            "; use continuation() of isochor/schemes.h",
                        state.t);
  }
  if (!(length > 0) || !std::isfinite(length)) return invalid_step(bad_length("follow", length), state.t);
  if (interrupt_.requested()) return cancelled();
  return within_memory("follow", true, [&](StepReport& report) { follow_by(length, report); });
}

void Controller::follow_by(double length, StepReport& report) {
  constexpr int most_halvings = 10;
  SaddleReport r;
  for (int halving = 0; halving <= most_halvings; ++halving, length *= 0.5) {
    r = follow_once(length, report);
    if (r.status == SaddleStatus::converged || r.status == SaddleStatus::cancelled ||
        r.status == SaddleStatus::not_finite || r.status == SaddleStatus::out_of_memory)
      break;
  }
  if (r.status == SaddleStatus::cancelled) {
    take_cancel(report);
  } else if (r.status != SaddleStatus::converged) {
    report.status = StepStatus::rejected;
    report.reason = "no equilibrium found along the path from t = " + number(context_.state.t) + ": " +
                    std::string(to_string(r.status)) + (r.message.empty() ? "" : " (" + r.message + ")") +
                    "; the path may end here (loads that do not change any more, a fold with contact)";
  }
}

}  // namespace isochor
