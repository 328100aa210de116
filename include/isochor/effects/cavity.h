// Chambers filled with air, gas or liquid, and valves between them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "isochor/curves.h"
#include "isochor/effects/effect.h"
#include "isochor/export.h"
#include "isochor/ids.h"

namespace isochor {

enum class CavityControl : std::uint8_t {
  pressure,      // amount: gauge pressure [Pa], positive inflates; follows the surface
  volume,        // amount: volume [m^3]; the pressure is the multiplier
  volume_ratio,  // amount: volume over rest volume
  gas,           // amount: gas supplied so far, over what fills the chamber at rest and ambient pressure
  liquid,        // amount: liquid supplied so far, over the rest volume
};

struct CavityDef {
  std::string name = "cavity";
  BodyId body{};
  std::vector<std::string> surfaces;  // faces that bound the cavity; their winding does not matter
  CavityControl control = CavityControl::pressure;
  Curve amount = Curve::ramp(0);
  // Of control `gas`: p V^n stays the same for a given mass, p the absolute pressure. 1: isothermal.
  double polytropic = 1;
  double ambient = 101325;  // absolute pressure outside [Pa]
  // Weight of a liquid that fills it: the pressure grows with depth, and is reported for the height of
  // `datum`, by default the middle of the bounding surface at rest.
  double density = 0;  // [kg/m^3]; 0: weightless
  Vec3 gravity{};      // [m/s^2], of the liquid
  Curve gravity_curve = Curve::constant(1);
  std::optional<Vec3> datum;
  // Openings are closed by virtual caps: flat fans over each boundary loop of the surface. A loop that is not
  // wholly on a support is refused unless this is set, since nothing real would hold the pressure there.
  // Supports must be added before the cavity.
  bool cap_free_openings = false;
};
ISOCHOR_API EffectPtr cavity(CavityDef def);

// A valve between two chambers of control `gas` (of one polytropic exponent and ambient pressure) or
// `liquid`, or a leak to the outside. Volume flow, for gas measured at ambient pressure: conductance times
// opening times the difference of pressures; in statics per unit of the load factor.
struct ValveDef {
  std::string name = "valve";
  std::string from, to;               // names of cavities that were added before; `to` empty: outside
  double conductance = 0;             // [m^3/(s Pa)]
  Curve amount = Curve::constant(1);  // opening, 0: shut
};
ISOCHOR_API EffectPtr valve(ValveDef def);

}  // namespace isochor
