// What is behind World: what a host said, the scene that it was compiled to, the state, and who advances it.
// Not a public header.
#pragma once

#include "engine/step/controller.h"
#include "isochor/world.h"

namespace isochor {

// A part of what a scene says, in words, and its fingerprint.
struct ScenePart {
  std::string what;
  std::uint64_t fingerprint = 0;
};

struct World::Impl {
  Impl(WorldOptions said, std::unique_ptr<Parallel> threads)
      : options(std::move(said)), parallel(std::move(threads)), methods(options, *parallel) {
    builder.set_world(WorldNumbers::next_world());
    methods.set_interrupt([this] { return interrupt.raised(); });
  }

  // What the host said.
  WorldOptions options;
  std::unique_ptr<Parallel> parallel;
  Builder builder;
  std::vector<EffectPtr> sources;
  std::function<void(const ProgressInfo&)> progress;
  Interrupt interrupt;

  // The compiled scene.
  std::vector<std::unique_ptr<EffectInstance>> instances;  // of sources
  std::vector<std::vector<HeldDirection>> held_by;         // by effect
  Amounts amounts{instances};
  Methods methods;
  std::string compile_error;
  std::vector<ScenePart> described;  // made when first asked for

  // What survives a step, and who makes steps; made by compile().
  State state;
  StateLayout layout;
  std::optional<IncrementData> data;
  std::optional<Controller> controller;

  bool compiled() const { return controller && methods.ready(); }
  // Null, and a line in the log, where an id leads nowhere; `call` is who was asked.
  const BodyData* find_body(BodyId body, const char* call) const;
  Result<void> compile();
  const System& system() const { return methods.system(); }
  Assembly& assembly() { return methods.chosen().assembly(); }
  std::span<const double> pool_memory() const { return layout.of_pools(state.extra); }

  // Evaluates forces and multipliers at the state.
  void evaluate_state(Want want);
  // phi - target - C lambda of all compliant rows at the state.
  std::vector<double> row_residuals();
  std::vector<Vec3> momenta();  // mass times velocity of every node [kg m/s]
  double law_energy();          // [J]

  // checkpoint.cpp
  const std::vector<ScenePart>& scene_parts();
  template <class M>
  Result<void> check_moment(const M& moment) const;  // of a saved state

 private:
  Result<void> compile_once();
  void tell_idle_rows();
  std::vector<double> gravity_mass() const;
  void begin_state();
};

}  // namespace isochor
