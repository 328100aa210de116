// Thin layers on surfaces.
#pragma once

#include <string>
#include <vector>

#include "isochor/effects/effect.h"
#include "isochor/export.h"
#include "isochor/ids.h"

namespace isochor {

// A thin layer on surfaces that resists changes of area alone: one row a face with the strain
// m sqrt(1 + gamma m^2/6), m the area ratio - 1, and the compliance area / stiffness.
struct EpidermisDef {
  std::string name = "epidermis";
  BodyId body{};
  std::vector<std::string> surfaces;
  // Either the three of the layer, stiffness = thickness young poisson/((1 + poisson)(1 - 2 poisson)), or
  // the stiffness itself. An infinite one (poisson = 0.5) keeps the area of every face.
  double young = 0, poisson = 0;  // [Pa], (0, 0.5]
  double thickness = 0;           // [m]
  double stiffness = 0;           // [N/m]
  double gamma = 0;               // [-] >= 0, how soon it stiffens
};
ISOCHOR_API EffectPtr epidermis(EpidermisDef def);

// A neo-Hookean membrane on surfaces, in plane stress: stretch and shear, no bending and no mass.
struct MembraneDef {
  std::string name = "membrane";
  BodyId body{};
  std::vector<std::string> surfaces;
  double young = 0;      // [Pa]
  double poisson = 0.5;  // [0, 0.5]
  double thickness = 0;  // [m]
};
ISOCHOR_API EffectPtr membrane(MembraneDef def);

// A thin layer on a surface, fabric or paper, that resists stretching: one thread along every edge.
struct StrainLimitDef {
  std::string name = "layer";
  BodyId body{};
  std::vector<std::string> surfaces;
  double stiffness = 0;    // Young's modulus times thickness [N/m]
  double slack = 0;        // strain up to which it carries nothing
  bool pulls_only = true;  // false: it resists shortening too
};
ISOCHOR_API EffectPtr strain_limit(StrainLimitDef def);

}  // namespace isochor
