#include "engine/step/path_follower.h"

#include <algorithm>
#include <cmath>

namespace isochor {

PathFollower::PathFollower(std::shared_ptr<const System> system, const Parallel& parallel,
                           std::unique_ptr<LinearSolver> solver)
    : Newton(std::move(system), parallel, std::move(solver)) {
  for (PathVector* v : {&correction_, &slope_, &tangent_, &trial_}) {
    v->x.resize(at(system_->nodes()));
    v->lambda.resize(at(system_->rows()));
  }
}

double PathFollower::product(const PathVector& a, const PathVector& b) const {
  double sum = 0;
  for (std::size_t i = 0; i < a.x.size(); ++i) sum += dot(a.x[i], b.x[i]);
  return sum / static_cast<double>(std::max<std::size_t>(a.x.size(), 1)) +
         load_weight_ * load_weight_ * a.t * b.t;
}

// Factors at (x, lambda, t) as it is and leaves the Newton step at fixed t in correction_.
bool PathFollower::factor_here(const ProblemAt& problem_at, double t, std::span<const Vec3> x,
                               std::span<const double> lambda, SaddleReport& report) {
  const SaddleProblem p = problem_at(t);
  if (!all_finite(p)) {
    report.status = SaddleStatus::not_finite;
    return false;
  }
  {
    const Stopwatch watch(seconds_.evaluate);
    assembly_.set_increment(p.increment, p.memory);
    assembly_.renew_lag(x, lambda, p.prescribed);
    assembly_.evaluate(Want::hessian, Definiteness::exact, x, lambda, p.prescribed);
    assemble_residual(p, x, lambda);
  }
  position_gap(p, x);
  if (system_->has_bounds()) choose_clamped(lambda, false);
  if (!system_->laws().empty()) apply_laws(p, lambda, true);
  factor_shifted(0, 0, report);  // the inertia is reported, not mended
  if (!report.message.empty()) {
    report.status = SaddleStatus::singular;
    return false;
  }
  if (!direction(lambda, report)) {
    report.status = SaddleStatus::singular;
    return false;
  }
  std::copy(dx_.begin(), dx_.end(), correction_.x.begin());
  for (std::size_t r = 0; r < lambda.size(); ++r) correction_.lambda[r] = lambda_new_[r] - lambda[r];
  return true;
}

// d(x, lambda)/dt at fixed residual, into slope_: the difference of the Newton steps for the loads at t +
// step and at t (correction_), both with the factors at hand.
bool PathFollower::slope(const ProblemAt& problem_at, double t, double step, std::span<const Vec3> x,
                         std::span<const double> lambda, SaddleReport& report) {
  const SaddleProblem p = problem_at(t + step);
  assembly_.evaluate(Want::gradient, Definiteness::exact, x, lambda, p.prescribed);
  assemble_residual(p, x, lambda);
  position_gap(p, x);
  if (!direction(lambda, report)) {
    report.status = SaddleStatus::singular;
    return false;
  }
  for (std::size_t i = 0; i < dx_.size(); ++i) slope_.x[i] = (1 / step) * (dx_[i] - correction_.x[i]);
  for (std::size_t r = 0; r < lambda.size(); ++r)
    slope_.lambda[r] = (lambda_new_[r] - lambda[r] - correction_.lambda[r]) / step;
  slope_.t = 1;
  return true;
}

SaddleReport PathFollower::follow(const ProblemAt& problem_at, double length, double load_weight,
                                  const SaddleOptions& options, std::span<Vec3> x, std::span<double> lambda,
                                  double& t, std::span<double> secant) {
  constexpr double load_difference = 1e-3;  // for derivatives of the loads, which are piecewise linear in t
  SaddleReport report;
  const auto fail = [&](SaddleStatus status) {
    report.status = status;
    return report;
  };
  begin(problem_at(t));
  load_weight_ = load_weight;
  // The direction of the last step says where forward is; from rest it is up.
  const auto heading = [&](const PathVector& v) {
    double sum = load_weight * load_weight * v.t * secant.back(), size = std::abs(secant.back());
    for (std::size_t i = 0; i < v.x.size(); ++i) {
      const Vec3 s{secant[3 * i], secant[3 * i + 1], secant[3 * i + 2]};
      sum += dot(v.x[i], s) / static_cast<double>(v.x.size());
      size = std::max(size, std::abs(s.x) + std::abs(s.y) + std::abs(s.z));
    }
    return size > 0 ? sum : v.t;
  };
  const double forward = secant.back() < 0 ? -1 : 1;
  if (!factor_here(problem_at, t, x, lambda, report)) return report;
  if (!slope(problem_at, t, forward * load_difference, x, lambda, report)) return report;
  tangent_ = slope_;
  double norm_of = std::sqrt(product(tangent_, tangent_));
  if (!(norm_of > 0) || !std::isfinite(norm_of)) return fail(SaddleStatus::singular);
  if (heading(tangent_) < 0) norm_of = -norm_of;
  for (Vec3& v : tangent_.x) v = (1 / norm_of) * v;
  for (double& v : tangent_.lambda) v /= norm_of;
  tangent_.t /= norm_of;

  std::copy(x.begin(), x.end(), trial_.x.begin());
  std::copy(lambda.begin(), lambda.end(), trial_.lambda.begin());
  trial_.t = t;
  const auto add = [&](double s, const PathVector& v) {
    for (std::size_t i = 0; i < v.x.size(); ++i) trial_.x[i] += s * v.x[i];
    for (std::size_t r = 0; r < v.lambda.size(); ++r) trial_.lambda[r] += s * v.lambda[r];
    trial_.t += s * v.t;
  };
  add(length, tangent_);
  clamp(trial_.lambda);
  double first = -1;
  for (int iteration = 0;; ++iteration) {
    if (interrupted()) return fail(SaddleStatus::cancelled);
    if (!factor_here(problem_at, trial_.t, trial_.x, trial_.lambda, report)) return report;
    if (!std::isfinite(assembly_.energy())) return fail(SaddleStatus::line_search_failed);
    const SaddleProblem p = problem_at(trial_.t);
    const bool done = balanced(p, options, trial_.x, trial_.lambda, report) && iteration > 0;
    if (progress && iteration > 0) progress(iteration, report.force_residual, report.row_residual);
    if (done) break;
    const double size = report.force_residual + report.row_residual;
    if (first < 0) first = size;
    if (iteration >= options.max_iterations) return fail(SaddleStatus::iteration_limit);
    if (!std::isfinite(size) || size > 1e3 * std::max(first, 1e-6)) return fail(SaddleStatus::diverged);
    ++report.iterations;
    correction_.t = 0;
    if (!slope(problem_at, trial_.t, forward * load_difference, trial_.x, trial_.lambda, report))
      return report;
    // The correction stays in the plane across the tangent.
    const double across = product(tangent_, slope_);
    if (across == 0) return fail(SaddleStatus::singular);
    const double dt = -product(tangent_, correction_) / across;
    add(1, correction_);
    add(dt, slope_);
    clamp(trial_.lambda);
    report.step = 0;
    for (std::size_t i = 0; i < dx_.size(); ++i)
      report.step = std::max(report.step, norm(correction_.x[i] + dt * slope_.x[i]));
    if (report.step > 10 * system_->length()) return fail(SaddleStatus::diverged);
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Vec3 d = trial_.x[i] - x[i];
    secant[3 * i] = d.x;
    secant[3 * i + 1] = d.y;
    secant[3 * i + 2] = d.z;
  }
  secant.back() = trial_.t - t;
  std::copy(trial_.x.begin(), trial_.x.end(), x.begin());
  std::copy(trial_.lambda.begin(), trial_.lambda.end(), lambda.begin());
  t = trial_.t;
  return report;
}

}  // namespace isochor
