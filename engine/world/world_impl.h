// What is behind World: what a host said, the scene that it was compiled to, the state, and who advances it.
// Not a public header.
#pragma once

#include "engine/scene/embedding.h"
#include "engine/step/controller.h"
#include "engine/world/description.h"
#include "isochor/world.h"

namespace isochor {

// A part of what a scene says, in words, and its fingerprint.
struct ScenePart {
  std::string what;
  std::uint64_t fingerprint = 0;
};

struct Equations;
struct Inertia;
struct Watched;

// Positions and velocities that a world has no more use for and that a host still looks at.
struct LeftViews {
  std::vector<Vec3> x, v;
};

struct World::Impl {
  Impl(WorldOptions given, std::unique_ptr<Parallel> threads, std::shared_ptr<const Ranks> ranks = {})
      : options(std::move(given)),
        parallel(std::move(threads)),
        amounts(instances, Gravity(options.gravity, options.gravity_curve)),
        methods(options, *parallel, ranks) {
    said.builder.set_world(WorldNumbers::next_world());
    // Ranks that were stopped at different places would wait for each other: they end a step together.
    if (!ranks) methods.set_interrupt([this] { return interrupt.raised(); });
  }
  ~Impl() { leave_views(nullptr); }

  // What the host said.
  WorldOptions options;
  std::unique_ptr<Parallel> parallel;
  Description said;                  // what the compiled scene was made of, or will be
  std::optional<Description> draft;  // of a compiled world that is to change
  std::function<void(const ProgressInfo&)> progress;
  Interrupt interrupt;

  // The compiled scene.
  std::vector<std::unique_ptr<EffectInstance>> instances;  // of sources
  std::vector<std::vector<HeldDirection>> held_by;         // by effect
  Amounts amounts;
  Methods methods;
  std::string compile_error;
  CompileReport compile_report;
  CompileReport untold;              // of all compilations since the last step
  std::vector<ScenePart> described;  // made when first asked for

  // What survives a step, and who makes steps; made by compile(). x and v stay where they are, see
  // take_over(); whoever gives them another place calls leave_views() first.
  State state;
  std::shared_ptr<LeftViews> views = std::make_shared<LeftViews>();
  StateLayout layout;
  // That the scene begins with, where stencils change with what is close.
  std::vector<std::shared_ptr<const StencilPool>> first_stencils;
  std::optional<State> settled;  // as in Controller
  std::optional<IncrementData> data;
  std::optional<Controller> controller;

  // Whether the scene is there, and who solves and makes steps; only where memory ran out it may be there
  // alone.
  bool scene_made() const { return !state.x.empty(); }
  bool compiled() const { return controller && methods.ready(); }
  // What changes are made to.
  Description& open_draft();
  const Description& latest() const { return draft ? *draft : said; }
  // Null where an id leads nowhere, which is told; `call` is who was asked. Changes that wait are made first.
  const BodyData* find_body(BodyId body, const char* call);
  // Why a call that returns a value has none: to the log, or to standard error where there is no log.
  void tell(const std::string& refusal);
  Result<void> compile();
  // The same for calls that only ask: whether there is a compiled scene. Why a change could not be made is
  // left for compile() and the next step to tell.
  bool ready();
  // What a step does, behind the changes that wait for it.
  template <class Step>
  StepReport after_compile(Step&& step);
  const System& system() const { return methods.system(); }
  Assembly& assembly() { return methods.chosen().assembly(); }
  std::span<const double> pool_memory() const { return layout.of_pools(state.extra); }

  // Hands the numbers of positions and velocities to who holds World::keep_views(), if anybody does.
  void leave_views(std::shared_ptr<LeftViews> next) noexcept;
  // Evaluates forces and multipliers at the state.
  void evaluate_state(Want want);
  // phi - target - C lambda of all compliant rows at the state.
  std::vector<double> row_residuals();
  std::vector<Vec3> momenta();  // mass times velocity of every node [kg m/s]
  // As World::reaction(), at another state, whose reactions are residual forces.
  std::array<Vec3, 2> reaction_of(Index effect, const State& at_state) const;
  // Why derivatives at the state are those of one side; `effects`: whose rows are about to touch or to let
  // go.
  struct Irregular {
    std::string note;
    std::vector<std::string> effects;
  };
  Irregular irregular();
  // derivatives.cpp
  struct Derivatives;
  struct Equilibrium;  // gradient_parts.h
  class Trajectory;    // trajectory.cpp
  Result<Response> derivative(Derivatives& d, Amount* amount, PointInBody point, const Vec3& force);

  // checkpoint.cpp
  const std::vector<ScenePart>& scene_parts();
  template <class M>
  Result<void> check_moment(const M& moment) const;  // of a saved state

  // The state at rest.
  void begin_state();
  Result<void> put_stencils_back();
  void take_over(State&& next) noexcept;
  Result<void> compile_like(Impl& other);              // renewal.cpp
  Result<BuiltParts> build_beside(Description& next);  // renewal.cpp
  // The equations of a changed scene at the present state; one with other nodes, rows or memory is refused.
  Result<Equations> equations_beside(Description next, std::span<const Watched> watched,
                                     const Inertia* inertia = nullptr);

 private:
  Result<void> compile_now();
  Result<void> compile_first();
  void tell_idle_rows();
  void make_controller();
  Result<void> mend();

  Result<void> renew();  // renewal.cpp

  bool used_up = false;  // the builder, by a first compilation for which memory did not suffice
};

}  // namespace isochor
