// Which method solves the saddle points of a world.
#include <algorithm>

#include "engine/solve/dual_ascent.h"
#include "engine/solve/newton/unsymmetric_newton.h"
#include "engine/solve/position_based.h"
#include "engine/step/path_follower.h"
#include "engine/world/world_impl.h"

namespace isochor {

namespace {

constexpr std::size_t large_scene = 60000;  // displacements

std::string_view name_of(Method method) {
  switch (method) {
    case Method::automatic:
      return "automatic";
    case Method::saddle_point:
      return "saddle_point";
    case Method::condensation:
      return "condensation";
    case Method::dual_gradients:
      return "dual_gradients";
    case Method::augmented_gradients:
      return "augmented_gradients";
    case Method::dual_ascent:
      return "dual_ascent";
    case Method::augmented_ascent:
      return "augmented_ascent";
    case Method::position_based:
      return "position_based";
  }
  return "unknown";
}

RowTreatment treatment_of(Method method) {
  switch (method) {
    case Method::automatic:
      break;
    case Method::saddle_point:
    case Method::position_based:
      return RowTreatment::saddle;
    case Method::condensation:
      return RowTreatment::condensed;
    case Method::dual_gradients:
    case Method::dual_ascent:
      return RowTreatment::dual;
    case Method::augmented_gradients:
    case Method::augmented_ascent:
      return RowTreatment::augmented;
  }
  return RowTreatment::automatic;
}

// What a scheme that meets rows inside of its steps cannot have: the extrapolation to their end goes through
// what bounds hold off (at impacts energies grew by 42 % in 15 steps), and away from the law of a gas.
std::string not_met_in_the_middle(const SystemParts& parts, const TimeScheme& scheme) {
  if (scheme.evaluated_at() == 1) return {};
  std::string_view what;
  for (const auto& pool : parts.row_pools) {
    if (pool->rows() > 0 && (pool->has_law() || !pool->lower.empty() || !pool->upper.empty()))
      what = pool->name();
  }
  for (const auto& pool : parts.stencil_pools) {
    if (pool->stencils() > 0 && (pool->has_barrier() || pool->follows())) what = pool->name();
  }
  if (what.empty()) return {};
  return "world: \"" + std::string(what) + "\" must be met at the end of a step, and " +
         std::string(scheme.name()) +
         " meets it in the middle and extrapolates through it; use implicit_euler, bdf2 or generalized_alpha";
}

// Why a coupled pool cannot be solved as asked; empty when it can.
std::string no_coupling(const SystemParts& parts, const WorldOptions& options) {
  const auto pool = std::find_if(parts.stencil_pools.begin(), parts.stencil_pools.end(),
                                 [](const auto& p) { return p->has_lag() && p->couples(); });
  if (pool == parts.stencil_pools.end()) return {};
  const std::string who = "world: \"" + std::string((*pool)->name()) + "\" is coupled, ";
  if (options.scheme->follows_paths())
    return who + "and continuation() tells stability by the inertia of a symmetric matrix; use lagged";
  if (options.solver == Solver::iterative)
    return who +
           "which makes matrices unsymmetric, and solver iterative wants symmetric ones; use another "
           "solver, or lagged";
  switch (options.method) {
    case Method::automatic:
    case Method::saddle_point:
    case Method::condensation:
      return {};
    case Method::position_based:
      return who + "and method position_based has no linear system to couple; use another method, or lagged";
    default:
      return who + "which makes matrices unsymmetric, and method " + std::string(name_of(options.method)) +
             " rests on symmetric positive definite ones; use saddle_point, or lagged";
  }
}

}  // namespace

Result<void> World::Impl::make_method(SystemParts parts, bool keep_solvers) {
  // Augmented where the stiffness is not definite, and rows in the matrix where that is not enough.
  stand_ins.clear();
  if (treatment_of(options.method) == RowTreatment::dual || options.method == Method::augmented_ascent)
    stand_ins.push_back({Method::augmented_gradients, nullptr});
  if (!stand_ins.empty() || options.method == Method::augmented_gradients)
    stand_ins.push_back({Method::saddle_point, nullptr});
  const bool ascent = options.method == Method::dual_ascent || options.method == Method::augmented_ascent;
  const bool follows = options.scheme->follows_paths();
  if (ascent && follows) {
    return Error{"world: method " + std::string(name_of(options.method)) +
                 " finds stable equilibria only, paths of equilibria lead through unstable ones; use another "
                 "method with continuation()"};
  }
  for (const auto& pool : parts.stencil_pools) {
    if (!pool->follows() || !follows) continue;
    return Error{"world: \"" + std::string(pool->name()) +
                 "\" changes with what is close, which continuation() does not follow; use statics()"};
  }
  for (const auto& pool : parts.row_pools) {
    if (!pool->looks_back()) continue;
    const std::string who = "world: \"" + std::string(pool->name()) + "\" makes velocities jump, ";
    if (!options.scheme->has_inertia())
      return Error{who + "and " + std::string(options.scheme->name()) +
                   " has none; use a scheme of dynamics"};
    if (options.scheme->evaluated_at() != 1)
      return Error{who + "which " + std::string(options.scheme->name()) +
                   " spreads over the middles of two steps; use another scheme"};
  }
  if (const std::string why = not_met_in_the_middle(parts, *options.scheme); !why.empty()) return Error{why};
  if (const std::string why = no_coupling(parts, options); !why.empty()) return Error{why};
  const bool positions = options.method == Method::position_based;
  if (positions && !options.scheme->has_inertia()) {
    return Error{
        "world: method position_based moves bodies by their inertia, statics has none; use a scheme "
        "of dynamics or another method"};
  }
  if (positions && options.consistent_mass) {
    return Error{
        "world: method position_based takes each node by itself, a consistent mass matrix couples "
        "them; leave consistent_mass off or use another method"};
  }
  parts.treatment = treatment_of(options.method);
  // Iterations win where matrices are large. They cannot tell an inertia, though, so that equilibria are left
  // to factors as long as these fit; inertia of mass keeps a step of dynamics away from that.
  const bool plain = options.method == Method::automatic || options.method == Method::saddle_point;
  const bool large = 3 * parts.rest.size() >= large_scene && plain && options.solver == Solver::automatic &&
                     options.scheme->has_inertia() && !follows;
  // Condensed rows make the stiffness as stiff as they are, which is no matter to a factorization but slows
  // an iteration.
  if (options.method == Method::automatic && (large || options.solver == Solver::iterative))
    parts.treatment = RowTreatment::saddle;
  parts.border_wide_rows = !ascent;
  auto compiled_system = System::compile(std::move(parts));
  if (!compiled_system) return Error{compiled_system.error()};
  system = std::move(compiled_system).value();
  if (ascent && static_cast<Index>(system->dual_rows().size()) != system->rows()) {
    return Error{
        "world: method " + std::string(name_of(options.method)) +
        " takes all rows as dual, but an effect asks for another treatment of its rows; leave it automatic"};
  }
  if (const std::string what = PositionBased::unsupported(*system); positions && !what.empty()) {
    return Error{"world: method position_based has no answer for this scene: " + what +
                 "; use another method"};
  }
  const auto kind = static_cast<SolverKind>(options.solver);
  if (kind == SolverKind::cholmod_supernodal && !system->kept_rows().empty()) {
    return Error{"world: solver cholmod_supernodal factors positive definite matrices, and " +
                 std::to_string(system->kept_rows().size()) +
                 " rows are in the matrix; use method condensation with element rows and nu < 0.5, method "
                 "dual_gradients or augmented_gradients, or another solver"};
  }
  // Next to a limit point the sign of a vanishing eigenvalue counts.
  SolverWishes wishes;
  wishes.prefer_iterative = large && !system->couples();
  wishes.single_precision = !follows;
  std::unique_ptr<LinearSolver> solver, unsymmetric;
  if (keep_solvers) {
    // What replaces a system of the same unknowns works in its memory: fresh pages cost more than all else
    // here. Should that run out, there is no way back.
    compile_error = "world: memory ran out when stencils were replaced; make the world anew";
    solver = newton->release_solver();
    unsymmetric = newton->release_unsymmetric();
    newton.reset();
  } else {
    solver = make_linear_solver(kind, wishes);
  }
  if (system->couples() && !unsymmetric) unsymmetric = make_unsymmetric_solver(kind);
  if (!solver) return Error{"world: this build does not have the linear solver that is asked for"};
  if (ascent) {
    DualAscentOptions ascent_options;
    ascent_options.augmented = ascent_options.scaled = options.method == Method::augmented_ascent;
    newton = std::make_unique<DualAscent>(system, *parallel, std::move(solver), ascent_options);
  } else if (positions) {
    newton = std::make_unique<PositionBased>(system, *parallel, std::move(solver), options.sweeps);
  } else if (follows) {
    newton = std::make_unique<PathFollower>(system, *parallel, std::move(solver));
  } else if (system->couples()) {
    newton =
        std::make_unique<UnsymmetricNewton>(system, *parallel, std::move(solver), std::move(unsymmetric));
  } else {
    newton = std::make_unique<Newton>(system, *parallel, std::move(solver));
  }
  compile_error.clear();
  newton->set_interrupt([this] { return interrupted(); });
  const auto count = [](std::span<const Index> rows) { return std::to_string(rows.size()); };
  method = std::string(name_of(options.method)) + ": " + std::to_string(system->free_unknowns()) +
           " displacements; rows: " + count(system->kept_rows()) + " in the matrix, " +
           count(system->condensed_rows()) + " condensed, " + count(system->bordered_rows()) + " bordered, " +
           count(system->dual_rows()) + " dual";
  return {};
}

// Rows and multipliers are those of this world, only their treatment differs. Null: this build or the chosen
// solver cannot.
std::unique_ptr<SaddlePoint> World::Impl::make_stand_in(Method other) const {
  SystemParts parts = system->parts();
  parts.treatment = treatment_of(other);
  parts.border_wide_rows = true;
  auto compiled_system = System::compile(std::move(parts));
  if (!compiled_system) return nullptr;
  const auto kind = static_cast<SolverKind>(options.solver);
  if (kind == SolverKind::cholmod_supernodal && !compiled_system.value()->kept_rows().empty()) return nullptr;
  auto solver = make_linear_solver(kind, SolverWishes{});
  if (!solver) return nullptr;
  auto other_method =
      std::make_unique<Newton>(std::move(compiled_system).value(), *parallel, std::move(solver));
  other_method->set_interrupt([this] { return interrupted(); });
  return other_method;
}

bool World::Impl::interrupted() const {
  return (deadline && std::chrono::steady_clock::now() > *deadline) || asked_to_stop();
}

std::string World::method() const {
  if (!impl_->compile()) return {};
  const LinearSolver& solver = impl_->newton->linear_solver();
  const std::string why = solver.reason();
  return impl_->method + "; " + std::string(solver.name()) + (why.empty() ? "" : ", " + why);
}

}  // namespace isochor
