// Constraints, supports and loads. Each function makes an effect for World::add; bad parameters are reported
// there.
#pragma once

#include "isochor/world.h"

namespace isochor {

// Nodes (or faces) of a body, by one or several criteria; what fits any of them is selected.
struct Selection {
  BodyId body{};
  std::vector<std::string> surfaces, regions, node_sets;
  std::vector<Index> nodes;                // indices into the body's mesh
  std::vector<std::array<Vec3, 2>> boxes;  // lower and upper corner [m], rest positions
  std::vector<Vec3> nearest;               // the node nearest to each point
  bool everything = false;
};

// ---- volume
// ----------------------------------------------------------------------------------------------------

enum class VolumeSpace : std::uint8_t { node, element, body, ring, zone };
enum class VolumeStrainKind : std::uint8_t { linear, logarithmic };  // J - 1, log J

// A set of cells with one row; zones may overlap. What fits any of the criteria is in it, all in one region.
struct VolumeZone {
  std::string name;
  std::vector<std::string> regions;
  std::vector<Index> cells;                // of the body's mesh
  std::vector<std::array<Vec3, 2>> boxes;  // lower and upper corner [m]: cells with their center inside
  // Times 1/kappa: 0 is a hard zone, infinity leaves the row out.
  double compliance = 1;
};

struct VolumeDef {
  std::string name = "volume";
  BodyId body{};
  VolumeSpace space = VolumeSpace::node;
  VolumeStrainKind strain = VolumeStrainKind::linear;
  // Regions it covers; empty: all. Rows are split at interfaces between regions, where the pressure jumps;
  // `body` gives one row a region.
  std::vector<std::string> regions;
  // Space ring: one row over the cells within so many rings around each node, 1 those that touch it.
  int rings = 1;
  std::vector<VolumeZone> zones;  // space zone
  // Dohrmann-Bochev stabilization of nodal rows on linear tets; ignored where inf-sup holds. 0: off.
  double stabilization = 1;
  // No bulk compliance whatever the material says (nodal rows keep their stabilization, which leaves totals
  // alone).
  bool hard = false;
  // True: these rows carry the bulk modulus and the elements keep only the distortional energy. False: the
  // rows come on top of other rows or of the complete one-field energy.
  bool carries_bulk = true;
  // How the linear systems take the rows; refused with the reason where it cannot be (docs/solver.md).
  RowTreatment treatment = RowTreatment::automatic;
  // Nodal rows: the compliance M_p/kappa lumped to its row sums, without stabilization, so that the rows can
  // be condensed. Another model than the consistent one; not for hard rows.
  bool lumped_compliance = false;
};
EffectPtr volume(VolumeDef def);

// ---- skin
// --------------------------------------------------------------------------------------------------------

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
EffectPtr epidermis(EpidermisDef def);

// A neo-Hookean membrane on surfaces, in plane stress: stretch and shear, no bending and no mass.
struct MembraneDef {
  std::string name = "membrane";
  BodyId body{};
  std::vector<std::string> surfaces;
  double young = 0;      // [Pa]
  double poisson = 0.5;  // [0, 0.5]
  double thickness = 0;  // [m]
};
EffectPtr membrane(MembraneDef def);

// ---- supports
// ----------------------------------------------------------------------------------------------------

// Prescribed positions, eliminated from the unknowns; reactions are reported.
struct DirichletDef {
  std::string name = "fixed";
  Selection where;
  // Directions that are given; empty: all three. Need not be orthogonal or unit length.
  std::vector<Vec3> directions;
  // Displacement [m] at amount 1, and a rotation [rad] about an axis at amount 1; both zero: held in place.
  Vec3 displacement{};
  Vec3 axis_point{}, axis{};
  double angle = 0;
  // Scales displacement and angle over time.
  Curve amount = Curve::constant(1);
};
EffectPtr dirichlet(DirichletDef def);

// ---- loads
// -------------------------------------------------------------------------------------------------------

// Dead traction [Pa] on faces (force per rest area), or a dead total force [N] spread over them.
struct TractionDef {
  std::string name = "traction";
  BodyId body{};
  std::string surface;
  Vec3 traction{};     // [Pa]
  Vec3 total_force{};  // [N], instead of traction
  Curve amount = Curve::constant(1);
};
EffectPtr traction(TractionDef def);

// Dead force [N], shared equally by the selected nodes.
struct PointForceDef {
  std::string name = "force";
  Selection where;
  Vec3 force{};
  Curve amount = Curve::constant(1);
};
EffectPtr point_force(PointForceDef def);

// ---- damping
// ------------------------------------------------------------------------------------------------------

// Damping in dynamics, on top of that of the time scheme; none in statics.
struct DampingDef {
  std::string name = "damping";
  BodyId body{};
  std::vector<std::string> regions;  // empty: all
  double viscosity = 0;              // [Pa s]: Kelvin-Voigt stress 2 viscosity dE/dt, E Green's strain
  double mass_rate = 0;  // [1/s]: force -mass_rate times momentum (the mass part of Rayleigh damping)
};
EffectPtr damping(DampingDef def);

// ---- cavity
// ------------------------------------------------------------------------------------------------------

enum class CavityControl : std::uint8_t {
  pressure,      // amount: gauge pressure [Pa], positive inflates; follows the surface
  volume,        // amount: volume [m^3]; the pressure is the multiplier
  volume_ratio,  // amount: volume over rest volume
};

struct CavityDef {
  std::string name = "cavity";
  BodyId body{};
  std::vector<std::string> surfaces;  // faces that bound the cavity; their winding does not matter
  CavityControl control = CavityControl::pressure;
  Curve amount = Curve::ramp(0);
  // Openings are closed by virtual caps: flat fans over each boundary loop of the surface. A loop that is not
  // wholly on a support is refused unless this is set, since nothing real would hold the pressure there.
  // Supports must be added before the cavity.
  bool cap_free_openings = false;
};
EffectPtr cavity(CavityDef def);

}  // namespace isochor
