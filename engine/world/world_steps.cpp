// How a world advances: single steps, adaptive increments, steps within a budget, paths of equilibria.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include "engine/base/text.h"
#include "engine/step/path_follower.h"
#include "engine/world/world_impl.h"

namespace isochor {

namespace {

void accumulate(StepReport& total, const SaddleReport& r) {
  total.iterations += r.iterations;
  total.factorizations += r.factorizations;
  total.trials += r.trials;
  total.corrections += r.corrections;
  total.lagged += r.lagged;
  total.projected += r.projected;
  total.shifted += r.shifted;
  total.dual_steps += r.dual_steps;
  total.stand_ins += r.stood_in;
  total.dual_iterations += r.dual_iterations;
  total.linear_iterations += r.linear_iterations;
  total.negative_pivots = r.negative_pivots;
  total.force_residual = r.force_residual;
  total.row_residual = r.row_residual;
  total.linear_residual = std::max(total.linear_residual, r.linear_residual);
}

// Where nodes of the scene are: "nodes 3, 4 of body \"finger\"".
std::string name_nodes(std::span<const Index> nodes, const std::vector<BodyData>& bodies) {
  std::string text;
  const BodyData* named = nullptr;
  for (const Index n : nodes) {
    const auto body = std::find_if(bodies.begin(), bodies.end(), [n](const BodyData& b) {
      return n >= b.first_node && n < b.first_node + b.mesh.node_count();
    });
    if (body == bodies.end() || (named && &*body != named)) continue;
    text += (named ? ", " : nodes.size() == 1 ? "node " : "nodes ") + std::to_string(n - body->first_node);
    named = &*body;
  }
  return named ? text + " of body \"" + named->name + "\"" : std::string("a point of an effect");
}

// What a matrix that stayed singular says about the scene.
std::string singular_text(const SaddleReport& r, const std::vector<BodyData>& bodies) {
  if (r.null_nodes.empty())
    return "; rows without compliance may repeat each other or lack stabilization, or a part is not held";
  const std::string where = name_nodes(r.null_nodes, bodies);
  if (r.null_rows.empty()) {
    return "; " + where +
           " can move without any force (a mechanism, or a load at which the shape gives way): "
           "hold them, or use a dynamic scheme";
  }
  std::string rows;
  for (const std::string& name : r.null_rows) rows += (rows.empty() ? "\"" : ", \"") + name + "\"";
  return "; the rows of " + rows + " depend on each other around " + where +
         ": what one says follows from the others, or contradicts them; drop one, or give one a compliance "
         "(pressures at nodes: a stabilization)";
}

std::string failure_text(const SaddleReport& r, double t, const std::vector<BodyData>& bodies) {
  std::string text = "no equilibrium found at t = " + number(t) + ": " + std::string(to_string(r.status));
  if (!r.message.empty()) text += " (" + r.message + ")";
  if (r.status == SaddleStatus::singular) text += singular_text(r, bodies);
  return text;
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

StepReport World::Impl::invalid(std::string reason) const {
  StepReport report;
  report.status = StepStatus::invalid;
  report.reason = std::move(reason);
  report.time = state.t;
  return report;
}

// A request is taken by the step that it stops: one that comes between steps is not lost.
void World::Impl::take_cancel(StepReport& report) {
  cancel_requested = false;
  report.status = StepStatus::cancelled;
  report.reason = "cancelled by the host";
}

// A step failed from a state that a budget had left unfinished: that is no state to go on from, and the last
// one in balance takes its place.
bool World::Impl::give_back_unfinished(StepReport& report) {
  if (!settled || report.status != StepStatus::rejected) return false;
  state = *settled;
  settled.reset();
  const auto stencils = restore_stencils(std::span<const double>(state.extra).first(at(system->memory())));
  report.reason +=
      "; the step began at a state that a budget had left unfinished, so the last one in balance, of t = " +
      number(state.t) + ", is back";
  if (!stencils) report.reason += " (" + stencils.error() + ")";
  return true;
}

StepReport World::Impl::cancelled() {
  StepReport report;
  take_cancel(report);
  report.time = state.t;
  return report;
}

void World::Impl::finish_report(StepReport& report, const StageSeconds& before, double total) const {
  const StageSeconds& now = newton->seconds();
  report.seconds = {now.analyze - before.analyze,
                    now.evaluate - before.evaluate,
                    now.gather - before.gather,
                    now.factor - before.factor,
                    now.solve - before.solve,
                    now.line_search - before.line_search,
                    total};
  report.expected_negative_pivots = system->rows();
  // What was rejected says how the state is that stays.
  if (report.status != StepStatus::converged && report.status != StepStatus::unfinished) {
    const Admission::Verdict now_is = admission->look(state.x, state.x);
    report.min_J = now_is.min_J;
    report.inverted_cells = now_is.inverted;
  }
  report.time = state.t;
}

namespace {

std::string bad_length(const char* call, double h) {
  return std::string(call) + ": h = " + number(h) + "; it must be positive and finite";
}

}  // namespace

StepReport World::step(double h) {
  return step(h, {});
}

StepReport World::step(double h, const StepBudget& budget) {
  Impl& w = *impl_;
  if (auto r = w.compile(); !r) return w.invalid(r.error());
  if (!(h > 0) || !std::isfinite(h)) return w.invalid(bad_length("step", h));
  if (budget.iterations < 0 || !(budget.seconds >= 0)) {
    return w.invalid("step: a budget of " + std::to_string(budget.iterations) + " iterations and " +
                     number(budget.seconds) + " s; both must be zero (no limit) or positive");
  }
  if (w.cancel_requested) return w.cancelled();
  const auto start = std::chrono::steady_clock::now();
  const StageSeconds before = w.newton->seconds();
  w.amounts_before.clear();
  w.save_amounts(w.amounts_before);
  w.begin_amounts(w.state.t, w.state.t + h);
  if (const double turn = w.largest_turn(w.state.t, w.state.t + h); turn > 0.999 * std::numbers::pi) {
    w.load_amounts(w.amounts_before);
    return w.invalid("step: something that is prescribed turns by " + number(turn) +
                     " rad within the step; from half a turn on its end does not tell the way round: use "
                     "advance(), or steps of less than 3.14 rad");
  }
  StepReport report;
  w.led_away.clear();
  const double t_target = w.state.t + h;
  Impl::Allowance allowance{w.options.max_iterations, 10 * w.options.max_iterations,
                            budget.iterations > 0 || budget.seconds > 0};
  if (budget.iterations > 0) allowance.iterations = budget.iterations;
  if (budget.seconds > 0)
    w.deadline = start + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                             std::chrono::duration<double>(std::min(budget.seconds, 1e6)));
  const bool was_settled = !w.settled;
  if (allowance.keep_unfinished && was_settled) w.settled = w.state;
  const SaddleReport r = w.attempt(h, allowance);
  w.deadline.reset();
  accumulate(report, r);
  report.substeps = 1;
  const bool kept = w.state.t > t_target - 0.5 * h;
  if (r.status == SaddleStatus::converged) {
  } else if (kept) {
    report.status = StepStatus::unfinished;
    report.reason = "the budget ran out after " + std::to_string(r.iterations) + " iterations";
  } else if (w.asked_to_stop()) {
    w.take_cancel(report);
  } else {
    report.status = StepStatus::rejected;
    report.rejected_substeps = 1;
    report.reason = !w.given_back.empty() ? "the budget ran out after " + std::to_string(r.iterations) +
                                                " iterations, and the state is as it was: " + w.given_back +
                                                "; give more iterations or shorter steps"
                    : r.status == SaddleStatus::cancelled
                        ? "the budget ran out before there was an iterate to keep"
                        : failure_text(r, t_target, w.builder.bodies());
  }
  if (kept)
    w.describe_end(r, report);
  else
    w.load_amounts(w.amounts_before);
  // What is in balance needs nothing to fall back to, nor does what a rejected step left alone.
  if (r.status == SaddleStatus::converged || (!kept && was_settled)) w.settled.reset();
  if (w.given_back.empty() && r.status != SaddleStatus::cancelled) w.give_back_unfinished(report);
  w.finish_report(report, before, seconds_since(start));
  return report;
}

double World::Impl::largest_turn(double t0, double t1) const {
  double largest = 0;
  for (const auto& p : system->parts().prescribers) largest = std::max(largest, p->turn(t0, t1));
  for (const auto& p : system->parts().row_pools) largest = std::max(largest, p->turn(t0, t1));
  return largest;
}

// As StencilPool::entry(). A node that moves as it did and is then not run over does not count.
double World::Impl::largest_entry(double t0, double t1) {
  double largest = 0;
  for (const auto& p : system->parts().stencil_pools) {
    const double still = p->entry(t0, t1, state.x, state.x);
    if (still <= largest) continue;
    if (!options.scheme->has_inertia()) {
      largest = still;
      continue;
    }
    for (std::size_t i = 0; i < predicted.size(); ++i) predicted[i] = state.x[i] + (t1 - t0) * state.v[i];
    largest = std::max(largest, std::min(still, p->entry(t0, t1, state.x, predicted)));
  }
  return largest;
}

// Local error of the increment just accepted, from velocities before and after it: that of the scheme's
// order, root mean square over the mass, relative to the scene's length. Infinity at the first increment of a
// second order scheme would forbid it, so that one is judged as of first order.
double World::Impl::estimate_error(double h) {
  const auto memory = error_memory();
  const double h_before = memory[0];
  const bool second = options.scheme->order() >= 2 && h_before > 0;
  double sum = 0, mass = 0;
  for (std::size_t i = 0; i < state.v.size(); ++i) {
    const Vec3 now = (1 / h) * (state.v[i] - state_before.v[i]);
    Vec3 e = (0.5 * h * h) * now;
    if (second) {
      const Vec3 old{memory[2 + 3 * i], memory[3 + 3 * i], memory[4 + 3 * i]};
      const Vec3 then = (1 / h_before) * (state_before.v[i] - old);
      e = (options.scheme->error_constant() * h * h * h / (0.5 * (h + h_before))) * (now - then);
    }
    const double m = system->parts().mass[i];
    sum += m * dot(e, e);
    mass += m;
  }
  return mass > 0 && system->length() > 0 ? std::sqrt(sum / mass) / system->length() : 0;
}

// Statics that no load step brings further: a motion with damping so strong that inertia is a mere memory of
// the last position, its weight taken down as it settles, ends in the equilibrium that the body would move to
// (pseudo-transient continuation; Kelley & Keyes 1998, with the switched evolution relaxation of its step).
SaddleReport World::Impl::rescue(double h) {
  constexpr int most_steps = 60, patience = 15;
  constexpr double negligible = 1e-7;
  SaddleProblem problem = problem_at(state.t + h);
  double mass = 0, stiffness = 0;
  for (const double m : system->parts().mass) mass += m;
  for (const double k : newton->rest_stiffness()) stiffness += k;
  const double scale = mass > 0 ? stiffness / mass : 0;
  std::copy(state.x.begin(), state.x.end(), x_trial.begin());
  std::copy(state.lambda.begin(), state.lambda.end(), lambda_trial.begin());
  SaddleReport total;
  total.status = SaddleStatus::line_search_failed;
  if (!(scale > 0)) return total;
  SaddleOptions loose = saddle_options({patience, 2 * patience});
  loose.force_tolerance = 1e-5;
  loose.row_tolerance = std::max(options.row_tolerance, 1e-7);
  std::vector<Vec3> settled_x = x_trial;
  std::vector<double> settled_lambda = lambda_trial;
  double inertia = 0.1, stride = 0;
  for (int k = 0; k < most_steps && inertia < 1e6; ++k) {
    std::copy(settled_x.begin(), settled_x.end(), predicted.begin());
    problem.predicted = predicted;
    problem.mass_scale = inertia * scale;
    if (total.factorizations > options.max_iterations) break;
    SaddleReport r = newton->solve(problem, loose, x_trial, lambda_trial);
    const bool ok = r.status == SaddleStatus::converged;
    if (r.status == SaddleStatus::cancelled || r.status == SaddleStatus::out_of_memory) return r;
    r.add_work(total);
    total = r;
    if (!ok) {
      std::copy(settled_x.begin(), settled_x.end(), x_trial.begin());
      std::copy(settled_lambda.begin(), settled_lambda.end(), lambda_trial.begin());
      inertia *= 10;
      continue;
    }
    double step = 0;
    for (std::size_t i = 0; i < x_trial.size(); ++i) step = std::max(step, norm(x_trial[i] - settled_x[i]));
    std::copy(x_trial.begin(), x_trial.end(), settled_x.begin());
    std::copy(lambda_trial.begin(), lambda_trial.end(), settled_lambda.begin());
    // Motions that slow down may take longer strides; one that speeds up goes on carefully.
    inertia *= k == 0 || step > stride ? 0.5 : 0.2;
    stride = step;
    if (inertia > negligible && step > 1e-4 * system->length()) continue;
    problem.mass_scale = 0;
    SaddleReport last =
        newton->solve(problem, saddle_options({2 * patience, 4 * patience}), x_trial, lambda_trial);
    const bool found = last.status == SaddleStatus::converged;
    last.add_work(total);
    total = last;
    if (found) {
      const Surroundings around = look_around(x_trial, true);
      if (around.changed || around.passing > 0) {
        total.status = SaddleStatus::passed_through;
        // Stencils looked at positions that are not to be.
        const auto memory = std::span<const double>(state.extra).first(at(system->memory()));
        if (auto back = restore_stencils(memory); !back) total.message = back.error();
      } else if (admissible(h, problem, total)) {
        accept(h, predicted);
      }
      return total;
    }
    if (last.status == SaddleStatus::cancelled || inertia <= negligible) return total;
    std::copy(settled_x.begin(), settled_x.end(), x_trial.begin());
    std::copy(settled_lambda.begin(), settled_lambda.end(), lambda_trial.begin());
  }
  if (total.status == SaddleStatus::converged) total.status = SaddleStatus::line_search_failed;
  return total;
}

StepReport World::advance(double h) {
  Impl& w = *impl_;
  if (auto r = w.compile(); !r) return w.invalid(r.error());
  if (!(h > 0) || !std::isfinite(h)) return w.invalid(bad_length("advance", h));
  if (w.cancel_requested) return w.cancelled();
  const auto start = std::chrono::steady_clock::now();
  const StageSeconds before = w.newton->seconds();
  const double t0 = w.state.t, t_end = t0 + h;
  w.amounts_before.clear();
  w.save_amounts(w.amounts_before);
  w.begin_amounts(t0, t_end);
  StepReport report;
  w.led_away.clear();
  constexpr double largest_turn = 2;  // [rad] an increment
  const bool statics = !w.options.scheme->has_inertia(), careful = w.controls_error();
  double increment = h;
  if (careful && w.error_memory()[1] > 0) increment = std::min(h, w.error_memory()[1]);
  int successes = 1;
  while (w.state.t < t_end - 1e-12 * h) {
    // The last increment lands on the end exactly.
    const double remaining = t_end - w.state.t;
    double dt = increment > 0.999 * remaining ? remaining : increment;
    // The end of half a turn is that of half a turn the other way.
    // And what an obstacle runs over within an increment may come out on any side of it.
    while ((w.largest_turn(w.state.t, w.state.t + dt) > largest_turn ||
            w.largest_entry(w.state.t, w.state.t + dt) > 1) &&
           dt > 1e-9 * h)
      dt *= 0.5;
    // While the increment can still be cut, patience has an end, unless the solve gets somewhere; less of it
    // where the whole one failed already.
    const bool last_chance = 0.5 * dt < w.options.smallest_fraction * h;
    const int patience = successes > 0 ? 40 : 25, patience_for_factors = successes > 0 ? 70 : 35;
    if (careful) w.state_before = w.state;
    Impl::Allowance allowance{w.options.max_iterations, (last_chance ? 2 : 3) * w.options.max_iterations};
    if (!last_chance) {
      allowance.patient_iterations = patience;
      allowance.patient_factorizations = patience_for_factors;
    }
    allowance.persistent = true;
    const SaddleReport r = w.attempt(dt, allowance);
    accumulate(report, r);
    if (r.status == SaddleStatus::converged) w.describe_end(r, report);
    if (r.status == SaddleStatus::converged && careful) {
      const double error = w.estimate_error(dt);
      const double power = w.options.scheme->order() + 1.0;
      const double factor =
          error > 0 ? std::clamp(0.9 * std::pow(w.options.time_error / error, 1 / power), 0.2, 2.0) : 2.0;
      if (error > w.options.time_error && 0.5 * dt >= w.options.smallest_fraction * h) {
        w.state = w.state_before;
        ++report.error_rejections;
        increment = std::min(0.8, factor) * dt;
        continue;
      }
      report.time_error = error;
      ++report.substeps;
      increment = factor * dt;
      const auto memory = w.error_memory();
      memory[0] = dt;
      memory[1] = increment;
      for (std::size_t i = 0; i < w.state.v.size(); ++i) {
        for (int k = 0; k < 3; ++k) memory[2 + 3 * i + static_cast<std::size_t>(k)] = w.state_before.v[i][k];
      }
      continue;
    }
    if (r.status == SaddleStatus::converged) {
      ++report.substeps;
      // Behind a failure the increment grows again only after two successes in a row.
      if (++successes >= 2) increment = std::min(2 * dt, h);
      continue;
    }
    successes = 0;
    if (r.status == SaddleStatus::cancelled) {
      w.take_cancel(report);
      break;
    }
    ++report.rejected_substeps;
    increment = 0.5 * dt;
    // A matrix that is singular where the increment begins stays so however short it is: rows that depend on
    // each other for good, a mechanism until it has inertia.
    const bool singular = r.status == SaddleStatus::singular && r.iterations == 0;
    const bool hopeless = r.status == SaddleStatus::out_of_memory || (singular && !r.null_rows.empty());
    const bool as_short_as_need_be = increment < w.options.smallest_fraction * h || (singular && statics);
    if (!as_short_as_need_be && !hopeless) continue;
    if (statics && !hopeless && w.options.transient_rescue && report.rescues < 3) {
      const SaddleReport rescued = w.rescue(dt);
      accumulate(report, rescued);
      if (rescued.status == SaddleStatus::converged) {
        w.describe_end(rescued, report);
        ++report.substeps;
        ++report.rescues;
        increment = dt;
        continue;
      }
      if (rescued.status == SaddleStatus::cancelled) {
        w.take_cancel(report);
        break;
      }
    }
    report.status = StepStatus::rejected;
    report.reason = failure_text(r, w.state.t + dt, w.builder.bodies());
    if (r.status != SaddleStatus::singular && !hopeless) {
      report.reason +=
          "; increments shrank to " + number(increment / h) +
          " of the step, the last equilibrium is at t = " + number(w.state.t) +
          (w.system->has_bounds()
               ? ": the solver found no way on, which where things touch need not mean that there is none; "
                 "more "
                 "steps, finer or rounder surfaces may help"
               : ": there may be none beyond (a limit point, or a load that nothing can carry), or none "
                 "that this method reaches; try more steps, another method, or continuation() in statics");
    }
    break;
  }
  if (report.status == StepStatus::converged) w.state.t = t_end;
  if (report.substeps > 0) w.settled.reset();
  w.give_back_unfinished(report);
  if (w.state.t == t0) w.load_amounts(w.amounts_before);  // nothing was advanced
  w.finish_report(report, before, seconds_since(start));
  return report;
}

void World::cancel() {
  impl_->cancel_requested = true;
}

StepReport World::follow(double length) {
  Impl& w = *impl_;
  if (auto r = w.compile(); !r) return w.invalid(r.error());
  auto* follower = dynamic_cast<PathFollower*>(w.newton.get());
  if (!follower) {
    return w.invalid("follow: the scheme of this world is " + std::string(w.options.scheme->name()) +
                     "; use continuation() of isochor/schemes.h");
  }
  if (!(length > 0) || !std::isfinite(length)) return w.invalid(bad_length("follow", length));
  constexpr int most_halvings = 10, patience = 12;
  constexpr double load_weight = 0.1;  // of the scene's length
  if (w.cancel_requested) return w.cancelled();
  const auto start = std::chrono::steady_clock::now();
  const StageSeconds before = w.newton->seconds();
  StepReport report;
  const auto problem_at = [&w](double t) { return w.problem_at(t); };
  SaddleReport r;
  for (int halving = 0; halving <= most_halvings; ++halving, length *= 0.5) {
    double t = w.state.t;
    std::copy(w.state.x.begin(), w.state.x.end(), w.x_trial.begin());
    std::copy(w.state.lambda.begin(), w.state.lambda.end(), w.lambda_trial.begin());
    r = follower->follow(problem_at, length, load_weight * w.system->length(),
                         w.saddle_options({patience, patience}), w.x_trial, w.lambda_trial, t,
                         w.scheme_memory());
    accumulate(report, r);
    if (r.status == SaddleStatus::converged) {
      w.verdict = w.admission->look(w.state.x, w.x_trial);
      if (w.verdict.forbidden > 0) {
        r.status = SaddleStatus::inadmissible;
        r.message = w.admission->refusal(w.verdict);
        ++report.rejected_substeps;
        continue;
      }
      w.accept_memory({0, w.state.x, w.state.t, t});
      std::copy(w.x_trial.begin(), w.x_trial.end(), w.state.x.begin());
      std::copy(w.lambda_trial.begin(), w.lambda_trial.end(), w.state.lambda.begin());
      std::copy(w.newton->residual().begin(), w.newton->residual().end(), w.reactions.begin());
      w.state.t = t;
      w.moved = 0;
      w.describe_end(r, report);
      report.substeps = 1;
      if (r.negative_pivots >= 0) report.unstable_directions = r.negative_pivots - w.system->rows();
      break;
    }
    ++report.rejected_substeps;
    if (r.status == SaddleStatus::cancelled || r.status == SaddleStatus::not_finite ||
        r.status == SaddleStatus::out_of_memory)
      break;
  }
  if (r.status == SaddleStatus::cancelled) {
    w.take_cancel(report);
  } else if (r.status != SaddleStatus::converged) {
    report.status = StepStatus::rejected;
    report.reason = "no equilibrium found along the path from t = " + number(w.state.t) + ": " +
                    std::string(to_string(r.status)) + (r.message.empty() ? "" : " (" + r.message + ")") +
                    "; the path may end here (loads that do not change any more, a fold with contact)";
  }
  w.finish_report(report, before, seconds_since(start));
  return report;
}

}  // namespace isochor
