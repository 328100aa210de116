// What is behind World. Not a public header.
#pragma once

#include <atomic>
#include <chrono>
#include <optional>

#include "engine/scene/builder.h"
#include "engine/solve/saddle_point.h"
#include "engine/step/admission.h"
#include "engine/step/time_scheme.h"
#include "isochor/world.h"

namespace isochor {

// A part of what a scene says, in words, and its fingerprint.
struct ScenePart {
  std::string what;
  std::uint64_t fingerprint = 0;
};

struct World::Impl {
  // Largest angle by which anything that is prescribed turns from t0 to t1 [rad].
  double largest_turn(double t0, double t1) const;
  WorldOptions options;
  std::unique_ptr<TbbParallel> parallel;
  Builder builder;
  std::vector<EffectPtr> sources;
  std::vector<std::unique_ptr<EffectInstance>> instances;
  std::vector<std::vector<HeldDirection>> held_by;  // by effect
  std::shared_ptr<const System> system;
  std::unique_ptr<SaddlePoint> newton;
  // Who solves what a dual method does not, in this order; made when first needed.
  struct StandIn {
    Method method;
    std::unique_ptr<SaddlePoint> solver;
  };
  std::vector<StandIn> stand_ins;
  std::string method;
  State state;
  std::string compile_error;
  std::atomic<bool> cancel_requested{false};
  std::optional<std::chrono::steady_clock::time_point> deadline;
  std::function<void(const ProgressInfo&)> progress;
  std::function<bool()> stop_asked;
  bool asked_to_stop() const {
    return cancel_requested.load(std::memory_order_relaxed) || (stop_asked && stop_asked());
  }
  bool interrupted() const;

  // Data of the increment under way; taken once, at compile time.
  std::vector<Vec3> x_trial, predicted, force, position, reactions;
  // What refine_gradients() goes back to; empty with other methods.
  std::vector<Vec3> x_found;
  std::vector<double> lambda_found;
  std::vector<double> weight, lambda_trial, target, prescribed,
      memory_before;  // weight: consistent nodal mass [kg]

  std::vector<double> amounts_before;
  bool starts_anew = false;      // the increment under way makes velocities jump (RowPool::look_back)
  std::vector<double> no_past;   // of a scheme in such an increment
  std::vector<double> row_work;  // of rows that look back; empty: there are none
  State state_before;            // of an increment that the control of errors may take back

  // Tests of the ends of increments (world_admission.cpp), and what they work with.
  std::optional<Admission> admission;
  Admission::Verdict verdict;  // of the last end that was looked at
  struct {
    bool known = false;  // false: outside forces do work, or there is nothing to compare with
    double kinetic = 0;
    SaddlePoint::Stored stored;
  } energy_before;
  State ahead;                                    // of dynamics: the state that an end would make
  std::vector<Vec3> momentum;                     // one a node
  std::array<std::vector<double>, 2> row_values;  // where obstacles may move
  bool moved_from_outside(const SaddleProblem& problem);
  void begin_energy(const SaddleProblem& problem);
  std::string energy_gained(double h, const SaddlePoint::Stored& stored);
  bool admissible(double h, const SaddleProblem& problem, SaddleReport& report);
  void describe_end(const SaddleReport& solve, StepReport& report);
  // The last state that a step arrived at in balance, while the present one is unfinished.
  std::optional<State> settled;
  bool give_back_unfinished(StepReport& report);
  std::string given_back;  // why the last attempt did not keep its iterate although it might have
  double moved = 0;        // farthest way of a node in the last increment [m]
  std::string led_away;    // of this step: an increment that ended far from where it began

  bool compiled() const { return newton != nullptr; }
  Result<void> compile();
  Result<void> compile_once();
  void tell_idle_rows();
  void allocate();
  void save_amounts(std::vector<double>& all) const;
  void load_amounts(std::span<const double> all);
  bool amounts_fit(std::span<const double> all) const;
  // checkpoint.cpp
  std::vector<ScenePart> described;  // made when first asked for
  const std::vector<ScenePart>& scene_parts();
  std::vector<std::shared_ptr<const StencilPool>> first_stencils;  // of a scene whose stencils follow
  template <class M>
  Result<void> check_moment(const M& moment) const;  // of a saved state
  Result<void> restore_stencils(std::span<const double> memory);
  void begin_amounts(double t0, double t1);
  void evaluate_data(double t);
  // state.extra: what row pools keep, what the time scheme keeps, what the control of errors keeps.
  std::span<double> scheme_memory() {
    return std::span(state.extra).subspan(at(system->memory()), options.scheme->memory(state.x.size()));
  }
  std::span<double> error_memory() {
    return std::span(state.extra).subspan(at(system->memory()) + options.scheme->memory(state.x.size()));
  }
  bool controls_error() const { return options.time_error > 0 && options.scheme->has_inertia(); }
  double estimate_error(double h);
  double largest_entry(double t0, double t1);
  void accept_memory(const StencilIncrement& increment);
  Index count_passing(const StencilIncrement& increment, bool stop);
  // Has stencils that change with what is close look at the trial positions, and takes over what they become.
  struct Surroundings {
    bool changed = false;
    Index crossed = 0, passing = 0;  // as in FollowAnswer
    std::string error;
  };
  Surroundings look_around(std::span<const Vec3> x, bool solved);
  Result<void> replace_stencils(std::vector<std::shared_ptr<const StencilPool>> pools);
  // What a solve may cost, and whether its last iterate is kept when that is used up.
  struct Allowance {
    int iterations = 0, factorizations = 0;
    bool keep_unfinished = false;
    // Beyond these a solve must get somewhere; 0: as above.
    int patient_iterations = 0, patient_factorizations = 0;
    // Bodies in motion go on beyond all of these while that leads downhill.
    bool persistent = false;
  };
  void keep_stencils(std::vector<std::shared_ptr<const StencilPool>> pools, const SaddleProblem& problem,
                     const Allowance& allowance, SaddleReport& report);
  SaddleProblem problem_at(double t);
  bool look_back(double t, double h);
  SaddleOptions saddle_options(const Allowance& allowance) const;
  SaddleReport attempt(double h, const Allowance& allowance);
  void refine_gradients(const SaddleProblem& problem, SaddleOptions saddle, SaddleReport& report);
  void judge(double h, const SaddleProblem& problem, SaddleReport& report);
  SaddleReport solve_increment(double h, SaddleProblem& problem, const Allowance& allowance, bool from_guess);
  std::unique_ptr<SaddlePoint> make_stand_in(Method other) const;
  SaddleReport solve_by(SaddlePoint& other, SaddleProblem& problem, const SaddleOptions& saddle);
  void accept(double h, std::span<const Vec3> prediction);
  SaddleReport rescue(double h);
  Result<void> make_method(SystemParts parts, bool keep_solvers = false);
  StepReport invalid(std::string reason) const;
  StepReport cancelled();
  void take_cancel(StepReport& report);
  void finish_report(StepReport& report, const StageSeconds& before, double total) const;
  // phi - target - C lambda of all compliant rows at the state.
  std::vector<double> row_residuals();
  std::vector<Vec3> momenta() const;  // mass times velocity of every node [kg m/s]
  double law_energy();                // [J]
  // Evaluates forces and multipliers at the state.
  void evaluate_state(Want want);
};

}  // namespace isochor
