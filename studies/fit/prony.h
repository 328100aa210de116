// Terms of a Prony series from a measured relaxation: standard linear solids side by side.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "isochor/viscoelastic.h"

namespace isochor::fit {

// What is left of a stress, force or modulus (any unit) as time passes after a strain.
struct Relaxation {
  std::string name;          // of the file, without folder and ending
  std::vector<double> time;  // ascending, since the strain began [s]
  std::vector<double> value;
};

struct RelaxationOptions {
  std::string time_column, value_column;  // empty: found by what their names say
};

// A CSV file, separated by commas, semicolons or tabs; lines before the one that names a time and a stress,
// force, load or modulus are skipped. Errors name file, line and remedy.
Result<Relaxation> read_relaxation(const std::string& path, const RelaxationOptions& options);

struct PronyOptions {
  int terms = 1;
  double ramp = 0;             // [s]: the strain rose steadily for so long; 0: at once
  std::function<bool()> stop;  // asked once an iteration
};

struct PronyFit {
  bool converged = false;
  std::string reason;                 // where it is not
  std::vector<PronyTerm> terms;       // as with_prony_series() takes them, times ascending
  double instant = 0, stays = 0;      // values at once and in the end, in the unit of the data
  double r2 = 0, rms = 0, worst = 0;  // of the errors, in the unit of the data
  std::vector<std::string> warnings;
  std::string keys() const;  // of scene files, as JSON: a list of terms
};

// Least squares of v(t) = stays + sum of v_i exp(-t/time_i), all positive, by Levenberg-Marquardt's trust
// region (Ceres) from several sets of times. With a ramp of length r, v is what a strain that rises for that
// long leaves: its mean over the last r seconds of the law above.
PronyFit fit_prony(const Relaxation& data, const PronyOptions& options);

// The value that a series predicts at a time, with the ramp.
double relaxed(const PronyFit& fit, double ramp, double time);

std::string prony_json(const Relaxation& data, const std::vector<PronyFit>& fits);

}  // namespace isochor::fit
