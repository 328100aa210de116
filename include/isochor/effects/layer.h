// Thin layers on surfaces.
#pragma once

#include <string>
#include <vector>

#include "isochor/curves.h"
#include "isochor/effects/effect.h"
#include "isochor/export.h"
#include "isochor/ids.h"
#include "isochor/materials.h"
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

// How much a sheet is stretched where the body is at rest: seen from the sheet without stress. A sheet that
// was pulled before it was bonded has stretches above 1, one that swells below.
struct Prestretch {
  double along = 1, across = 1;
  Vec3 direction{1, 0, 0};  // projected into each face; of no matter where both stretches are the same
};

// A neo-Hookean membrane on surfaces, in plane stress: stretch and shear, no bending and no mass.
struct MembraneDef {
  std::string name = "membrane";
  BodyId body{};
  std::vector<std::string> surfaces;
  double young = 0;      // [Pa]
  double poisson = 0.5;  // [0, 0.5]
  double thickness = 0;  // without stress [m]
  Prestretch prestretch;
  Curve amount = Curve::constant(1);  // of the prestretch: stretches are 1 + amount (stretch - 1)
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
  Prestretch prestretch;
  Curve amount = Curve::constant(1);  // as of a membrane
  // That only pull, in the middle of the sheet, their directions projected into each triangle. `directions`
  // are one a cell of a thin body. No dispersion; k1 and straight_modulus are those of the sheet, fibers and
  // what holds them together.
  std::vector<FiberFamily> fibers;
  std::string fiber_field;  // their directions: a field of the mesh in cells with three components
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
