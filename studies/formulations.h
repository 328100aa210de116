// The element formulations that studies compare. A new one is a line of the table in formulations.cpp.
#pragma once

#include <span>
#include <string_view>

#include "scenes/scene.h"

namespace isochor::studies {

struct Formulation {
  std::string_view name;   // in ids: "tet10_node"
  std::string_view label;  // in diagrams
  Element element;
  // Complete one-field energy without volume rows. It refuses nu = 0.5 and is run at kOneFieldPoisson.
  bool one_field = false;
  VolumeSpace space = VolumeSpace::node;
  double stabilization = 1;  // of nodal rows on linear tets

  bool quadratic() const { return element == Element::tet10; }
};

// Poisson's ratio of a one-field formulation where a problem asks for 0.5.
inline constexpr double kOneFieldPoisson = 0.499;

std::span<const Formulation> formulations();
const Formulation& formulation(std::string_view name);  // must exist

// Gives the scene's bodies this formulation.
void apply(const Formulation& f, SceneDef& scene);

// Poisson's ratio of every material, with the elastic constants as E and nu. Materials given by mu and an
// infinite bulk modulus keep their mu. kappa = K, as in the references.
void set_poisson(SceneDef& scene, double nu);

}  // namespace isochor::studies
