// Amounts of effects that bring probes, forces of supports and chambers to targets, one target after the
// other; horizon.h chooses all at once.
#pragma once

#include <functional>
#include <limits>
#include <optional>

#include "studies/drive/targets.h"

namespace isochor::drive {

// An amount that may be chosen.
struct Actuator {
  std::string effect;  // its name in the scene
  double least = -std::numeric_limits<double>::infinity(), most = std::numeric_limits<double>::infinity();
  double rate = std::numeric_limits<double>::infinity();  // largest change per unit of the scene's time
};

// "NAME", "NAME=LEAST:MOST" or "NAME=LEAST:MOST:RATE", in the unit of the amount.
Result<Actuator> parse_actuator(const std::string& text);

struct DriveOptions {
  // A target counts as reached within this distance: [m], and of forces, pressures and volumes over the
  // largest target of their kind.
  double tolerance = 1e-6;
  int max_iterations = 100;  // of each target
  int threads = 0;
  std::function<bool()> stop;  // asked at every iteration
};

struct Reached {
  double time = 0;
  std::vector<double> amount;    // of each actuator
  std::vector<double> position;  // of each goal, in its unit
  double distance = 0;           // from the targets, the root of the sum of squares; see tolerance
  bool reached = false;          // within the tolerance; else nearest, where `nearest`
  // To first order no amounts within bounds and rates come closer by a hundredth of the tolerance.
  bool nearest = false;
  std::vector<std::string> at_bound;
  int iterations = 0;  // gradients taken
};

struct Drive {
  std::vector<Actuator> actuators;
  Targets targets;
  std::vector<Reached> steps;  // as far as it got
  std::string reason;          // why it ended before the last target; empty: it did not
  bool interrupted = false;
  // Over a whole horizon: the amounts of each actuator, from where the scene begins to the last target, and
  // how many increments that are; of step by step none.
  std::vector<Curve> curves;
  int increments = 0;
  bool all_reached() const;
};

// Refuses what cannot be driven: effects that are not there or have no amount, starts outside of their
// bounds, bodies in motion.
Result<Drive> drive(const SceneDef& scene, std::vector<Actuator> actuators, Targets targets,
                    const DriveOptions& options = {});

// The scene with the amounts that were found as curves, for as long as targets were met or come nearest to.
Result<SceneDef> driven_scene(const SceneDef& scene, const Drive& drive);

}  // namespace isochor::drive
