// The constants of a law that come closest to measured curves, and how well they are known.
#pragma once

#include <functional>
#include <map>

#include "studies/fit/law.h"

namespace isochor::fit {

enum class Weights {
  absolute,  // errors of stress over the largest stress of their curve
  relative   // errors over the measured stress, with 5 % of the largest as its least
};

struct FitOptions {
  Weights weights = Weights::absolute;
  int max_iterations = 500;    // of each start
  std::function<bool()> stop;  // asked once an iteration
};

struct FittedConstant {
  std::string name, unit;
  double value = 0;
  double half_width = 0;  // of the 95 % confidence interval; infinity where the data do not tell
  bool at_bound = false;
};

struct Fit {
  std::string law;
  bool converged = false;
  std::string reason;  // where it is not
  std::vector<FittedConstant> constants;
  std::string keys;          // of scene files, as JSON
  double shear_modulus = 0;  // at rest [Pa]
  double r2 = 0;             // 1 - sum of squared errors over that about the mean, of all points of stress
  double rms = 0;            // of the errors of stress [Pa]
  double worst = 0;          // largest |error of stress| [Pa]
  // Stretches around 1 between which the nominal stress has a value and rises in all three modes; the ends of
  // what was looked at, 1/4 to twice the largest measured stretch, where nothing falls.
  double stable_from = 0, stable_to = 0;
  double looked_from = 0, looked_to = 0;
  bool stable_in_data = false;  // at all stretches between the measured ones and rest
  // Half width of the 95 % interval of the predicted stress over the stress, at the measured stretch farthest
  // from rest, of modes that were not measured.
  std::map<std::string, double> uncertainty;
  std::vector<std::string> warnings;
};

// Weighted least squares within bounds, by Levenberg-Marquardt's trust region (Ceres), from each start of the
// law. Intervals come from the Gauss-Newton matrix: s^2 (J^T J)^-1 with Student's t. They say how errors that
// are independent and alike move the constants, not how far a law is from the material.
Fit fit(const Law& law, const std::vector<Curve>& curves, const FitOptions& options = {});

// A material of a fit; refused where it has none.
Result<MaterialPtr> material_of(const Fit& fit);

}  // namespace isochor::fit
