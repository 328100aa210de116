#include "engine/solve/newton/newton.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace isochor {

Newton::Newton(std::shared_ptr<const System> system, const Parallel& parallel,
               std::unique_ptr<LinearSolver> solver)
    : SaddlePoint(system, parallel, std::move(solver)), merit_(evaluator_) {
  const System& s = *system;
  const std::size_t n = at(s.nodes()), m = at(s.rows());
  step_.dx.resize(n);
  step_.lambda.resize(m);
  uphill_.x.resize(n);
  uphill_.lambda.resize(m);
  uphill_.step = step_;
  work_.row.resize(m);
  work_.row_rhs.resize(m);
  work_.node.resize(n);
  work_.node_rhs.resize(n);
  work_.force.resize(n);
  if (s.has_bounds()) {
    held_.held.assign(m, 0);
    held_.bound.assign(m, 0);
  }
  held_.way.assign(s.has_bounds() || s.has_lag() ? m : 0, 0);
  if (s.has_lag()) part_.emplace(system, parallel);
  moves_bounds_ = kkt_.coupled_possible() && s.has_bounds();
  if (kkt_.coupled_possible() && (part_ || moves_bounds_)) kkt_.prepare_coupled();
}

void Newton::begin_search() {
  inexact_ = inexact_direction;
  held_.any = false;
  watchdog_ = {};
  pace_ = {};
  merit_.begin();
}

void Newton::evaluate_here(const SaddleProblem& p) {
  const Stopwatch watch(seconds_.evaluate);
  evaluator_.renew_lag(p, now_);
  evaluator_.evaluate(p, Want::hessian, matrix_.definiteness(), now_);
}

// A prescribed motion that a step could not make whole rests until the body has come after it: what is left
// of the way is asked for again from a state near balance. Otherwise a long way ends at elements about to
// turn over, where no step leads on.
void Newton::rest_gap(const SaddleReport& report) {
  if (!pace_.resting || !gap_.open) return;
  constexpr double near = 1e-2;
  if (report.force_residual <= near && report.row_residual <= near) {
    pace_.resting = false;
    return;
  }
  gap_.open = false;
  std::fill(gap_.way.begin(), gap_.way.end(), Vec3{});
}

bool Newton::left_all_bounds() const {
  const System& s = system();
  const Vec3 origin = s.nodes() > 0 ? s.parts().rest[0] : Vec3{};
  return !std::all_of(now_.x.begin(), now_.x.end(), [&](const Vec3& xi) {
    const Vec3 d = xi - origin;
    return dot(d, d) <= 1e8 * s.length() * s.length();
  });
}

// At the limits; or beyond those of patience while fewer than half of the last eight steps were whole.
// Inertia bounds the energy of an increment from below, however long it is. So a body in motion has an
// equilibrium to arrive at, and a solve whose steps go down in the merit (no set of held rows, no lag that
// may cycle) mostly gets there in less work than the shorter increments would take that replace it.
bool Newton::out_of_patience(const SaddleOptions& o, int iteration, int factorizations) const {
  constexpr int persistence = 5;
  if (o.persistent && evaluator_.mass_scale() > 0 && !system().has_bounds() && !system().has_lag())
    return iteration >= persistence * o.max_iterations ||
           factorizations >= persistence * o.max_factorizations;
  if (iteration >= o.max_iterations || factorizations >= o.max_factorizations) return true;
  if (iteration < o.patient_iterations && factorizations < o.patient_factorizations) return false;
  return std::popcount(pace_.full_steps) < 4;
}

// What touches at corners of faces may jump from one to the next and back in whole steps, each of which goes
// downhill in the merit of its own multipliers. A residual that comes back tells; shorter steps end in
// between.
void Newton::damp_cycles(const SaddleReport& report) {
  constexpr double same = 1e-3, shortest = 0.125, left = 0.1;
  const double now = report.force_residual;
  auto& past = pace_.past_residuals;
  if (now < left * pace_.cycle) {
    pace_.damping = 1;
    pace_.cycle = 0;
  }
  // The last one may be as large where steps are short.
  const bool returns = std::any_of(past.begin() + 1, past.end(), [now](double before) {
    return before > 0 && std::abs(now - before) < same * now;
  });
  if (returns && full_step_) {
    pace_.damping = std::max(shortest, 0.5 * pace_.damping);
    pace_.cycle = pace_.cycle > 0 ? std::min(pace_.cycle, now) : now;
  } else if (returns && pace_.damping < 1 && pace_.damping > shortest) {
    pace_.damping *= 0.5;
  }
  std::rotate(past.begin(), past.end() - 1, past.end());
  past[0] = now;
}

SaddleReport Newton::solve_from_here(const SaddleProblem& p, const SaddleOptions& options) {
  SaddleReport report;
  const auto fail = [&](SaddleStatus status) {
    report.status = failed_as(status);
    return report;
  };
  begin_search();
  const System& s = system();
  bool unmended = s.renews_stencils() && p.mass_scale == 0;
  double before = 0;
  for (int iteration = 0;; ++iteration) {
    evaluate_here(p);
    if (iteration == 0 && !std::isfinite(now_.energy)) return fail(SaddleStatus::not_finite);
    evaluator_.find_gap(p, now_.x, gap_);
    rest_gap(report);
    if (interrupted()) return fail(SaddleStatus::cancelled);
    if (out_of_patience(options, iteration, report.factorizations) ||
        report.inner_work() >= options.most_inner_work())
      return fail(SaddleStatus::iteration_limit);
    // A state that is already in balance stays to the last bit.
    if ((iteration == 0 || s.has_lag()) && evaluator_.balanced(p, options, now_, report)) return report;
    if (s.has_bounds()) hold_rows(iteration == 0 ? Rows::first : Rows::later);
    if (!s.laws().empty()) evaluator_.apply_laws(p, now_.lambda, true);
    unmended = unmended && (iteration == 0 || (full_step_ && report.force_residual < 0.5 * before));
    before = gap_.open ? std::numeric_limits<double>::infinity() : report.force_residual;
    if (!find_direction(p, unmended, report))
      return fail(report.status == SaddleStatus::converged ? SaddleStatus::singular : report.status);
    ++report.iterations;
    if (!(watchdog_.watching() && watch(p, report)) && !search(p, report) && !search_exactly(p, report))
      return fail(SaddleStatus::line_search_failed);
    pace_.full_steps = static_cast<std::uint8_t>(pace_.full_steps << 1 | (full_step_ ? 1 : 0));
    // Steps that short lead nowhere; the work is better spent on a shorter increment, or on other stencils.
    if (pace_.creeping == 3) return fail(SaddleStatus::line_search_failed);
    const bool done = evaluator_.balanced(p, options, now_, report) && !s.has_lag();
    if (s.has_bounds()) damp_cycles(report);
    if (progress) progress(report.iterations, report.force_residual, report.row_residual);
    // With a lag, balance counts only once it is renewed. Corrections improve what is in balance.
    if (correct(p, options, report) || done) return report;
    if (left_all_bounds()) return fail(SaddleStatus::diverged);
  }
}

}  // namespace isochor
