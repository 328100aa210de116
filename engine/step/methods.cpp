#include "engine/step/methods.h"

#include <algorithm>

#include "engine/solve/dual_ascent.h"
#include "engine/solve/newton/unsymmetric_newton.h"
#include "engine/solve/position_based.h"
#include "engine/solvers/two_level/two_level_solver.h"
#include "engine/step/time_scheme.h"

namespace isochor {

namespace {

constexpr std::size_t large_scene = 60000;  // displacements

bool climbs(Method method) {
  return method == Method::dual_ascent || method == Method::augmented_ascent;
}

// How many rows are treated how, in words.
std::string count_rows(const System& system) {
  const auto count = [](std::span<const Index> rows) { return std::to_string(rows.size()); };
  return std::to_string(system.free_unknowns()) + " displacements; rows: " + count(system.kept_rows()) +
         " in the matrix, " + count(system.condensed_rows()) + " condensed, " +
         count(system.bordered_rows()) + " bordered, " + count(system.dual_rows()) + " dual";
}

}  // namespace

// Iterations win where matrices are large. They cannot tell an inertia, though, so that equilibria are left
// to factors as long as these fit; inertia of mass keeps a step of dynamics away from that.
bool Methods::large(const SystemParts& parts) const {
  const bool plain = options_.method == Method::automatic || options_.method == Method::saddle_point;
  return 3 * parts.rest.size() >= large_scene && plain && options_.solver == Solver::automatic &&
         options_.scheme->has_inertia() && !options_.scheme->follows_paths();
}

Result<void> Methods::choose(SystemParts parts, const System* like) {
  if (std::string why = incompatible(parts, options_); !why.empty()) return Error{std::move(why)};
  if (ranks_) {
    if (std::string why = not_across_ranks(options_); !why.empty()) return Error{std::move(why)};
  }
  return make(std::move(parts), false, like);
}

Result<void> Methods::replace_stencils(std::vector<std::shared_ptr<const StencilPool>> pools) {
  SystemParts parts = system_->parts();
  parts.stencil_pools = std::move(pools);
  const StageSeconds spent = chosen_->seconds();
  if (auto r = make(std::move(parts), true); !r) return r;
  chosen_->add_seconds(spent);
  return {};
}

Result<Methods::Renewed> Methods::renew(SystemParts parts) {
  if (ranks_)
    return Error{
        "world: a scene that is shared out over ranks does not change yet; make another world of it"};
  if (std::string why = incompatible(parts, options_); !why.empty()) return Error{std::move(why)};
  const bool prefer_iterative = large(parts);
  bool same_solver = prefer_iterative == large(system_->parts());
  auto compiled = compile_system(std::move(parts), system_.get());
  if (!compiled) return compiled.failure();
  std::shared_ptr<System> system = std::move(compiled).value();
  const bool same = system->shares_tables(*system_);
  same_solver = same_solver && may_have_two_levels(*system) == may_have_two_levels(*system_);
  // Methods that sort rows by their numbers are made anew.
  if (same && !climbs(options_.method) && options_.method != Method::position_based) {
    // All who work with the system look at this one.
    std::swap(*system_, *system);
    try {
      chosen_->take_new_numbers();
      list_stand_ins();
    } catch (...) {
      std::swap(*system_, *system);
      drop();
      throw;
    }
    return Renewed::numbers;
  }
  const StageSeconds spent = chosen_->seconds();
  if (auto r = make_for(std::move(system), prefer_iterative, same_solver); !r) return r.failure();
  chosen_->add_seconds(spent);
  return same ? Renewed::numbers : Renewed::structure;
}

Result<std::shared_ptr<System>> Methods::compile_system(SystemParts parts, const System* like) const {
  const bool ascent = climbs(options_.method);
  parts.treatment = treatment_of(options_.method);
  parts.ranks = ranks_;
  // Condensed rows make the stiffness as stiff as they are, which is no matter to a factorization but slows
  // an iteration.
  if (options_.method == Method::automatic && (large(parts) || options_.solver == Solver::iterative))
    parts.treatment = RowTreatment::saddle;
  parts.border_wide_rows = !ascent;
  auto compiled = System::compile(std::move(parts), like);
  if (!compiled) return compiled.failure();
  const System& system = *compiled.value();
  if (ascent && static_cast<Index>(system.dual_rows().size()) != system.rows()) {
    return Error{
        "world: method " + std::string(to_string(options_.method)) +
        " takes all rows as dual, but an effect asks for another treatment of its rows; leave it automatic"};
  }
  if (const std::string what = PositionBased::unsupported(system);
      options_.method == Method::position_based && !what.empty()) {
    return Error{"world: method position_based has no answer for this scene: " + what +
                 "; use another method"};
  }
  if (options_.solver == Solver::cholmod_supernodal && !system.kept_rows().empty()) {
    return Error{"world: solver cholmod_supernodal factors positive definite matrices, and " +
                 std::to_string(system.kept_rows().size()) +
                 " rows are in the matrix; use method condensation with element rows and nu < 0.5, method "
                 "dual_gradients or augmented_gradients, or another solver"};
  }
  return compiled;
}

// What replaces a system of the same unknowns works in its memory: fresh pages cost more than all else here.
std::unique_ptr<LinearSolver> Methods::release_solver(std::unique_ptr<LinearSolver>& unsymmetric) {
  auto solver = chosen_->release_solver();
  unsymmetric = chosen_->release_unsymmetric();
  path_follower_ = nullptr;
  chosen_.reset();
  return solver;
}

// Augmented where the stiffness is not definite, and rows in the matrix where that is not enough.
void Methods::list_stand_ins() {
  made_.clear();
  stand_ins_.clear();
  if (treatment_of(options_.method) == RowTreatment::dual || options_.method == Method::augmented_ascent)
    stand_ins_.push_back(Method::augmented_gradients);
  if (!stand_ins_.empty() || options_.method == Method::augmented_gradients)
    stand_ins_.push_back(Method::saddle_point);
  made_.resize(stand_ins_.size());
}

Result<void> Methods::make(SystemParts parts, bool keep_solvers, const System* like) {
  const bool prefer_iterative = large(parts);
  auto compiled = compile_system(std::move(parts), like);
  if (!compiled) return compiled.failure();
  return make_for(std::move(compiled).value(), prefer_iterative, keep_solvers);
}

// Two levels in place of factors know no bounds and no lag, whose corrections want what factors do in a few
// directions; no rows around the matrix, each of which is solved to the end; and no paths.
bool Methods::may_have_two_levels(const System& system) const {
  const TreatedRows& rows = system.treated();
  return options_.solver == Solver::automatic && !ranks_ && !options_.scheme->follows_paths() &&
         !system.couples() && !system.has_lag() && !system.has_bounds() && !system.renews_stencils() &&
         rows.bordered.empty() && rows.dual.empty();
}

std::unique_ptr<LinearSolver> Methods::make_solver(const System& system, bool prefer_iterative) const {
  if (ranks_) return ranks_->linear_solver(options_.solver, prefer_iterative);
  SolverWishes wishes;
  wishes.prefer_iterative = prefer_iterative;
  // Next to a limit point the sign of a vanishing eigenvalue counts.
  wishes.single_precision = !options_.scheme->follows_paths();
  auto solver = make_linear_solver(options_.solver, wishes);
  if (!solver || !may_have_two_levels(system)) return solver;
  TwoLevelChoice choice;
  choice.confirm = !options_.scheme->has_inertia();
  return make_two_level_solver(std::move(solver), choice);
}

// Those of ranks tell by their values which matrix it is.
std::unique_ptr<LinearSolver> Methods::make_unsymmetric() const {
  return ranks_ ? ranks_->linear_solver(Solver::mumps, false) : make_unsymmetric_solver(options_.solver);
}

Result<void> Methods::make_for(std::shared_ptr<System> system, bool prefer_iterative, bool keep_solvers) {
  std::unique_ptr<LinearSolver> solver, unsymmetric;
  if (!keep_solvers) solver = make_solver(*system, prefer_iterative && !system->couples());
  if (!keep_solvers && !solver)
    return Error{"world: this build does not have the linear solver that is asked for"};
  std::string counts = count_rows(*system);
  if (keep_solvers) solver = release_solver(unsymmetric);
  system_.swap(system);
  try {
    if (system_->couples() && !unsymmetric) unsymmetric = make_unsymmetric();
    list_stand_ins();
    make_chosen(std::move(solver), std::move(unsymmetric));
  } catch (...) {
    system_.swap(system);
    drop();
    throw;
  }
  counts_ = std::move(counts);
  return {};
}

void Methods::drop() {
  path_follower_ = nullptr;
  chosen_.reset();
  made_.clear();
  stand_ins_.clear();
}

void Methods::remake() {
  const bool prefer_iterative = large(system_->parts()) && !system_->couples();
  auto solver = make_solver(*system_, prefer_iterative);
  std::unique_ptr<LinearSolver> unsymmetric;
  if (system_->couples()) unsymmetric = make_unsymmetric();
  list_stand_ins();
  make_chosen(std::move(solver), std::move(unsymmetric));
}

void Methods::make_chosen(std::unique_ptr<LinearSolver> solver, std::unique_ptr<LinearSolver> unsymmetric) {
  if (climbs(options_.method)) {
    DualAscentOptions ascent;
    ascent.augmented = ascent.scaled = options_.method == Method::augmented_ascent;
    chosen_ = std::make_unique<DualAscent>(system_, parallel_, std::move(solver), ascent);
  } else if (options_.method == Method::position_based) {
    chosen_ = std::make_unique<PositionBased>(system_, parallel_, std::move(solver), options_.sweeps);
  } else if (options_.scheme->follows_paths()) {
    auto follower = std::make_unique<PathFollower>(system_, parallel_, std::move(solver));
    path_follower_ = follower.get();
    chosen_ = std::move(follower);
  } else if (system_->couples()) {
    chosen_ =
        std::make_unique<UnsymmetricNewton>(system_, parallel_, std::move(solver), std::move(unsymmetric));
  } else {
    chosen_ = std::make_unique<Newton>(system_, parallel_, std::move(solver));
  }
  chosen_->set_interrupt(interrupt_);
}

// Rows and multipliers are those of this world, only their treatment differs.
std::unique_ptr<SaddlePoint> Methods::make_stand_in(Method method) const {
  SystemParts parts = system_->parts();
  parts.treatment = treatment_of(method);
  parts.border_wide_rows = true;
  auto compiled = System::compile(std::move(parts));
  if (!compiled) return nullptr;
  if (options_.solver == Solver::cholmod_supernodal && !compiled.value()->kept_rows().empty()) return nullptr;
  auto solver = make_linear_solver(options_.solver, SolverWishes{});
  if (!solver) return nullptr;
  auto other = std::make_unique<Newton>(std::move(compiled).value(), parallel_, std::move(solver));
  other->set_interrupt(interrupt_);
  return other;
}

bool Methods::may_stand_in(Method method) const {
  return std::find(stand_ins_.begin(), stand_ins_.end(), method) != stand_ins_.end();
}

SaddlePoint* Methods::stand_in(Method method) {
  for (std::size_t i = 0; i < stand_ins_.size(); ++i) {
    if (stand_ins_[i] != method) continue;
    if (!made_[i]) made_[i] = make_stand_in(method);
    return made_[i].get();
  }
  return nullptr;
}

void Methods::set_interrupt(std::function<bool()> asked) {
  interrupt_ = std::move(asked);
  if (chosen_) chosen_->set_interrupt(interrupt_);
  for (const auto& other : made_) {
    if (other) other->set_interrupt(interrupt_);
  }
}

std::string Methods::description() const {
  const LinearSolver& solver = chosen_->linear_solver();
  const std::string why = solver.reason();
  return std::string(to_string(options_.method)) + ": " + counts_ + "; " + std::string(solver.name()) +
         (why.empty() ? "" : ", " + why);
}

}  // namespace isochor
