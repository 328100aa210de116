// Gradients of what an equilibrium shows by what the scene is made of. docs/derivatives.md has the formulas,
// what is supported, and what it costs.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "isochor/curves.h"
#include "isochor/effects/effect.h"
#include "isochor/export.h"
#include "isochor/ids.h"
#include "isochor/materials.h"
#include "isochor/types.h"

namespace isochor {

// A number J that an equilibrium shows.
struct ISOCHOR_API Output {
  enum class Kind : std::uint8_t {
    positions,
    distance,
    gauge,
    reaction,
    energy,
    square,
    stress,
    force,
    function
  };
  Kind kind = Kind::positions;
  BodyId body{};
  EffectId effect{};
  std::vector<Index> nodes;   // of the body
  std::vector<Vec3> vectors;  // weights or targets, one a node
  Vec3 point{};               // at rest [m], in place of nodes
  bool at_point = false;
  std::string quantity;  // of a gauge; of energies and stresses which
  Vec3 force{}, moment{};
  double target = 0;  // of a square
  Index cell = -1;    // of World::mesh(body)
  // Of the positions of a body: the number, and into `gradient` how it changes with each of them.
  using Function = std::function<Result<double>(std::span<const Vec3> x, std::span<Vec3> gradient)>;
  Function function;

  // Sum of weight . x over nodes: every linear function of positions.
  static Output positions(BodyId body, std::vector<Index> nodes, std::vector<Vec3> weights);
  // direction . x of a node, or of the material point that is at `point` at rest.
  static Output node(BodyId body, Index node, const Vec3& direction);
  static Output material_point(BodyId body, const Vec3& point, const Vec3& direction);
  // Half the sum of |x - target|^2 over nodes.
  static Output distance(BodyId body, std::vector<Index> nodes, std::vector<Vec3> targets);
  // A gauge of World::gauges(): the volume or pressure of a cavity, the tension or length of a cable.
  static Output gauge(EffectId effect, std::string quantity);
  // force . F + moment . M of the reaction (F, M) of a support, as World::reaction().
  static Output reaction(EffectId effect, const Vec3& force, const Vec3& moment = {});
  // World::elastic_energy().
  static Output elastic_energy();
  // One of World::energies(): "elastic", "gravity", "loads", "pressures", "potential", and of trajectories
  // "kinetic" and "total".
  static Output energy(std::string part);
  // Half the square of (sum of weight . x over nodes - target): quadratic functions are sums of these.
  static Output square(BodyId body, std::vector<Index> nodes, std::vector<Vec3> weights, double target);
  // Cauchy stress in a cell as World::fields() has it [Pa]: "von_mises", "pressure" (a third of the trace,
  // tension positive), or a component, "xx", "yy", "zz", "xy", "yz", "zx".
  static Output stress(BodyId body, Index cell, std::string measure);
  // direction . F, F being all that an effect does to the nodes of a body [N]: a contact (the grip of a
  // gripper, friction included), a cable, a cavity, springs. For supports there are reactions.
  static Output effect_force(EffectId effect, BodyId body, const Vec3& direction);
  // A number that a host makes of the positions of a body, with its gradient.
  static Output of_positions(BodyId body, Function function);
};

// A number p of the scene, or a list of them.
struct ISOCHOR_API Parameter {
  enum class Kind : std::uint8_t {
    amount,
    force,
    gravity,
    density,
    material,
    stiffness,
    cells,
    constant,
    shape,
    velocity,
    curve
  };
  Kind kind = Kind::amount;
  EffectId effect{};
  BodyId body{};
  std::string region;  // empty: all of the body
  double value = 0;    // where it is now
  // How far it is moved where a difference is taken; 0: 1e-4 of its value, and of amounts of at least 1.
  double step = 0;
  Vec3 point{}, vector{};
  std::vector<Vec3> motion;  // one a node
  Curve curve;
  Index number = -1;  // of a point of the curve
  std::function<Result<MaterialPtr>(double)> law;
  std::function<Result<EffectPtr>(double)> definition;

