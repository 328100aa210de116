// Amounts of effects over a whole horizon, chosen together: what comes later has a say in what is done now.
#pragma once

#include "studies/drive/drive.h"

namespace isochor::drive {

struct HorizonOptions : DriveOptions {
  int every = 1;  // increments of the scene between two points of an amount's curve
  // Of what amounts do at most: how much it counts that an amount goes once through its range, steadily.
  // Absent: 1e-4, and less where that keeps amounts from targets.
  std::optional<double> smooth;
  // Asked for at every gradient: the root of the sum of the squared distances.
  std::function<void(int gradients, double distance)> on_iteration;
};

// The curves of amounts within bounds and rates where
//   sum over targets of (value - target)^2 / unit^2 + (smooth W)^2 T integral of (da/dt / size)^2 dt
// is smallest, from the curves that the scene has: W is the largest change of a value by an amount that goes
// through its range, at these; sizes are those of bounds. With every time scheme and in statics, by
// World::trajectory_gradients(). Refused beside what drive() refuses: targets between the increments of the
// scene; what gradients of trajectories do not follow.
Result<Drive> drive_over_horizon(const SceneDef& scene, std::vector<Actuator> actuators, Targets targets,
                                 const HorizonOptions& options = {});

}  // namespace isochor::drive
