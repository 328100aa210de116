// Constraints, supports and loads. Each function makes an effect for World::add; bad parameters are reported
// there.
#pragma once

#include "isochor/painted.h"
#include "isochor/poses.h"
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

// A set of cells with one row; zones may overlap. What fits any of the criteria is in it.
struct VolumeZone {
  std::string name;
  std::vector<std::string> regions;
  std::vector<Index> cells;                // of the body's mesh
  std::vector<std::array<Vec3, 2>> boxes;  // lower and upper corner [m]: cells with their center inside
  // A field of the mesh with weights from 0 to 1 painted on its surface; cells get the weights of the points
  // of the surface that they are projected to (isochor/painted.h). Painted zones share cells by weight.
  std::string field;
  // Times 1/kappa: 0 is a hard zone, infinity leaves the row out.
  double compliance = 1;
};

struct VolumeDef {
  std::string name = "volume";
  BodyId body{};
  VolumeSpace space = VolumeSpace::node;
  VolumeStrainKind strain = VolumeStrainKind::linear;
  // Regions it covers; empty: all. Rows are split at interfaces between regions, where the pressure jumps.
  std::vector<std::string> regions;
  // Space ring: one row over the cells within so many rings around each node, 1 those that touch it.
  int rings = 1;
  std::vector<VolumeZone> zones;  // space zone
  // Of painted zones: what becomes of cells that nothing was painted on, and the surfaces that were painted
  // (empty: all of the boundary).
  UnpaintedCells unpainted = UnpaintedCells::none;
  std::vector<std::string> painted_surfaces;
  // Spaces body and zone: rows over cells of several regions. Each cell adds its own volume/kappa to the
  // compliance of its row, and the pressure is the same in all of them. False: `body` gives one row a region,
  // and zones over several are refused.
  bool across_regions = false;
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

// How prescribed positions enter the system.
enum class SupportTreatment : std::uint8_t {
  eliminated,  // no unknowns; exact, reactions are reported
  multiplier,  // hard rows, the reactions are unknowns: for points inside elements, and beside other supports
  stiffness,   // compliant rows: springs to the prescribed positions, the soft attachment to a bone
};

// Prescribed positions, by default eliminated from the unknowns; reactions are reported.
struct DirichletDef {
  std::string name = "fixed";
  Selection where;
  // Directions that are given; empty: all three. Need not be orthogonal or unit length.
  std::vector<Vec3> directions;
  // Displacement [m] at amount 1, and a rotation [rad] about an axis at amount 1; both zero: held in place.
  Vec3 displacement{};
  Vec3 axis_point{}, axis{};
  double angle = 0;
  // Instead of displacement and angle: the nodes move with this bone.
  PoseTrack bone;
  // Scales displacement and angle over time; a bone has its own times.
  Curve amount = Curve::constant(1);
  SupportTreatment treatment = SupportTreatment::eliminated;
  // Of treatment `stiffness`: of all springs together, along each direction [N/m].
  double stiffness = 0;
  // Points anywhere in the body, held like nodes; not with treatment `eliminated`. With points the selection
  // may be empty.
  std::vector<Vec3> points;
};
EffectPtr dirichlet(DirichletDef def);

// Holds nodes of one body to the material points of another (or the same) that they lie on at rest.
struct TieDef {
  std::string name = "tie";
  Selection where;       // nodes that are attached
  BodyId to{};           // the body that holds the points
  double stiffness = 0;  // of all springs together [N/m]; 0: hard
};
EffectPtr tie(TieDef def);

// ---- cables and fibers
// -------------------------------------------------------------------------------------------------

enum class CableControl : std::uint8_t {
  tension,       // amount: tension [N]; below zero counts as zero
  length,        // amount: length [m]
  length_ratio,  // amount: length over rest length
};

// A cable that runs straight between points of a body and slides through them without friction: one tension
// along all of it. It pulls and never pushes; slack, it carries nothing.
struct CableDef {
  std::string name = "cable";
  BodyId body{};
  std::vector<Vec3> points;  // rest positions in or on the body [m], in order
  // Fixed points outside the body where the cable comes from and goes to (a motor, a wall).
  std::optional<Vec3> from, to;
  CableControl control = CableControl::length_ratio;
  Curve amount = Curve::constant(1);
  double stiffness = 0;  // of the whole cable under length control [N/m]; 0: inextensible
};
EffectPtr cable(CableDef def);

// Threads that are bonded to the body along paths: every segment between two points has its own tension.
struct WindingDef {
  std::string name = "winding";
  BodyId body{};
  std::vector<std::vector<Vec3>> paths;  // rest positions in or on the body [m]
  double stiffness = 0;                  // tension over strain, E A [N]; 0: inextensible
  double slack = 0;                      // strain up to which a segment carries nothing
  bool pulls_only = true;                // false: it resists shortening too
};
EffectPtr winding(WindingDef def);

// Points of a helix about the axis from `start` to `end`; without turns between them, of a straight line.
// `out` is where the first point lies from the axis; its length is the radius. Negative turns: left-handed.
std::vector<Vec3> helix(const Vec3& start, const Vec3& end, const Vec3& out, double turns, int points);

// A thin layer on a surface, fabric or paper, that resists stretching: one thread along every edge.
struct StrainLimitDef {
  std::string name = "layer";
  BodyId body{};
  std::vector<std::string> surfaces;
  double stiffness = 0;    // Young's modulus times thickness [N/m]
  double slack = 0;        // strain up to which it carries nothing
  bool pulls_only = true;  // false: it resists shortening too
};
EffectPtr strain_limit(StrainLimitDef def);

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
};
EffectPtr pressure(PressureDef def);

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
EffectPtr cavity(CavityDef def);

// A valve between two chambers of control `gas` (of one polytropic exponent and ambient pressure) or
// `liquid`, or a leak to the outside. Volume flow, for gas measured at ambient pressure: conductance times
// opening times the difference of pressures; in statics per unit of the load factor.
struct ValveDef {
  std::string name = "valve";
  std::string from, to;               // names of cavities that were added before; `to` empty: outside
  double conductance = 0;             // [m^3/(s Pa)]
  Curve amount = Curve::constant(1);  // opening, 0: shut
};
EffectPtr valve(ValveDef def);

}  // namespace isochor
