// The facade a host embeds: build a scene from bodies and effects, advance it, read positions without
// copying.
//
// Nothing here throws. Worlds are independent of each other; one world is used by one thread at a time,
// except for cancel(), which any thread may call.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "isochor/materials.h"
#include "isochor/mesh.h"

namespace isochor {

class EffectSource;  // engine-side
class TimeScheme;    // engine-side
struct Selection;    // <isochor/effects.h>

// A constraint, load or support, made by the functions of <isochor/effects.h>. Resolved when the world is
// compiled.
using EffectPtr = std::shared_ptr<const EffectSource>;
// Made by the functions of <isochor/schemes.h>.
using SchemePtr = std::shared_ptr<const TimeScheme>;

enum class BodyId : Index {};
enum class EffectId : Index {};

// A quantity over time (seconds; in statics the load factor): piecewise linear through the points, constant
// outside.
struct Curve {
  std::vector<std::array<double, 2>> points;  // (time, value), times ascending
  static Curve constant(double value) { return {{{0, value}}}; }
  static Curve ramp(double value, double end = 1) { return {{{0, 0}, {end, value}}}; }
};
double evaluate(const Curve& curve, double t);

// How the distortion of a body is sampled.
enum class Element : std::uint8_t {
  tet4,                // one energy a tet: cheapest, stiff in bending
  tet4_edge_smoothed,  // energy on patches around edges: the default for accuracy per second
  tet10,               // quadratic displacements; the mesh is raised to Tet10 where it is Tet4
  hex8,                // trilinear hexahedra with eight points; needs a Hex8 mesh
};

struct RegionMaterial {
  std::string region;  // empty: every region not named elsewhere
  MaterialPtr material;
  double density = 1000;  // [kg/m^3]
};

struct BodyDef {
  std::string name = "body";
  Mesh mesh;
  Element element = Element::tet4_edge_smoothed;
  std::vector<RegionMaterial> materials;
  // Barrier against single tets turning over, edge-smoothed bodies only: energy -stiffness mu V
  // log^3(J/threshold) for J < threshold. 0 switches it off. By default 1, with a threshold of at most 0.1
  // where nu < 0.49, whose true compression it would falsify.
  std::optional<double> guard_stiffness;
  double guard_threshold = 0.5;
};

// Who solves the linear systems. All but `iterative` factor the matrix; that one iterates, with memory linear
// in the mesh (docs/solver.md). What a build does not have is refused when the world is compiled.
enum class Solver : std::uint8_t {
  automatic,
  mumps,
  cholmod,
  eigen,
  iterative,
  multifrontal,       // our own, in single precision where that is good enough
  cholmod_supernodal  // positive definite matrices only: no rows in the matrix. GPL, off by default
};

// How the saddle point of a step is solved. All but `position_based` end at the same solution; docs/solver.md
// compares their cost.
enum class Method : std::uint8_t {
  automatic,            // chosen when the world is compiled; World::method() says what and why
  saddle_point,         // Newton, direct factors of the whole saddle point
  condensation,         // Newton, compliant rows condensed into the stiffness, wide ones bordered
  dual_gradients,       // Newton, direct factors of the stiffness, conjugate gradients on the multipliers
  augmented_gradients,  // the same on an augmented stiffness: positive definite more often, fewer iterations
  dual_ascent,          // positions by Newton at fixed multipliers, these by steepest ascent; no saddle point
  augmented_ascent,     // the same on an augmented Lagrangian, steps in units of the row metric
  position_based,  // XPBD: a fixed number of Gauss-Seidel sweeps. Cheap, and not the solution: see the page
};

struct WorldOptions {
  SchemePtr scheme;  // required: implicit_euler(), statics(), ...
  Method method = Method::automatic;
  Solver solver = Solver::automatic;
  int sweeps = 20;          // of Method::position_based, a step
  int threads = 0;          // 0: all the machine has. The answer does not depend on it.
  int max_iterations = 60;  // Newton iterations a step; advance() may take five times as many in dynamics
  // Hessians of elements in Newton's method. Exact ones, made definite only where the matrix of a whole step
  // has the wrong inertia, need the fewest iterations; definite ones from the start lead other ways out of
  // crushed and tangled shapes (docs/elements.md).
  Definiteness definiteness = Definiteness::exact;
  double force_tolerance = 1e-9;  // unbalanced force, relative to the forces that cancel
  double row_tolerance = 1e-10;   // relative volume (or other measure) error of a row
  // Adaptive increments of advance(): smallest fraction of the increment asked for.
  double smallest_fraction = 1.0 / 64;
  // Where increments have shrunk to that and still fail, statics tries to reach the equilibrium through a
  // damped motion (pseudo-transient continuation) before it gives up.
  bool transient_rescue = true;
  // Dynamics: largest local error of positions an increment of advance() may have, root mean square over the
  // mass, relative to the scene's length. 0: increments are as long as they converge.
  double time_error = 0;
  // Inertia by the consistent mass matrix instead of the lumped one.
  bool consistent_mass = false;
  Vec3 gravity{};  // [m/s^2]; scaled by gravity_curve
  Curve gravity_curve = Curve::constant(1);
  std::function<void(const std::string&)> log;  // warnings; may be empty
};

enum class StepStatus : std::uint8_t {
  converged,
  rejected,  // no equilibrium found; the state is as it was
  cancelled,
  invalid,
  unfinished,  // the budget ran out: the state is the best iterate, the residuals say how good
};

// What a step may cost: Newton iterations and wall time. Time makes results depend on the machine.
struct StepBudget {
  int iterations = 0;  // 0: WorldOptions::max_iterations
  double seconds = 0;  // 0: no limit; an iteration under way is finished
};

// Seconds by stage of the work done.
struct StageTimes {
  double analyze = 0, evaluate = 0, gather = 0, factor = 0, solve = 0, line_search = 0, total = 0;
};

struct StepReport {
  StepStatus status = StepStatus::converged;
  std::string reason;  // empty when converged; else one sentence
  double time = 0;     // of the state now
  int substeps = 0, rejected_substeps = 0;
  int iterations = 0;   // Newton iterations, each with its own factorization
  int corrections = 0;  // further steps on factors at hand
  int lagged = 0;       // FrictionCoupling::coupled: iterations that fell back to lagged friction
  int factorizations = 0, trials = 0;
  int projected = 0, shifted = 0;  // iterations whose matrix had to be mended
  int dual_steps = 0;              // of dual ascent
  int stand_ins = 0;  // increments that a dual method left to Method::augmented_gradients or saddle_point
  std::int64_t dual_iterations = 0;    // of conjugate gradients on multipliers
  std::int64_t linear_iterations = 0;  // of Solver::iterative
  int rescues = 0;                     // increments that only a damped motion brought to their equilibrium
  int error_rejections = 0;  // increments that converged and were taken back for WorldOptions::time_error
  Index negative_pivots = -1, expected_negative_pivots = 0;
  // follow(): directions in which the equilibrium is unstable under fixed loads; -1: the backend cannot tell.
  Index unstable_directions = -1;
  double time_error = 0;  // estimate for the last increment, as in WorldOptions
  // Of the state now: smallest J over all cells (over points for Tet10 and Hex8), and cells with J <= 0. A
  // cell that started right side out is inverted only where its law lives through that and has no guard.
  double min_J = 1;
  Index inverted_cells = 0;
  // A sentence about an end that is admissible and yet not to be taken as it is: cells inverted or crushed,
  // an equilibrium far from the last one, rows that a fixed number of sweeps leaves unmet. Empty: none.
  std::string warning;
  double force_residual = 0, row_residual = 0, linear_residual = 0;
  StageTimes seconds;
};

// A named number that an effect reports.
struct Gauge {
  std::string effect, kind, quantity, unit;
  double value = 0;
};

struct WorldSize {
  Index nodes = 0, displacement_unknowns = 0, multipliers = 0;
  Index matrix_size = 0;  // displacements and the rows kept in the saddle point
  std::int64_t matrix_nonzeros = 0, factor_nonzeros = 0;
  std::size_t engine_bytes = 0;
};

// Volume of a body, or of one of its regions, now and at rest.
struct VolumeMeasures {
  std::string name;                    // of the region, or of the body
  double volume = 0, rest_volume = 0;  // [m^3]
  double min_J = 0, max_J = 0;         // over cells (points of a Tet10)
  // Relative, negative where volume was lost.
  double volume_change() const { return rest_volume > 0 ? volume / rest_volume - 1 : 0; }
};

// What the deformation and the motion of a body look like now.
struct BodyMeasures : VolumeMeasures {
  // What the volume rows of the body leave over, relative to the volume behind them. Compressible bodies may
  // lose volume while it is zero: volume_change() tells what they lost.
  double volume_row_residual = 0;
  double volume_error = 0;              // the same number by its former name
  Vec3 center_of_mass{};                // of the masses at the nodes [m]
  double mass = 0;                      // [kg]
  Vec3 linear_momentum{};               // [kg m/s]
  Vec3 angular_momentum{};              // about the origin [kg m^2/s]
  std::vector<VolumeMeasures> regions;  // in the order of the mesh
};

// Energies of the whole scene now. Potentials are those of the loads as they are now, zero at rest positions;
// what loads did on their way there, supports that move, valves, friction and damping do work that is not in
// here.
struct Energies {
  double kinetic = 0;  // [J]
  double elastic = 0;  // elastic_energy() [J]
  double gravity = 0;  // of the weight: -sum m g . (x - X) [J]
  double loads = 0;    // of tractions and point forces: -sum f . (x - X) [J]
  // Of given pressures and tensions, -p (V - V0) and T (L - L0), and of the gas in closed chambers [J].
  double pressures = 0;
  double potential() const { return elastic + gravity + loads + pressures; }
  double total() const { return kinetic + potential(); }
};

// How a set of nodes has turned and moved since rest: the rigid motion that fits it best.
struct Orientation {
  double angle = 0;     // [rad], 0 to pi: more than half a turn reads as the rest of it the other way round
  Vec3 axis{};          // unit vector of the turn, by the right hand; zero for no turn
  Vec3 displacement{};  // of the middle of the set [m]
  // Unit vector. Surfaces: the mean normal of their faces now. Other sets: the direction in which they are
  // flattest at rest, away from the body, turned with them. Zero for what has no direction: closed surfaces,
  // and sets that are more than 0.7 times as thick as they are wide.
  Vec3 normal{};
  double misfit = 0;  // root mean square distance from the shape at rest moved rigidly [m]
};

// Per-node and per-cell results of a body, recovered for output.
struct BodyFields {
  std::vector<double> node_pressure;  // tr(sigma)/3 [Pa], tension positive
  std::vector<double> node_stress;    // Cauchy stress xx yy zz xy yz zx [Pa], 6 a node
  std::vector<double> cell_J;
  std::vector<double> cell_pressure;   // tr(sigma)/3 [Pa]
  std::vector<double> cell_von_mises;  // [Pa]
  std::vector<double> cell_stress;     // Cauchy stress xx yy zz xy yz zx [Pa], 6 a cell
  std::vector<double> cell_max_stretch;
  // Normal and tangential force of contact on the body over the area at rest that a node stands for [Pa], the
  // latter as x y z; zero where nothing touches. Empty: no contact of the scene is about this body.
  std::vector<double> node_contact_pressure;
  std::vector<double> node_friction;
};

struct ProgressInfo {
  double time = 0, target = 0;
  int iteration = 0;
  double force_residual = 0, row_residual = 0;
};

inline constexpr std::uint64_t kWorldAbi = 1;

class World {
 public:
  // `abi` catches a host that was built against headers of another version.
  static Result<World> create(WorldOptions options, std::uint64_t abi = kWorldAbi);
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;
  ~World();

