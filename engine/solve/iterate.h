// Where a solve is: positions and multipliers, and what an evaluation found there. Only an Evaluator fills in
// the latter; merit and residuals are functions of it.
#pragma once

#include "engine/system/system.h"

namespace isochor {

struct Iterate {
  explicit Iterate(const System& system)
      : x(at(system.nodes())),
        lambda(at(system.rows())),
        asked(system.has_bounds() ? lambda.size() : 0),
        force(x.size()),
        magnitude(x.size()),
        theta(lambda.size()),
        prescribed_phi(at(system.prescribed_rows())) {}

  std::vector<Vec3> x;         // [m]
  std::vector<double> lambda;  // of compliant rows
  // Those of the step that led here before they were put within their bounds; empty where no row has any.
  std::vector<double> asked;

  double energy = 0;              // of the stencils [J]
  double absolute_energy = 0;     // sum of their magnitudes [J]
  double inertia_energy = 0;      // [J]
  double law_energy = 0;          // of the rows with a law of their own [J]
  std::vector<Vec3> force;        // d(energy + lambda . phi)/dx less loads, plus inertia, of all nodes [N]
  std::vector<double> magnitude;  // of the forces that cancel in it [N]
  std::vector<double> theta;      // phi - target - C lambda
  std::vector<double> prescribed_phi;  // functions of rows whose multipliers are given

  void set(std::span<const Vec3> positions, std::span<const double> multipliers) {
    std::copy(positions.begin(), positions.end(), x.begin());
    std::copy(multipliers.begin(), multipliers.end(), lambda.begin());
    if (!asked.empty()) asked = lambda;
  }
  void get(std::span<Vec3> positions, std::span<double> multipliers) const {
    std::copy(x.begin(), x.end(), positions.begin());
    std::copy(lambda.begin(), lambda.end(), multipliers.begin());
  }
};

// What given coordinates still have to go, of all nodes [m].
struct Gap {
  bool open = false;
  std::vector<Vec3> way;
};

}  // namespace isochor
