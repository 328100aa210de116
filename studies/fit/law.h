// Laws whose constants are sought.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "isochor/materials.h"
#include "studies/fit/curve.h"

namespace isochor::fit {

struct Constant {
  std::string name;  // "c1", "c[0]", "terms[1].alpha"
  std::string unit;  // "Pa" or ""
  double least, most;
  bool keeps_sign = false;  // of its start, and stays 0.1 away from 0
  bool stiffness() const { return unit == "Pa"; }
};

struct Law {
  std::string name;  // as it is asked for: "ogden_2"
  std::vector<Constant> constants;
  // Starts for the search, given a shear modulus [Pa] and the largest I - 3 of the data.
  std::function<std::vector<std::vector<double>>(double shear_modulus, double largest_invariant)> starts;
  // The keys of scene files, as JSON, of an incompressible material.
  std::function<std::string(const std::vector<double>&)> keys;
};

const std::vector<Law>& laws();
Result<const Law*> find_law(const std::string& name);

// The nominal stresses of an incompressible block along its load [Pa]; not finite where the law has no value.
std::vector<double> stresses(const MaterialModel& material, Mode mode, std::span<const double> stretches);
double stress(const MaterialModel& material, Mode mode, double stretch);

// I - 3 = tr C - 3 of an incompressible block.
double first_invariant(Mode mode, double stretch);

}  // namespace isochor::fit
