// Constants of materials and effects in scenes from measured curves: pressure and bend, pressure and volume,
// forces, markers; several experiments at once.
#pragma once

#include "studies/fit/fit.h"
#include "studies/inverse/answer.h"

namespace isochor::fit {

struct Experiment {
  std::string name;  // "SCENE:DATA" as it was given
  SceneDef scene;
  inverse::Data data;
  double weight = 1;  // of its squared errors
};

// A number among the materials or effects of a scene: "bodies[0].materials[0].young", "springs[0].stiffness",
// "contacts[0].friction". Scenes that do not have the path do not depend on it.
struct Sought {
  std::string path;
  // Bounds; absent: from a thousandth to the thousandfold of a number that is positive at the start, 0 to 0.5
  // for Poisson's ratio, none otherwise.
  std::optional<double> least, most;
};
// "PATH" or "PATH=LEAST:MOST".
Result<Sought> parse_sought(const std::string& text);

struct SceneFitOptions {
  int max_iterations = 100;
  int threads = 0;
  std::function<bool()> stop;
  std::function<void(int iteration, double rms)> on_iteration;
};

struct SceneFit {
  bool converged = false, interrupted = false;
  std::string reason;                     // where it is not converged
  std::vector<FittedConstant> constants;  // names are paths
  std::vector<double> start;              // of each constant
  double rms = 0;                         // of the errors over the scales of their kinds
  std::vector<double> experiment_rms;     // of each experiment
  std::vector<Eigen::VectorXd> fitted;    // what each scene answers to its data
  std::vector<SceneDef> scenes;           // with the constants found
  std::vector<std::string> warnings;
  int iterations = 0;
};

// Bounded least squares of errors over the scales of their kinds (answer.h), the mean square of each
// experiment times its weight. What is refused: paths that no scene has or that nothing depends on, fewer
// data than constants, numbers in other units.
Result<SceneFit> fit_scenes(const std::vector<Experiment>& experiments, const std::vector<Sought>& constants,
                            const SceneFitOptions& options = {});

}  // namespace isochor::fit
