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
  bool one_field = false;  // complete energy without volume rows; refuses nu = 0.5
  VolumeSpace space = VolumeSpace::node;
  double stabilization = 1;  // of nodal rows on linear elements
  // A local penalty on changes of volume, beside a zone that keeps its total.
  bool penalty = false;
  // Largest Poisson's ratio at which it is run where a problem asks for 0.5.
  double most_poisson = 0.5;

  bool quadratic() const { return element == Element::tet10; }
  bool hexahedra() const { return element == Element::hex8; }
};

// Those of one-field formulations and of nodal rows without stabilization, whose matrix is singular at 0.5.
inline constexpr double kOneFieldPoisson = 0.499, kPlainPoisson = 0.4999;

std::span<const Formulation> formulations();
const Formulation& formulation(std::string_view name);  // must exist

// Gives the scene's bodies this formulation.
void apply(const Formulation& f, SceneDef& scene);

// Poisson's ratio of every material, with the elastic constants as E and nu. Materials given by mu and an
// infinite bulk modulus keep their mu. kappa = K, as in the references.
void set_poisson(SceneDef& scene, double nu);

}  // namespace isochor::studies
