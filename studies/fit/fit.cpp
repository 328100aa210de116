// Outline of a fit:
//   1. starts: the shear modulus from the slope of the data at rest, times what the law makes of it
//   2. from each start a bounded least-squares search over constants divided by their scale; derivatives by
//      central differences
//   3. the best end: errors, intervals from the Gauss-Newton matrix, directions that the data do not see
//   4. the law beyond the data: where it is stable, how uncertain it is in modes that were not measured
#include "studies/fit/fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "engine/elements/material_model.h"
#include "scenes/parts_by_keys.h"
#include "studies/ceres_words.h"
#include "studies/inverse/intervals.h"

namespace isochor::fit {

namespace {

using Values = std::vector<double>;

Result<MaterialPtr> material_from(const std::string& keys) {
  auto made = material_from_keys(keys, "");
  if (!made) return made.failure();
  return made.value().material;
}

// Weighted errors of all points.
class Problem {
 public:
  Problem(const Law& law, const std::vector<Curve>& curves, Weights weights) : law_(law), curves_(curves) {
    for (const Curve& curve : curves) {
      double largest = 0;
      for (const double s : curve.stress) largest = std::max(largest, std::abs(s));
      // Each curve counts as much as another, however many points it has.
      const double share = 1 / std::sqrt(static_cast<double>(curve.stress.size()));
      for (const double s : curve.stress)
        scale_.push_back(share /
                         (weights == Weights::absolute ? largest : std::max(std::abs(s), 0.05 * largest)));
    }
  }

  std::size_t size() const { return scale_.size(); }
  const std::vector<Curve>& curves() const { return curves_; }

  // Predicted stresses minus measured ones [Pa]; false where the law has no value.
  bool errors(const Values& constants, std::vector<double>& out) const {
    const auto material = material_from(law_.keys(constants));
    if (!material) return false;
    out.clear();
    for (const Curve& curve : curves_) {
      const std::vector<double> predicted = stresses(*material.value(), curve.mode, curve.stretch);
      for (std::size_t i = 0; i < curve.stress.size(); ++i) {
        out.push_back(predicted[i] - curve.stress[i]);
        if (!std::isfinite(out.back())) return false;
      }
    }
    return true;
  }
  double scale(std::size_t i) const { return scale_[i]; }