  // Bodies and effects are added before compile(); the mesh is checked here, names are resolved in compile().
  Result<BodyId> add_body(BodyDef body);
  Result<EffectId> add(EffectPtr effect);
  // Builds the system. Called by the first step when the host has not.
  Result<void> compile();

  // One increment of h seconds (statics: of load factor). A rejected step leaves the state bit for bit as it
  // was.
  StepReport step(double h);
  // The same within a budget, for hosts with a frame to draw: a step that does not converge in time is kept
  // at its last iterate, which has gone down in energy or towards its rows, and reported `unfinished`.
  // Nothing is kept that is not finite, or that has crushed cells or missed rows in such a way that the next
  // step would not find its way; then the step is rejected. Should a step fail that begins at an unfinished
  // state, the last state in balance takes its place, time included.
  StepReport step(double h, const StepBudget& budget);
  // As many increments as it takes to advance by h: halves increments that fail, lengthens them again. On
  // failure the state is the last one that converged and `time` says how far it got.
  StepReport advance(double h);
  // Statics, scheme continuation() only: one step of given length along the path of equilibria, through limit
  // points, where the load factor time() turns back. The length counts displacements, root mean square over
  // the nodes [m], and load: sqrt(rms^2 + (load_weight dt)^2). The step is halved up to ten times where it
  // fails; the report tells whether the equilibrium is stable.
  StepReport follow(double length);
  // Stops the step that runs, or else the next one, from any thread: it returns `cancelled`, the state as is.
  void cancel();

