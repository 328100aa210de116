// The method that solves the saddle points of a scene, its system and linear solvers, and the methods that
// stand in where it does not get there.
#pragma once

#include "engine/solve/newton/path_follower.h"
#include "engine/solve/saddle_point.h"
#include "isochor/options.h"

namespace isochor {

class Methods {
 public:
  // The first two outlive this.
  Methods(const WorldOptions& options, const Parallel& parallel, std::shared_ptr<const Ranks> ranks = {})
      : options_(options), parallel_(parallel), ranks_(std::move(ranks)) {}

  // Chooses treatment of rows, linear solver and method; refuses what does not go together. Tables of `like`
  // are shared where they are the same.
  Result<void> choose(SystemParts parts, const System* like = nullptr);
  // A system with other stencils in place of the present ones takes over its unknowns, solvers and memory.
  Result<void> replace_stencils(std::vector<std::shared_ptr<const StencilPool>> pools);
  // Goes on with the parts of a scene that was changed: with numbers alone where its structure is the same,
  // else with a system of its own, which takes over the solvers. On an error all is as it was.
  enum class Renewed : std::uint8_t { numbers, structure };
  Result<Renewed> renew(SystemParts parts);
  // Whether there is a method. Where memory runs out in the middle of a solve, or while stencils are
  // replaced, it is dropped: what it holds follows from the system and the state, and remake() makes it
  // again.
  bool ready() const { return chosen_ != nullptr; }
  void drop();
  void remake();

  const System& system() const { return *system_; }
  SaddlePoint& chosen() { return *chosen_; }
  const SaddlePoint& chosen() const { return *chosen_; }
  PathFollower* path_follower() { return path_follower_; }  // null: the scheme follows no paths
  // What the method is called, with the numbers of unknowns; and the linear solver that it has.
  std::string description() const;

  // Methods that may stand in, in the order in which they are tried.
  std::span<const Method> stand_ins() const { return {stand_ins_.data(), stand_ins_.size()}; }
  bool may_stand_in(Method method) const;
  // Made when first asked for; null: this build or the chosen solver cannot.
  SaddlePoint* stand_in(Method method);

  // Asked often, from any thread that works; true stops a solve.
  void set_interrupt(std::function<bool()> asked);

 private:
  Result<void> make(SystemParts parts, bool keep_solvers, const System* like = nullptr);
  Result<void> make_for(std::shared_ptr<System> system, bool prefer_iterative, bool keep_solvers);
  void list_stand_ins();
  Result<std::shared_ptr<System>> compile_system(SystemParts parts, const System* like) const;
  std::unique_ptr<LinearSolver> make_solver(const System& system, bool prefer_iterative) const;
  std::unique_ptr<LinearSolver> make_unsymmetric() const;
  bool may_have_two_levels(const System& system) const;
  std::unique_ptr<LinearSolver> release_solver(std::unique_ptr<LinearSolver>& unsymmetric);
  void make_chosen(std::unique_ptr<LinearSolver> solver, std::unique_ptr<LinearSolver> unsymmetric);
  bool large(const SystemParts& parts) const;
  std::unique_ptr<SaddlePoint> make_stand_in(Method method) const;

  const WorldOptions& options_;
  const Parallel& parallel_;
  std::shared_ptr<const Ranks> ranks_;
  std::function<bool()> interrupt_;
  std::shared_ptr<System> system_;
  std::unique_ptr<SaddlePoint> chosen_;
  PathFollower* path_follower_ = nullptr;  // chosen_, where it is one
  std::vector<Method> stand_ins_;
  std::vector<std::unique_ptr<SaddlePoint>> made_;  // of stand_ins_
  std::string counts_;                              // of rows by treatment, in words
};

std::string_view to_string(Method method);
RowTreatment treatment_of(Method method);
// Why a scene cannot be shared out over ranks; empty where it can.
std::string not_across_ranks(const WorldOptions& options);
// Why scheme, method and pools do not go together; empty where they do.
std::string incompatible(const SystemParts& parts, const WorldOptions& options);

}  // namespace isochor
