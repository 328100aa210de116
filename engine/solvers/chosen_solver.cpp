#include "engine/solvers/chosen_solver.h"

#include <unistd.h>

#include <cstdio>
#include <utility>

namespace isochor {

namespace {

std::string in_gib(double bytes) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g GiB", bytes / (1024.0 * 1024.0 * 1024.0));
  return text;
}

}  // namespace

double memory_for_factors() {
  const long pages = sysconf(_SC_PHYS_PAGES), size = sysconf(_SC_PAGE_SIZE);
  if (pages <= 0 || size <= 0) return 4.0 * 1024 * 1024 * 1024;
  return 0.6 * static_cast<double>(pages) * static_cast<double>(size);
}

ChosenSolver::ChosenSolver(std::unique_ptr<LinearSolver> direct, std::unique_ptr<LinearSolver> iterative,
                           const ChoiceOptions& options)
    : direct_(std::move(direct)),
      iterative_(std::move(iterative)),
      now_(options.prefer_iterative ? iterative_.get() : direct_.get()),
      memory_(options.memory > 0 ? options.memory : memory_for_factors()),
      prefer_iterative_(options.prefer_iterative) {}

std::string ChosenSolver::reason() const {
  const std::string more = now_->reason();
  return reason_ + (reason_.empty() || more.empty() ? "" : "; ") + more;
}

void ChosenSolver::set_parallel(const Parallel& parallel) {
  direct_->set_parallel(parallel);
  iterative_->set_parallel(parallel);
}

void ChosenSolver::set_interrupt(std::function<bool()> asked) {
  direct_->set_interrupt(asked);
  iterative_->set_interrupt(asked);
  LinearSolver::set_interrupt(std::move(asked));
}

void ChosenSolver::set_geometry(std::vector<UnknownGeometry> geometry) {
  iterative_->set_geometry(std::move(geometry));
}

void ChosenSolver::set_scale(std::span<const double> scale) {
  direct_->set_scale(scale);
  iterative_->set_scale(scale);
}

void ChosenSolver::begin_solve() {
  direct_->begin_solve();
  iterative_->begin_solve();
}

// True when the direct solver is ready for values.
bool ChosenSolver::use_direct(std::string reason, FactorReport& report) {
  report = direct_->analyze(*pattern_);
  const double bytes = report.memory > 0 ? report.memory : 12.0 * static_cast<double>(report.factor_nonzeros);
  if (report.status == FactorStatus::out_of_memory || bytes > memory_) {
    direct_fits_ = false;
    reason_ = report.status == FactorStatus::out_of_memory
                  ? "memory ran out where factors were prepared"
                  : "factors would take " + in_gib(bytes) + " and " + in_gib(memory_) + " are for them";
    return false;
  }
  now_ = direct_.get();
  reason_ = std::move(reason);
  if (reason_.empty()) reason_ = "factors take " + in_gib(bytes);
  return report.status == FactorStatus::ok;
}

bool ChosenSolver::use_iterative(std::string reason, FactorReport& report) {
  report = iterative_->analyze(*pattern_);
  now_ = iterative_.get();
  reason_ = std::move(reason);
  return report.status == FactorStatus::ok;
}

FactorReport ChosenSolver::analyze(const SymmetricPattern& pattern) {
  pattern_ = &pattern;
  direct_fits_ = true;
  iterative_failed_ = false;
  FactorReport report;
  if (prefer_iterative_) {
    use_iterative("large, with inertia", report);
    return report;
  }
  if (!use_direct({}, report) && !direct_fits_) use_iterative(reason_, report);
  return report;
}

FactorReport ChosenSolver::factor(std::span<const double> values) {
  values_ = values;
  FactorReport report = now_->factor(values);
  if (report.status == FactorStatus::out_of_memory && now_ == direct_.get() && !iterative_failed_) {
    direct_fits_ = false;
    if (use_iterative("the memory for factors ran out", report)) report = now_->factor(values);
  }
  return report;
}

SolveReport ChosenSolver::solve_to(double tolerance, std::span<const double> right_hand_side,
                                   std::span<double> solution) {
  SolveReport report = now_->solve_to(tolerance, right_hand_side, solution);
  if (report.ok || now_ != iterative_.get() || !direct_fits_ || interrupted()) return report;
  // From here on, since what was hard once tends to stay so.
  iterative_failed_ = true;
  FactorReport factored;
  const int iterations = report.iterations;
  if (use_direct("the iterative solver had failed", factored)) {
    factored = now_->factor(values_);
    if (factored.status == FactorStatus::ok) report = now_->solve_to(tolerance, right_hand_side, solution);
    report.iterations += iterations;
  } else {
    now_ = iterative_.get();
  }
  return report;
}

}  // namespace isochor
