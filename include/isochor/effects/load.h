// Forces on bodies: tractions, pressures, point forces, damping.
#pragma once

#include <string>
#include <vector>

#include "isochor/curves.h"
#include "isochor/effects/effect.h"
#include "isochor/export.h"
#include "isochor/ids.h"
#include "isochor/selection.h"

namespace isochor {

// Dead traction [Pa] on faces (force per rest area, or per area as it is), or a dead total force [N] spread
// over them.
struct TractionDef {
  std::string name = "traction";
  BodyId body{};
  std::string surface;
  Vec3 traction{};     // [Pa]
  Vec3 total_force{};  // [N], instead of traction
  Curve amount = Curve::constant(1);
  // A field of the mesh at nodes with one component: factors on the traction over the surface.
  std::string field;
  // A factor in space and time on top, an expression in x, y, z [m] at rest and t [s] (statics: load factor):
  // "sin(2*pi*t) * (1 - x/0.1)". Functions: abs, sqrt, exp, log, sin, cos, tan, tanh, atan2, min, max,
  // step(v): 1 for v >= 0, else 0. Taken at nodes, and between them as the shape functions have it.
  std::string profile;
  // Per area as it is: the force grows with the surface. Such a load has no potential, so that linear systems
  // are unsymmetric; `lagged` as of a pressure.
  bool current_area = false, lagged = false;
};
ISOCHOR_API EffectPtr traction(TractionDef def);

// Pressure that follows the faces it acts on: the force -p n per present area, n out of the body, so that
// a positive amount pushes inward. The faces are any part of the boundary, closed or not (a chamber whose
// volume matters is a cavity).
struct PressureDef {
  std::string name = "pressure";
  BodyId body{};
  std::vector<std::string> surfaces;  // their winding does not matter; a face named twice counts once
  Curve amount = Curve::constant(1);  // [Pa]
  // At a free rim the load has no potential and its tangent is unsymmetric, which linear systems then are.
  // True: what the rim adds is held within an iteration, so that they stay symmetric, and convergence is
  // linear there. Needed by continuation(), by the iterative solver and by methods of dual problems.
  bool lagged = false;
  // Factors on the amount, as of a traction: a field of the mesh at nodes, an expression. A pressure that
  // varies has no potential, so that linear systems are unsymmetric; `lagged` as at a free rim.
  std::string field, profile;
};
ISOCHOR_API EffectPtr pressure(PressureDef def);

// Dead force [N], shared equally by the selected nodes.
struct PointForceDef {
  std::string name = "force";
  Selection where;
  Vec3 force{};
  Curve amount = Curve::constant(1);
};
ISOCHOR_API EffectPtr point_force(PointForceDef def);

// Damping in dynamics, on top of that of the time scheme; none in statics.
struct DampingDef {
  std::string name = "damping";
  BodyId body{};
  std::vector<std::string> regions;  // empty: all
  double viscosity = 0;              // [Pa s]: Kelvin-Voigt stress 2 viscosity dE/dt, E Green's strain
  double mass_rate = 0;  // [1/s]: force -mass_rate times momentum (the mass part of Rayleigh damping)
};
ISOCHOR_API EffectPtr damping(DampingDef def);

}  // namespace isochor