  // The amount of an effect, in its unit.
  static Parameter amount_of(EffectId effect);
  // The value of one point, from 0, of the curve that the amount of an effect follows, in its unit.
  static Parameter curve_point(EffectId effect, Curve curve, Index number);
  // A dead force on a point of a body, times a factor: `force` is the unit [N].
  static Parameter force_at(BodyId body, const Vec3& point, const Vec3& force);
  // Gravity along a direction [m/s^2]; the length of `direction` is the unit.
  static Parameter gravity(const Vec3& direction);
  static Parameter density(BodyId body, std::string region = {});  // [kg/m^3]
  // A constant of a material: `law` makes it, `value` is where the constant is now, and law(value) must be
  // the material that the region has. Laws may be refused on one side of `value` (nu = 0.5).
  static Parameter material(BodyId body, std::string region, double value,
                            std::function<Result<MaterialPtr>(double)> law);
  // A factor on the stiffness of a region, at 1: energy and bulk modulus, as with_stiffness_field() has it.
  static Parameter stiffness(BodyId body, std::string region = {});
  // The same of each cell by itself: as many numbers as the mesh of the body has cells. By the adjoint alone.
  static Parameter cell_stiffness(BodyId body);
  // A constant of an effect: `definition` makes it, and definition(value) must be the effect as it is.
  static Parameter constant_of(EffectId effect, double value,
                               std::function<Result<EffectPtr>(double)> definition);
  // Rest positions move by p times `motion`, one vector a node of World::mesh(body).
  static Parameter shape(BodyId body, std::vector<Vec3> motion);
  // Of trajectories: velocities at the start change by p times `motion`, one vector a node of
  // World::mesh(body).
  static Parameter initial_velocity(BodyId body, std::vector<Vec3> motion);
};

struct GradientQuery {
  std::vector<Output> outputs;
  std::vector<Parameter> parameters;
  // adjoint: one solve an output; tangent: one solve a parameter. automatic: whichever solves less.
  enum class Mode : std::uint8_t { automatic, adjoint, tangent };
  Mode mode = Mode::automatic;
  // Equilibria that are unstable under fixed loads have gradients too; they are refused unless asked for.
  bool unstable = false;
};

struct Gradients {
  std::vector<double> values;  // of the outputs
  // dJ/dp: [output][parameter][number of the parameter], one number but for cell_stiffness.
  std::vector<std::vector<std::vector<double>>> by;
  // False: rows are about to touch or to let go, so that the derivative is that of one side, or friction
  // holds on to what it pulls with. `note` says it in words, `undecided` names the effects of such rows.
  bool regular = true;
  std::string note;
  std::vector<std::string> undecided;
  bool adjoint = false;  // how it was found
  // Of trajectories: how many states of the way were kept at most at a time, what one takes [bytes], and how
  // many steps were made again.
  Index kept_states = 0, steps_again = 0;
  std::size_t state_bytes = 0;

  double of(std::size_t output, std::size_t parameter) const { return by[output][parameter].front(); }
};

// A number that a trajectory shows: the sum of outputs, each at the end of one of its steps.
struct TimedOutput {
  struct Term {
    Index step = 0;  // from 1; 0: where the trajectory begins
    Output output;
  };
  std::vector<Term> terms;
};

struct TrajectoryQuery {
  std::vector<double> steps;  // lengths of the increments, from the state that the world is at [s]
  std::vector<TimedOutput> outputs;
  std::vector<Parameter> parameters;
  GradientQuery::Mode mode = GradientQuery::Mode::automatic;
  // Of the adjoint: how many states of the way may be kept at a time, beside its two ends and those of the
  // step at hand. Others are made again from them when their turn comes, by as few steps as that takes. 0:
  // all are kept and none is made again. Tangents go along with the way and keep none.
  Index kept_states = 0;
};

// Where an error of discretization comes from: what World::error_origins() finds.
struct ErrorOrigin {
  // Parts of one, by number of the body and cell of World::mesh(); empty for bodies that are not there. All
  // zero where nothing is in error: a body at rest, or strained by the same everywhere.
  std::vector<std::vector<double>> cells;
  // False: the parts are those of the error of the strain, whatever it does to the output, for the reason
  // that the note gives; empty where no output was asked for.
  bool by_output = false;
  std::string note;
};

}  // namespace isochor
