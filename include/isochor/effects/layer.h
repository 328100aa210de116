// Thin layers on surfaces.
#pragma once

#include <string>
#include <vector>

#include "isochor/effects/effect.h"
#include "isochor/export.h"
#include "isochor/ids.h"
#include "isochor/selection.h"

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

// A thin sheet that stretches, shears and bends, and has mass: what a thin body is made of, or a layer on the
// surface of a solid one. A membrane as above with the bending of a Kirchhoff-Love shell.
struct ShellDef {
  std::string name = "shell";
  BodyId body{};
  std::vector<std::string> surfaces;  // empty: all of a thin body
  double young = 0;                   // [Pa]
  double poisson = 0.5;               // [0, 0.5]
  double thickness = 0;               // [m]
  double density = 0;                 // [kg/m^3]; 0: no mass, on solid bodies only
  // Stiffness of a plate against bending [N m]; 0: young thickness^3 / (12 (1 - poisson^2)). For what is no
  // solid sheet, such as a fabric.
  double bending = 0;
  // Edges at the rim of which both ends are selected keep the direction in which the sheet leaves them:
  // clamps, and planes of symmetry. Nodes (of the same body) are held by supports.
  Selection clamped;
  bool flat = false;  // free of bending when flat, not as the mesh has it
};
ISOCHOR_API EffectPtr shell(ShellDef def);

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
