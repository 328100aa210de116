#include "engine/solve/inertia_correction.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace isochor {

namespace {

// In a body whose stiffness varies a shift holds the stiff part, which may only turn, against what the soft
// part does: it goes down as far as it may.
constexpr double smallest_shift = 1e-10;
constexpr double first_shift = 1e-3, largest_shift = 1, shift_ratio = 6;
constexpr double largest_projected_shift = 1e3, projected_ratio = 30;
constexpr int most_singular = 2;  // in a row, beyond the first
constexpr double smallest_trace = 1e-8, largest_trace = 1e-2, trace_ratio = 100;

}  // namespace

void InertiaCorrection::begin(Definiteness definiteness) {
  definiteness_ = definiteness;
  held_ = {};
  shift_ = 0;
  trace_ = 0;
  first_ = true;
}

Kkt::Values InertiaCorrection::values(double shift) const {
  Kkt::Values v;
  v.mass_scale = evaluator_.mass_scale();
  v.shift = shift;
  v.stiffness = evaluator_.stiffness();
  v.tangent = evaluator_.tangents();
  v.clamped = held_;
  v.trace = trace_;
  return v;
}

bool InertiaCorrection::factor_shifted(double shift, SaddleReport& report) {
  const Kkt::Outcome f = kkt_.factor(evaluator_.assembly(), values(shift), seconds_);
  singular_ = f.status == FactorStatus::singular;
  ++report.factorizations;
  report.negative_pivots = f.negative;
  if (f.status == FactorStatus::out_of_memory) report.status = SaddleStatus::out_of_memory;
  if (f.status != FactorStatus::ok) {
    report.message = f.message;
    return false;
  }
  return f.negative < 0 || f.negative == evaluator_.system().rows();
}

bool InertiaCorrection::factor_unsymmetric(const UnsymmetricPart& part, SaddleReport& report) {
  for (;;) {
    Kkt::Values v = values(0);
    v.unsymmetric = &part;
    const Kkt::Outcome f = kkt_.factor(evaluator_.assembly(), v, seconds_);
    ++report.factorizations;
    report.negative_pivots = -1;
    if (f.status == FactorStatus::ok) return true;
    report.message = f.message;
    // Rows with bounds may repeat each other.
    if (f.status != FactorStatus::singular || !evaluator_.system().has_bounds() || trace_ > 0) return false;
    trace_ = smallest_trace;
  }
}

// Whether no other matrix is to be tried.
bool InertiaCorrection::gave_up(SaddleReport& report) const {
  if (interrupt_ && interrupt_()) report.status = SaddleStatus::cancelled;
  return report.status == SaddleStatus::out_of_memory || report.status == SaddleStatus::cancelled;
}

// Several bounded rows may ask the same of the same nodes (two obstacles side by side, a flat cell all of
// whose nodes touch): then their multipliers are not unique, and a trace of compliance in the matrix picks
// some. It slows the iteration by as little, and is as large as it has to be.
bool InertiaCorrection::add_trace(SaddleReport& report) {
  while (singular_ && trace_ < largest_trace) {
    trace_ = trace_ == 0 ? smallest_trace : trace_ratio * trace_;
    if (factor_shifted(0, report)) return true;
    if (gave_up(report)) return false;
  }
  return false;
}

// Where pressures of a new increment meet multipliers of the old state, the matrix may have a wrong inertia
// although both increments end in stable equilibria. That of the old pressures is right, and as good for a
// first step.
bool InertiaCorrection::factor_where_it_began(const SaddleProblem& p, std::span<const Vec3> x,
                                              std::span<const double> multipliers, SaddleReport& report) {
  const auto before = p.prescribed_before;
  if (std::equal(before.begin(), before.end(), p.prescribed.begin(), p.prescribed.end())) return false;
  const auto evaluate = [&](std::span<const double> given) {
    const Stopwatch watch(seconds_.evaluate);
    evaluator_.assembly().evaluate(Want::hessian, definiteness_, x, multipliers, given);
  };
  evaluate(before);
  if (factor_shifted(0, report)) return true;
  if (!gave_up(report)) evaluate(p.prescribed);
  return false;
}

bool InertiaCorrection::found_singular(SaddleReport& report) {
  report.status = SaddleStatus::singular;
  explain_singular(report);
  return false;
}

// Gives up at once where the matrix is singular whatever the shift: then it is the rows that depend on each
// other.
bool InertiaCorrection::factor(const SaddleProblem& p, std::span<const Vec3> x,
                               std::span<const double> multipliers, SaddleReport& report) {
  mended_ = false;
  const bool first = std::exchange(first_, false);
  if (factor_shifted(0, report)) return true;
  if (gave_up(report)) return false;
  mended_ = true;
  if (first && !singular_ && factor_where_it_began(p, x, multipliers, report)) return true;
  if (gave_up(report)) return false;
  if (evaluator_.system().has_bounds() && singular_ && add_trace(report)) return true;
  if (gave_up(report)) return false;
  if (climb(p, x, multipliers, report, {})) return true;
  return gave_up(report) ? false : found_singular(report);
}

// The rungs from the shifts on. Starting from a third of what the last wrong inertia took finds the size in
// one or two trials. Without `works` the inertia decides, and a matrix that stays singular ends the climb.
bool InertiaCorrection::climb(const SaddleProblem& p, std::span<const Vec3> x,
                              std::span<const double> multipliers, SaddleReport& report,
                              const std::function<bool()>& works) {
  ++report.shifted;
  const auto good = [&](double shift) { return factor_shifted(shift, report) && (!works || works()); };
  int singular = singular_ ? 1 : 0;
  for (double shift = shift_ > 0 ? std::max(smallest_shift, shift_ / 3) : first_shift; shift < largest_shift;
       shift *= shift_ratio) {
    if (good(shift)) {
      shift_ = shift;
      return true;
    }
    if (gave_up(report)) return false;
    singular = singular_ ? singular + 1 : 0;
    if (!works && singular > most_singular) return false;
  }
  {
    const Stopwatch watch(seconds_.evaluate);
    evaluator_.assembly().evaluate(Want::hessian, std::max(definiteness_, Definiteness::projected), x,
                                   multipliers, p.prescribed);
  }
  ++report.projected;
  for (double shift = 0; shift < largest_projected_shift;
       shift = std::max(first_shift, projected_ratio * shift)) {
    if (good(shift)) return true;
    if (gave_up(report)) return false;
  }
  return false;
}

}  // namespace isochor
