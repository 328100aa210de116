// What is behind World. Not a public header.
#pragma once

#include <atomic>

#include "engine/builder.h"
#include "engine/newton.h"
#include "engine/time_scheme.h"
#include "isochor/world.h"

namespace isochor {

struct World::Impl {
  WorldOptions options;
  std::unique_ptr<TbbParallel> parallel;
  Builder builder;
  std::vector<EffectPtr> sources;
  std::vector<std::unique_ptr<EffectInstance>> instances;
  std::vector<std::vector<HeldDirection>> held_by;  // by effect
  std::shared_ptr<const System> system;
  std::unique_ptr<Newton> newton;
  State state;
  std::string compile_error;
  std::atomic<bool> cancel_requested{false};
  std::function<void(const ProgressInfo&)> progress;

  // Data of the increment under way; taken once, at compile time.
  std::vector<Vec3> x_trial, predicted, force, position, reactions;
  std::vector<double> weight, lambda_trial, target, prescribed,
      memory_before;  // weight: consistent nodal mass [kg]

  std::vector<double> amounts_before;

  bool compiled() const { return newton != nullptr; }
  Result<void> compile();
  Result<void> compile_once();
  void allocate();
  void save_amounts(std::vector<double>& all) const;
  void load_amounts(std::span<const double> all);
  void begin_amounts(double t0, double t1);
  void evaluate_data(double t);
  // The part of state.extra that the time scheme keeps.
  std::span<double> scheme_memory() { return std::span(state.extra).subspan(at(system->memory())); }
  void accept_memory(const StencilIncrement& increment);
  Index count_passing(const StencilIncrement& increment, bool stop);
  SaddleReport attempt(double h, int max_iterations, int max_factorizations);
  StepReport invalid(std::string reason) const;
  void finish_report(StepReport& report, const StageSeconds& before, double total) const;
  // phi - target - C lambda of all compliant rows at the state.
  std::vector<double> row_residuals();
  // Evaluates forces and multipliers at the state.
  void evaluate_state(Want want);
};

}  // namespace isochor
