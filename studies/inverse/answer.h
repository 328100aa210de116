// What a scene answers to data: the same numbers, and how they change with parameters.
#pragma once

#include <Eigen/Dense>
#include <functional>

#include "isochor/gradients.h"
#include "scenes/probes.h"
#include "studies/inverse/data.h"

namespace isochor::inverse {

// Quantities of a scene, found in its world.
class Watched {
 public:
  Watched(const SceneDef& scene, const BuiltScene& built, const std::vector<Quantity>& quantities);
  double value(const World& world, std::size_t quantity) const;
  // Of the vector that a component is of, and of positions the size of the scene: against it zeros are told
  // from what is left of them by rounding.
  double size(const World& world, std::size_t quantity) const;
  Output output(std::size_t quantity) const;

 private:
  struct Place {
    Quantity quantity;
    BodyId body{};
    MaterialPoint point{};
    EffectId effect{};
    std::string effect_name;
  };
  // What components are of.
  Vec3 vector(const World& world, const Place& place) const;
  static double gauge(const World& world, const Place& place, std::string_view word);

  std::vector<Place> places_;
  double length_ = 0;  // of the diagonal of the scene [m]
};

struct Answer {
  bool found = false;
  std::string reason;        // why there is no equilibrium, where it is not found
  Eigen::VectorXd rest;      // of the data, as the scene begins
  Eigen::VectorXd values;    // of the data
  Eigen::VectorXd sizes;     // of each: Watched::size()
  Eigen::MatrixXd jacobian;  // by the numbers of the parameters, one after the other
  bool regular = true;       // false: derivatives are those of one side; `note` says why
  std::string note;
};

using ParametersOf = std::function<Result<std::vector<Parameter>>(const BuiltScene&)>;

// Builds the scene and goes through the times of the data; gradients where `parameters` are given. An error
// is bad input: a scene that does not build, parameters that are refused.
Result<Answer> answer(const SceneDef& scene, const Data& data, const ParametersOf& parameters, int threads);

// What is one of errors: of positions, volumes and lengths the largest change since rest among the data of
// their kind, of the others the largest value; not below what rounding leaves of a zero.
Eigen::VectorXd scales(const Data& data, const Answer& first);

// Refuses numbers that no scene of this size shows: millimeters for meters, milliliters for cubic meters; and
// kinds whose answers differ a thousandfold.
Result<void> check_units(const SceneDef& scene, const Data& data, const Answer& first);

// Statics with fixed loads; what others are refused for.
Result<void> check_statics(const SceneDef& scene, const char* who);

}  // namespace isochor::inverse
