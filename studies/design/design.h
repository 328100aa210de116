// Shapes and stiffness fields that make a scene answer what is wanted of it.
#pragma once

#include <Eigen/Dense>
#include <functional>
#include <optional>

#include "studies/design/morph.h"
#include "studies/inverse/answer.h"

namespace isochor::design {

// A factor on the stiffness of each cell of a body.
struct StiffnessField {
  std::string body;                 // its name
  double length = 0;                // over which the field is smooth [m]; see SmoothField
  double spread = 0.5;              // standard deviation of the logarithm of the factor
  double least = 0.01, most = 100;  // the factor stays between
};

struct BodyMove : Move {
  std::string body;
};
// "BODY:SURFACE=LEAST:MOST" in meters along the outward normals, "BODY:SURFACE.x=LEAST:MOST" along an axis;
// the body may be left out where the scene has one.
Result<BodyMove> parse_move(const std::string& text, const SceneDef& scene);

struct DesignOptions {
  std::optional<StiffnessField> stiffness;
  std::vector<BodyMove> moves;                      // of one body
  std::vector<std::string> hold;                    // surfaces; see Morph
  std::optional<double> least_volume, most_volume;  // of the body that moves, at rest [m^3]
  double least_quality = 0.2;                       // see Morph::quality()
  // Errors over the largest change of their kind that count as met; of measurements their standard deviation.
  std::optional<double> noise;  // absent: 1e-4, with a stiffness field 0.01
  int max_iterations = 60;
  int threads = 0;
  std::string folder;  // where meshes of trials are written
  std::function<bool()> stop;
  std::function<void(int iteration, double error)> on_iteration;  // error: root mean square, over `noise`
};

struct DesignedMove {
  BodyMove move;
  double value = 0;  // [m]
  bool at_bound = false;
};

struct DesignStep {
  int iteration = 0;
  double error = 0;    // of the data, root mean square over `noise`
  double quality = 1;  // of the mesh
  double volume = 0;   // of the body that moves [m^3]
  std::vector<double> moves;
};

struct Design {
  bool converged = false, interrupted = false;
  bool reached = false;  // the root mean square of errors is within `noise`
  std::string reason;    // where it is not converged
  inverse::Data data;
  Eigen::VectorXd before, found, scale;  // of the data
  double noise = 0;
  double error_before = 0, error = 0;  // root mean square over `noise`
  std::vector<DesignedMove> moves;
  double quality = 1, volume_before = 0, volume = 0;
  // Of each cell of the mesh; empty without a stiffness field. `deviation`: the standard deviation of the
  // logarithm that the data leave, where they err by `noise` and the field is what it was taken for.
  std::vector<double> factor, deviation;
  std::vector<DesignStep> history;
  std::string note;  // why the mesh or an equilibrium ended steps
  SceneDef scene;    // as designed; its mesh is a file in the folder
};

// Least squares over errors, what is taken for granted of the field, and bounds (search.h). Steps whose mesh
// is below `least_quality`, or that have no equilibrium, are halved. Refused: nothing to choose, surfaces
// that are not there, what nothing depends on, other units, meshes that cannot be written again.
Result<Design> design(const SceneDef& scene, const inverse::Data& data, const DesignOptions& options);

}  // namespace isochor::design
