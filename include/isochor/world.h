// The facade a host embeds: build a scene from bodies and effects, advance it, read positions without
// copying. To be read in this order: bodies.h, selection.h, effects/, options.h, this file, reports.h,
// measures.h. Worlds are independent of each other; one world is used by one thread at a time, except for
// cancel(), which any thread may call. Nothing here throws but std::bad_alloc, and that only what returns
// neither a Result nor a StepReport, which say it: the world is as it was before a call for which memory did
// not suffice, or where an advance had got to.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "isochor/abi.h"
#include "isochor/bodies.h"
#include "isochor/derivatives.h"
#include "isochor/effects/effect.h"
#include "isochor/export.h"
#include "isochor/host.h"
#include "isochor/ids.h"
#include "isochor/measures.h"
#include "isochor/options.h"
#include "isochor/poses.h"
#include "isochor/reports.h"
#include "isochor/selection.h"

namespace isochor {

struct ErrorOrigin;
struct GradientQuery;
struct Gradients;
struct Output;
struct TrajectoryQuery;

// Stands for what the public headers say and for how the host's compiler lays it out.
inline constexpr std::uint64_t kWorldAbi = [] {
  std::uint64_t abi = kPublicHeaders;
  for (const std::size_t size :
       {sizeof(std::string), sizeof(std::vector<double>), sizeof(std::function<void()>), sizeof(BodyDef),
        sizeof(WorldOptions), sizeof(StepReport), sizeof(BodyFields)}) {
    abi = (abi ^ size) * 0x100000001b3u;
  }
  return abi;
}();

class ISOCHOR_API World {
 public:
  // `abi` catches a host that was built against headers of another version.
  static Result<World> create(WorldOptions options, std::uint64_t abi = kWorldAbi);
  // The same with threads and a log of the host; the results have the same bits.
  static Result<World> create(WorldOptions options, Host host, std::uint64_t abi = kWorldAbi);
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;
  ~World();

  // The mesh is checked here, names are resolved in compile().
  Result<BodyId> add_body(BodyDef body);
  Result<EffectId> add(EffectPtr effect);
  // Builds the system, or what has changed of it. Called by what needs it: the next step, and all that reads
  // the state. An error of the first compilation stays; changes of a compiled world that fail are taken back,
  // all of them since the last compilation, which compile() or the next step says once, and the world goes on
  // as it was.
  Result<void> compile();
  // Of the last compilation that there was something to do for.
  const CompileReport& compile_report() const;

  // Changes of a world that lives, beside add_body() and add(). What is untouched keeps its state bit for
  // bit, multipliers included; nodes that are new are at rest, rows that are new begin with zero. Ids of
  // what is gone are refused.
  //
  // Cost, as CompileReport tells it: constants (materials, densities, and effects that are replaced by one of
  // the same nodes and rows: friction, compliance, stiffness, rest lengths) cost new numbers, all else a new
  // structure. Gravity, amounts, poses and forces cost nothing.
  Result<void> remove(EffectId effect);
  Result<void> remove(BodyId body);  // that no effect names
  // Another definition in the place of an effect, whose id, multipliers and memory stay where rows and nodes
  // are as many as before; what a host has set of it (amount, pose) stays too.
  Result<void> replace(EffectId effect, EffectPtr with);
  // Of one region, or of all regions of the body where the name is empty.
  Result<void> set_material(BodyId body, const std::string& region, MaterialPtr material);
  Result<void> set_density(BodyId body, const std::string& region, double density);  // [kg/m^3]

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

  // Gravity [m/s^2] from now on instead of WorldOptions; ramps like amounts. Liquids in chambers keep theirs.
  Result<void> set_gravity(const Vec3& gravity);
  // Where a support or an obstacle is from now on, instead of its displacement, motion or bone: it gets there
  // in the course of the next increment. The pose carries points as a bone does (poses.h): from the first
  // keyframe of its track, or from the origin where it has none, so that a pose at (d, no turn) displaces by
  // d. Its time does not matter.
  Result<void> set_pose(EffectId effect, const Pose& pose);
  // Dead forces on nodes [N], one a node: in place of those of the body, or on top of them at one node or at
  // a point of the body (at rest [m]). They stay until they are set anew or cleared, of all bodies; in
  // statics they jump.
  Result<void> set_forces(BodyId body, std::span<const Vec3> forces);
  Result<void> add_force(BodyId body, Index node, const Vec3& force);
  Result<void> add_force_at(BodyId body, const Vec3& point, const Vec3& force);
  void clear_forces();