  // Sets the amount of an effect (a pressure [Pa], a volume [m^3], a scale), from now on instead of its
  // curve. In statics the next increment ramps from the old value to the new one.
  Result<void> set_amount(EffectId effect, double amount);

  // Puts the nodes of a body somewhere else, one position a node: crushed, tangled or turned inside out. The
  // body is at rest there and its rows have no multipliers; the next step starts from this. For materials
  // that live through inversion.
  Result<void> set_positions(BodyId body, std::span<const Vec3> positions);

  // Dynamics: how fast the nodes of a body move, one velocity a node [m/s]. Multi-step schemes forget their
  // past.
  Result<void> set_velocities(BodyId body, std::span<const Vec3> velocities);

  double time() const;
  // Views of the state's own numbers, valid until the next step or load().
  std::span<const Vec3> positions(BodyId body) const;
  std::span<const Vec3> velocities(BodyId body) const;
  std::span<const Vec3> rest_positions(BodyId body) const;
  // The mesh as the engine uses it (raised to Tet10 when the element asked for it).
  const Mesh& mesh(BodyId body) const;
  const std::string& body_name(BodyId body) const;
  Index body_count() const;

  BodyMeasures measures(BodyId body) const;
  BodyFields fields(BodyId body) const;
  std::vector<Gauge> gauges() const;
  // Sum of the support forces [N] and their moment about the origin [N m] of an effect that prescribes
  // positions.
  std::array<Vec3, 2> reaction(EffectId effect) const;
  double elastic_energy() const;  // [J], distortion plus compliance
  double kinetic_energy() const;  // [J]
  Energies energies() const;
  // Of everything that has mass, rigid bodies included: linear [kg m/s], and angular about the origin
  // [kg m^2/s].
  std::array<Vec3, 2> momentum() const;
  // Refused where the nodes lie on one line or in one point, at rest or now: that has no rotation. Nodes of
  // surfaces count by the area they stand for, those of other selections equally.
  Result<Orientation> orientation(const Selection& where) const;
  // Largest |phi - target - C lambda| of all rows, relative to their measure.
  double constitutive_residual() const;
  WorldSize size() const;
  std::uint64_t state_hash() const;
  // The method at work and why, in words: "saddle_point: ...".
  std::string method() const;
  // What compile() noticed and took in its stride.
  const std::vector<std::string>& warnings() const;

  // Everything that survives a step. Loading into a world of the same scene continues with the same bits.
  std::vector<std::byte> save() const;
  Result<void> load(std::span<const std::byte> bytes);

  void on_progress(std::function<void(const ProgressInfo&)> callback);
  // Asked many times a second while a step works, from any of the world's threads; true cancels the step,
  // which returns `cancelled` with the state as it was. Only single calls into other libraries (an ordering,
  // a factorization by MUMPS) are waited for.
  void stop_when(std::function<bool()> asked);

 private:
  struct Impl;
  explicit World(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace isochor
