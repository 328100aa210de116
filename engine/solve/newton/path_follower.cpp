#include "engine/solve/newton/path_follower.h"

#include <algorithm>
#include <cmath>

namespace isochor {

PathFollower::PathFollower(std::shared_ptr<const System> system, const Parallel& parallel,
                           std::unique_ptr<LinearSolver> solver)
    : Newton(system, parallel, std::move(solver)) {
  for (PathVector* v : {&correction_, &slope_, &tangent_}) {
    v->x.resize(at(system->nodes()));
    v->lambda.resize(at(system->rows()));
  }
}

double PathFollower::product(const PathVector& a, const PathVector& b) const {
  double sum = 0;
  for (std::size_t i = 0; i < a.x.size(); ++i) sum += dot(a.x[i], b.x[i]);
  return sum / static_cast<double>(std::max<std::size_t>(a.x.size(), 1)) +
         load_weight_ * load_weight_ * a.t * b.t;
}

// Evaluates and factors at now_ and t as it is and leaves the Newton step at fixed t in correction_.
bool PathFollower::factor_here(const ProblemAt& problem_at, double t, SaddleReport& report) {
  if (!factor_as_is(problem_at(t), report)) return false;
  if (!direction(report)) {
    report.status = SaddleStatus::singular;
    return false;
  }
  std::copy(step_.dx.begin(), step_.dx.end(), correction_.x.begin());
  for (std::size_t r = 0; r < now_.lambda.size(); ++r)
    correction_.lambda[r] = step_.lambda[r] - now_.lambda[r];
  return true;
}

// d(x, lambda)/dt at fixed residual, into slope_: the difference of the Newton steps for the loads at t +
// step and at t (correction_), both with the factors at hand.
bool PathFollower::slope(const ProblemAt& problem_at, double t, double step, SaddleReport& report) {
  if (!step_as_is(problem_at(t + step), report)) return false;
  for (std::size_t i = 0; i < step_.dx.size(); ++i)
    slope_.x[i] = (1 / step) * (step_.dx[i] - correction_.x[i]);
  for (std::size_t r = 0; r < now_.lambda.size(); ++r)
    slope_.lambda[r] = (step_.lambda[r] - now_.lambda[r] - correction_.lambda[r]) / step;
  slope_.t = 1;
  return true;
}

// The unit tangent at now_ and t; false where there is none. The direction of the last step says where
// forward is; from rest it is up.
bool PathFollower::find_tangent(const ProblemAt& problem_at, double t, std::span<const double> secant,
                                SaddleReport& report) {
  if (!factor_here(problem_at, t, report)) return false;
  if (!slope(problem_at, t, forward(secant) * load_difference, report)) return false;
  tangent_ = slope_;
  double length = std::sqrt(product(tangent_, tangent_));
  if (!(length > 0) || !std::isfinite(length)) {
    report.status = SaddleStatus::singular;
    return false;
  }
  double along = load_weight_ * load_weight_ * tangent_.t * secant.back(), size = std::abs(secant.back());
  for (std::size_t i = 0; i < tangent_.x.size(); ++i) {
    const Vec3 s{secant[3 * i], secant[3 * i + 1], secant[3 * i + 2]};
    along += dot(tangent_.x[i], s) / static_cast<double>(tangent_.x.size());
    size = std::max(size, std::abs(s.x) + std::abs(s.y) + std::abs(s.z));
  }
  if ((size > 0 ? along : tangent_.t) < 0) length = -length;
  for (Vec3& v : tangent_.x) v = (1 / length) * v;
  for (double& v : tangent_.lambda) v /= length;
  tangent_.t /= length;
  return true;
}

void PathFollower::move(double part, const PathVector& v, double& t) {
  for (std::size_t i = 0; i < v.x.size(); ++i) now_.x[i] += part * v.x[i];
  for (std::size_t r = 0; r < v.lambda.size(); ++r) now_.lambda[r] += part * v.lambda[r];
  t += part * v.t;
}

// Back to the path, in the plane across the tangent.
bool PathFollower::correct_across(const ProblemAt& problem_at, double step, double& t, SaddleReport& report) {
  correction_.t = 0;
  if (!slope(problem_at, t, step, report)) return false;
  const double across = product(tangent_, slope_);
  if (across == 0) {
    report.status = SaddleStatus::singular;
    return false;
  }
  const double dt = -product(tangent_, correction_) / across;
  move(1, correction_, t);
  move(dt, slope_, t);
  evaluator_.clamp(now_.lambda);
  report.step = 0;
  for (std::size_t i = 0; i < slope_.x.size(); ++i)
    report.step = std::max(report.step, norm(correction_.x[i] + dt * slope_.x[i]));
  if (report.step > 10 * system().length()) report.status = SaddleStatus::diverged;
  return report.status == SaddleStatus::converged;
}

SaddleReport PathFollower::follow(const ProblemAt& problem_at, double length, double load_weight,
                                  const SaddleOptions& options, std::span<Vec3> x, std::span<double> lambda,
                                  double& t, std::span<double> secant) {
  SaddleReport report;
  const auto fail = [&](SaddleStatus status) {
    report.status = status;
    return report;
  };
  kkt_.linear_solver().begin_solve();
  evaluator_.begin(problem_at(t));
  matrix_.begin(Definiteness::exact);
  held_.any = false;
  load_weight_ = load_weight;
  now_.set(x, lambda);
  if (!find_tangent(problem_at, t, secant, report)) return report;
  double t_now = t;
  move(length, tangent_, t_now);
  evaluator_.clamp(now_.lambda);
  double first = -1;
  for (int iteration = 0;; ++iteration) {
    if (interrupted()) return fail(SaddleStatus::cancelled);
    if (!factor_here(problem_at, t_now, report)) return report;
    if (!std::isfinite(now_.energy)) return fail(SaddleStatus::line_search_failed);
    const bool done = evaluator_.balanced(problem_at(t_now), options, now_, report) && iteration > 0;
    if (progress && iteration > 0) progress(iteration, report.force_residual, report.row_residual);
    if (done) break;
    const double size = report.force_residual + report.row_residual;
    if (first < 0) first = size;
    if (iteration >= options.max_iterations) return fail(SaddleStatus::iteration_limit);
    if (!std::isfinite(size) || size > 1e3 * std::max(first, 1e-6)) return fail(SaddleStatus::diverged);
    ++report.iterations;
    if (!correct_across(problem_at, forward(secant) * load_difference, t_now, report)) return report;
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Vec3 d = now_.x[i] - x[i];
    secant[3 * i] = d.x;
    secant[3 * i + 1] = d.y;
    secant[3 * i + 2] = d.z;
  }
  secant.back() = t_now - t;
  now_.get(x, lambda);
  t = t_now;
  return report;
}

}  // namespace isochor