 private:
  const Law& law_;
  const std::vector<Curve>& curves_;
  std::vector<double> scale_;
};

// Of Ceres: constants over their scale in, weighted errors out.
struct Residuals {
  const Problem* problem;
  Values unit;
  bool operator()(double const* const* parameters, double* out) const {
    Values constants(unit.size());
    for (std::size_t i = 0; i < unit.size(); ++i) constants[i] = parameters[0][i] * unit[i];
    std::vector<double> errors;
    if (!problem->errors(constants, errors)) return false;
    for (std::size_t i = 0; i < errors.size(); ++i) out[i] = errors[i] * problem->scale(i);
    return true;
  }
};

struct Search {
  bool converged = false;
  std::string reason;
  double cost = std::numeric_limits<double>::infinity();
  Values x;                  // over their scale
  Eigen::MatrixXd jacobian;  // of weighted errors by x
};

// Errors with their derivatives by central differences.
using Cost = ceres::DynamicNumericDiffCostFunction<Residuals, ceres::CENTRAL>;

Cost* cost_of(const Problem& problem, const Values& unit) {
  auto* cost = new Cost(new Residuals{&problem, unit});
  cost->AddParameterBlock(static_cast<int>(unit.size()));
  cost->SetNumResiduals(static_cast<int>(problem.size()));
  return cost;
}

// Of a constant over its scale. What must be positive stays a hair away from 0, so that differences across do
// too.
std::pair<double, double> bounds_of(const Constant& c, double start, double unit) {
  const double hair = 1e-6;
  const double least = c.least == 0 ? hair : c.least / unit, most = c.most / unit;
  if (!c.keeps_sign) return {least, most};
  return start > 0 ? std::pair(0.1, most) : std::pair(least, -0.1);
}

Search search_from(const Problem& problem, const Law& law, const Values& unit, const Values& start,
                   const FitOptions& options) {
  const std::size_t n = unit.size();
  Search out;
  out.x.resize(n);
  ceres::Problem least_squares;
  for (std::size_t i = 0; i < n; ++i) out.x[i] = start[i] / unit[i];
  least_squares.AddResidualBlock(cost_of(problem, unit), nullptr, out.x.data());
  for (std::size_t i = 0; i < n; ++i) {
    const auto at = static_cast<int>(i);
    const auto [least, most] = bounds_of(law.constants[i], start[i], unit[i]);
    if (std::isfinite(least)) least_squares.SetParameterLowerBound(out.x.data(), at, least);
    if (std::isfinite(most)) least_squares.SetParameterUpperBound(out.x.data(), at, most);
  }
  studies::StopSearch stop(options.stop);
  ceres::Solver::Options how = studies::to_last_digits(options.max_iterations);
  how.callbacks.push_back(&stop);
  ceres::Solver::Summary summary;
  ceres::Solve(how, &least_squares, &summary);
  out.converged = summary.termination_type == ceres::CONVERGENCE;
  out.reason = out.converged ? "" : summary.message;
  if (summary.termination_type == ceres::FAILURE)
    out.reason =
        "the search ran into constants that the law refuses or has no value with, as where its shear modulus "
        "is not positive";
  out.cost = summary.IsSolutionUsable() ? summary.final_cost : std::numeric_limits<double>::infinity();
  return out;
}

// Derivatives of the weighted errors at the end of a search; false where the law has no value around it.
bool differentiate(const Problem& problem, const Values& unit, Search& best) {
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Matrix jacobian(static_cast<Eigen::Index>(problem.size()), static_cast<Eigen::Index>(unit.size()));
  const std::unique_ptr<Cost> cost(cost_of(problem, unit));
  double* rows = jacobian.data();
  const double* x = best.x.data();
  std::vector<double> errors(problem.size());
  if (!cost->Evaluate(&x, errors.data(), &rows)) return false;
  best.jacobian = jacobian;
  return true;
}

// Shear modulus that the data begin with: least squares of P = mu p on the quarter of each curve that is next
// to rest, with p what a neo-Hookean block answers at mu = 1.
double first_modulus(const std::vector<Curve>& curves) {
  for (const double share : {0.25, 1.0}) {  // all where nothing is so close
    double above = 0, below = 0;
    for (const Curve& curve : curves) {
      const Range range = range_of({curve});
      const double power = curve.mode == Mode::uniaxial ? -2 : (curve.mode == Mode::equibiaxial ? -5 : -3);
      for (std::size_t i = 0; i < curve.stretch.size(); ++i) {
        const double s = curve.stretch[i], p = s - std::pow(s, power);
        if (std::abs(s - 1) > share * (s > 1 ? range.most - 1 : 1 - range.least)) continue;
        above += p * curve.stress[i];
        below += p * p;
      }
    }
    if (below > 0 && above > 0) return above / below;
  }
  return 1e4;
}

// The measured stretch that is farthest from rest.
double farthest(const Range& range) {
  return range.most * range.least > 1 ? range.most : range.least;
}

// Covariance of x from the Jacobian of weighted errors; what errors do not tell apart is named.
Eigen::MatrixXd covariance(const Law& law, const Search& best, Fit& fit, double variance) {
  std::vector<char> held;
  for (const FittedConstant& c : fit.constants) held.push_back(c.at_bound ? 1 : 0);
  const inverse::Known known = inverse::known_from(best.jacobian, variance, held);
  for (const std::vector<std::size_t>& moved : known.not_apart) {
    std::string names;
    for (const std::size_t i : moved) names += (names.empty() ? "" : " and ") + law.constants[i].name;
    fit.warnings.push_back(
        names + " cannot be told apart by these data; fit fewer constants or measure another mode");
  }
  return known.covariance;
}

void measure_errors(const Problem& problem, const std::vector<double>& errors, Fit& fit) {
  double squares = 0, sum = 0, all = 0;
  for (const Curve& curve : problem.curves())
    for (const double s : curve.stress) sum += s;
  const double mean = sum / static_cast<double>(errors.size());
  for (const Curve& curve : problem.curves())
    for (const double s : curve.stress) all += (s - mean) * (s - mean);
  for (const double e : errors) {
    squares += e * e;
    fit.worst = std::max(fit.worst, std::abs(e));
  }
  fit.rms = std::sqrt(squares / static_cast<double>(errors.size()));
  fit.r2 = all > 0 ? 1 - squares / all : 0;
}

constexpr Mode kModes[] = {Mode::uniaxial, Mode::equibiaxial, Mode::pure_shear};

// Whether the nominal stress of all modes rises between two stretches, and has a value at both.
bool rises(const MaterialModel& material, double from, double to) {
  return std::all_of(std::begin(kModes), std::end(kModes),
                     [&](Mode mode) { return stress(material, mode, to) > stress(material, mode, from); });
}

void look_at_stability(const MaterialModel& material, const Range& measured, Fit& fit) {
  fit.looked_from = std::min(0.25, 0.5 * measured.least);
  fit.looked_to = 2 * measured.most;
  constexpr int steps = 400;
  const auto last_rising = [&](double end) {
    double before = 1;
    for (int i = 1; i <= steps; ++i) {
      const double next = std::pow(end, static_cast<double>(i) / steps);
      if (!(end > 1 ? rises(material, before, next) : rises(material, next, before))) return before;
      before = next;
    }
    return end;
  };
  fit.stable_from = last_rising(fit.looked_from);
  fit.stable_to = last_rising(fit.looked_to);
  fit.stable_in_data = fit.stable_to >= measured.most && fit.stable_from <= measured.least;
  if (fit.stable_in_data) return;
  char text[200];
  std::snprintf(
      text, sizeof text,
      "the law is stable at stretches from %.3g to %.3g, and data go from %.3g to %.3g: take another "
      "law or a smaller range",
      fit.stable_from, fit.stable_to, measured.least, measured.most);
  fit.warnings.emplace_back(text);
}

// How uncertain predictions are in modes that were not measured: the gradient of the stress by the constants,
// times their covariance.
void look_at_other_modes(const Law& law, const Search& best, const Values& unit,
                         const Eigen::MatrixXd& covariance, const std::vector<Curve>& curves, double quantile,
                         Fit& fit) {
  const double at = farthest(range_of(curves));
  for (const Mode mode : kModes) {
    if (std::any_of(curves.begin(), curves.end(), [&](const Curve& c) { return c.mode == mode; })) continue;
    const auto predicted = [&](const Values& x) {
      Values constants(x.size());
      for (std::size_t i = 0; i < x.size(); ++i) constants[i] = x[i] * unit[i];
      const auto material = material_from(law.keys(constants));
      return material ? stress(*material.value(), mode, at) : std::numeric_limits<double>::quiet_NaN();
    };
    const double here = predicted(best.x);
    Eigen::VectorXd gradient(static_cast<Eigen::Index>(best.x.size()));
    for (std::size_t i = 0; i < best.x.size(); ++i) {
      const double h = 1e-5 * std::max(std::abs(best.x[i]), 1e-3);
      Values above = best.x, below = best.x;
      above[i] += h;
      below[i] -= h;
      gradient[static_cast<Eigen::Index>(i)] = (predicted(above) - predicted(below)) / (2 * h);
    }
    const double half = quantile * std::sqrt(std::max(0.0, gradient.dot(covariance * gradient)));
    if (!std::isfinite(here) || !std::isfinite(half)) continue;
    const double relative = half / std::max(std::abs(here), 1e-300);
    fit.uncertainty[word(mode)] = relative;
    if (relative < 0.2) continue;
    char text[240];
    std::snprintf(text, sizeof text,
                  "these data leave the law undetermined in %s: its stress at a stretch of %.3g is known to "
                  "+- %.0f %%; measure that mode",
                  word(mode), at, 100 * relative);
    fit.warnings.emplace_back(text);
  }
}

bool at_bound(const Constant& c, double x, double unit) {
  const auto [least, most] = bounds_of(c, x, unit);
  const double tolerance = 1e-9 * std::max(1.0, std::abs(x));
  return x <= least + tolerance || x >= most - tolerance;
}

}  // namespace

Fit fit(const Law& law, const std::vector<Curve>& curves, const FitOptions& options) {
  studies::quiet_ceres();
  Fit out;
  out.law = law.name;
  const Problem problem(law, curves, options.weights);
  const std::size_t n = law.constants.size();
  if (problem.size() < n) {
    out.reason = "the data have " + std::to_string(problem.size()) + " points for " + std::to_string(n) +
                 " constants; give more points or take a law with fewer constants";
    return out;
  }
  const double modulus = first_modulus(curves);
  double invariant = 0;
  for (const Curve& curve : curves)
    for (const double s : curve.stretch) invariant = std::max(invariant, first_invariant(curve.mode, s));
  Values unit(n, 1.0);
  for (std::size_t i = 0; i < n; ++i) unit[i] = law.constants[i].stiffness() ? modulus : 1.0;

  Search best;
  for (const Values& start : law.starts(modulus, invariant)) {
    Search found = search_from(problem, law, unit, start, options);
    if (best.x.empty() || found.cost < best.cost) best = std::move(found);
    if (options.stop && options.stop()) break;
  }
  const bool found = std::isfinite(best.cost) && differentiate(problem, unit, best);
  out.converged = best.converged && found;
  if (best.reason.empty() && !found) best.reason = "the law has no value around the end of the search";
  out.reason = out.converged ? "" : "no minimum was found: " + best.reason;
  if (!found) return out;

  Values constants(n);
  for (std::size_t i = 0; i < n; ++i) {
    constants[i] = best.x[i] * unit[i];
    const Constant& c = law.constants[i];
    FittedConstant made{c.name, c.unit, constants[i], 0, at_bound(c, best.x[i], unit[i])};
    if (made.at_bound)
      out.warnings.push_back(c.name + " is at the end of its range; the law asks for no such part");
    out.constants.push_back(made);
  }
  out.keys = law.keys(constants);
  const auto material = material_from(out.keys);
  if (!material) {
    out.converged = false;
    out.reason = material.error();
    return out;
  }
  out.shear_modulus = material.value()->shear_modulus();
  std::vector<double> errors;
  (void)problem.errors(constants, errors);
  measure_errors(problem, errors, out);

  const double freedom = static_cast<double>(problem.size() - n);
  const double variance = freedom > 0 ? 2 * best.cost / freedom : 0;
  const double quantile = freedom > 0 ? inverse::student(freedom) : 0;
  const Eigen::MatrixXd known = covariance(law, best, out, variance);
  for (std::size_t i = 0; i < n; ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    out.constants[i].half_width =
        freedom > 0 ? quantile * std::sqrt(known(at, at)) * unit[i] : std::numeric_limits<double>::infinity();
  }
  look_at_stability(*material.value(), range_of(curves), out);
  look_at_other_modes(law, best, unit, known, curves, quantile, out);
  return out;
}

Result<MaterialPtr> material_of(const Fit& fit) {
  if (fit.keys.empty()) return Error{fit.law + ": " + fit.reason};
  return material_from(fit.keys);
}

}  // namespace isochor::fit
