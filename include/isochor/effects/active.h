// What solids do by themselves: muscles that pull along their fibers, and growth, a stress-free state that is
// not that of the mesh.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "isochor/curves.h"
#include "isochor/effects/effect.h"
#include "isochor/export.h"
#include "isochor/ids.h"
#include "isochor/types.h"

namespace isochor {

// Per which area the tension of a muscle is.
enum class MuscleTension : std::uint8_t {
  nominal,  // at rest
  current,  // as it is (at constant volume)
};

// Active stress along fibers: with the stretch s = |F a| of the unit direction a the energy per rest volume
// is w(s), w' = T f(s) (nominal) or T f(s)/s (current), T the amount [Pa] and f the dependence on length: 1
// without a width, else max(0, 1 - ((s - optimal_stretch)/width)^2). A positive amount pulls.
struct MuscleDef {
  std::string name = "muscle";
  BodyId body{};
  std::vector<std::string> regions;  // empty: all
  Vec3 direction{1, 0, 0};           // of the fibers at rest; any length but zero
  std::vector<Vec3> directions;      // instead: one a cell of the body's mesh
  std::string field;                 // instead: a field of the mesh with three components, in cells
  Curve amount = Curve::constant(1);
  MuscleTension tension = MuscleTension::nominal;
  double optimal_stretch = 1;  // where the muscle is strongest
  double width = 0;            // how far from there it pulls at all; 0: everywhere alike
};
ISOCHOR_API EffectPtr muscle(MuscleDef def);

// A stress-free state that is not that of the mesh: F = F_e F_g, and energies and volume rows are those of
// F_e (Rodriguez, Hoger & McCulloch 1994). At amount a a piece that nothing holds has F_g = 1 + a G, or with
// `volume` J_g = 1 + a volume in all directions alike. Stress is that of the law at F_e: what has grown is of
// the same material. The mass stays.
struct GrowthDef {
  std::string name = "growth";
  BodyId body{};
  std::vector<std::string> regions;  // empty: all
  // G, one of these. Strains at amount 1: the coefficient of thermal expansion with the amount a temperature.
  double linear = 0;                           // the same in all directions
  double volume = 0;                           // change of volume
  double along = 0, across = 0;                // along `direction`, and across it
  Vec3 direction{1, 0, 0};                     // any length but zero
  std::array<double, 6> strain{};              // symmetric xx, yy, zz, xy, yz, zx
  std::vector<std::array<double, 6>> strains;  // one a cell of the body's mesh
  // A field of the mesh in cells: with one component factors on the strains above, with six strains.
  std::string field;
  std::vector<double> factors;  // one a cell, on the strains above
  Curve amount = Curve::constant(1);
};
ISOCHOR_API EffectPtr growth(GrowthDef def);

}  // namespace isochor