  // Puts the nodes of a body somewhere else, one position a node: crushed, tangled or turned inside out. The
  // body is at rest there and its rows have no multipliers; the next step starts from this. For materials
  // that live through inversion.
  Result<void> set_positions(BodyId body, std::span<const Vec3> positions);

  // Dynamics: how fast the nodes of a body move, one velocity a node [m/s]. Multi-step schemes forget their
  // past.
  Result<void> set_velocities(BodyId body, std::span<const Vec3> velocities);

  // Whether an id leads to a body or an effect of this world; the reason names it. Calls that return a Result
  // say the same. Those that return a value return an empty one and tell the log, or standard error.
  Result<void> check(BodyId body) const;
  Result<void> check(EffectId effect) const;

  double time() const;
  // Views of the state's own numbers. Steps, load(), reset() and changes of constants leave them where they
  // are and put new numbers in; where the structure changes, and with the world, they end.
  std::span<const Vec3> positions(BodyId body) const;
  std::span<const Vec3> velocities(BodyId body) const;
  // While it is held, views of a compiled world may be read even where they have ended: they then show the
  // last numbers that they had.
  std::shared_ptr<const void> keep_views() const;
  std::span<const Vec3> rest_positions(BodyId body) const;
  // The mesh as the engine uses it (raised to Tet10 when the element asked for it).
  const Mesh& mesh(BodyId body) const;
  const std::string& body_name(BodyId body) const;
  const std::string& effect_name(EffectId effect) const;
  // All that are there, changes that wait included: bodies by number, effects in the order they were added.
  std::vector<BodyId> bodies() const;
  std::vector<EffectId> effects() const;
  Index body_count() const;

  BodyMeasures measures(BodyId body) const;
  BodyFields fields(BodyId body) const;
  std::vector<Gauge> gauges() const;
  // Sum of the support forces [N] and their moment about the origin [N m] of an effect that prescribes
  // positions.
  std::array<Vec3, 2> reaction(EffectId effect) const;
  // Points of contacts that press, in the order of effects and of their rows; and the sums of every two
  // partners, in the order in which they are met.
  std::vector<ContactPoint> contacts() const;
  std::vector<ContactPair> contact_pairs() const;
  double elastic_energy() const;  // [J], distortion plus compliance
  double kinetic_energy() const;  // [J]
  Energies energies() const;
  // Of everything that has mass, rigid bodies included: linear [kg m/s], and angular about the origin
  // [kg m^2/s].
  std::array<Vec3, 2> momentum() const;
  // Refused where the nodes lie on one line or in one point, at rest or now: that has no rotation. Nodes of
  // surfaces count by the area they stand for, those of other selections equally.
  Result<Orientation> orientation(const Selection& where) const;
  // Derivatives of the equilibrium that the state is at, by each input: positions, gauges, reactions. Of
  // dynamics it is that without inertia. One factorization, two solves an input. Refused where the matrix is
  // singular, and with methods that have no factors of all of it.
  Result<std::vector<Response>> derivatives(std::span<const ResponseInput> inputs);
  // Gradients of numbers that the equilibrium shows by constants of materials and effects, stiffnesses of
  // cells, densities, gravity, amounts and rest positions (gradients.h). The state stays as it is.
  Result<Gradients> gradients(const GradientQuery& query);
  // Goes through increments of these lengths, as step() does, and finds the gradients of what is seen on the
  // way. The world is at the end of them then, with the bits of the same steps; on an error it is where it
  // was. Every time scheme. Refused with what remembers, lags or looks back over an increment: contact with
  // friction or on surfaces, impacts, damping, gas and liquid, viscoelasticity.
  Result<Gradients> trajectory_gradients(const TrajectoryQuery& query);
  // How much each cell has to do with the error that the mesh makes in each output: the error of the strain
  // there, found by recovery, times how far the output feels it, in statics by its adjoint. One for the
  // strain alone where no output is given. For choosing cells to refine (refine_cells()); how large the error
  // is it does not say. One factorization, two solves an output. Errors: what gradients() says of outputs.
  Result<std::vector<ErrorOrigin>> error_origins(std::span<const Output> outputs);
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
  // Back to the state at rest at time 0 that the scene begins with, with the bits of a new world. Bodies,
  // effects and materials stay as they are now; amounts, gravity and poses that a host has set, and its
  // forces, are forgotten.
  Result<void> reset();
  // Another world with the same scene, state and settings, which goes on with the same bits; what nobody
  // changes (tables of the system, the ordering of its factors) is shared. Ids of this one are good there as
  // well. Callbacks stay behind, the log comes along. `threads`: of its own, 0: as many as this world has.
  Result<World> clone(int threads = 0) const;

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
