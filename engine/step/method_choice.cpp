// Which schemes, methods and pools go together.
#include <algorithm>

#include "engine/step/methods.h"
#include "engine/step/time_scheme.h"

namespace isochor {

std::string_view to_string(Method method) {
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

namespace {

// What a scheme that meets rows inside of its steps cannot have: the extrapolation to their end goes through
// what bounds hold off (at impacts energies grew by 42 % in 15 steps), and away from the law of a gas.
std::string not_met_in_the_middle(const SystemParts& parts, const TimeScheme& scheme) {
  if (scheme.evaluated_at() == 1) return {};
  std::string_view what;
  for (const auto& pool : parts.row_pools) {
    if (pool->rows() > 0 && (pool->facets().law || !pool->lower.empty() || !pool->upper.empty()))
      what = pool->name();
  }
  for (const auto& pool : parts.stencil_pools) {
    const StencilFacets f = pool->facets();
    if (pool->stencils() > 0 && (f.barrier || f.renewed)) what = pool->name();
  }
  if (what.empty()) return {};
  return "world: \"" + std::string(what) + "\" must be met at the end of a step, and " +
         std::string(scheme.name()) +
         " meets it in the middle and extrapolates through it; use implicit_euler, bdf2 or generalized_alpha";
}

// Why a coupled pool cannot be solved as asked; empty when it can.
std::string no_coupling(const SystemParts& parts, const WorldOptions& options) {
  const auto pool = std::find_if(parts.stencil_pools.begin(), parts.stencil_pools.end(), [](const auto& p) {
    const LaggedStencils* lagged = p->facets().lagged;
    return lagged && lagged->couples();
  });
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
      return who + "which makes matrices unsymmetric, and method " + std::string(to_string(options.method)) +
             " rests on symmetric positive definite ones; use saddle_point, or lagged";
  }
}

// Pools that ask for what the scheme or the method cannot give.
std::string not_this_scheme(const SystemParts& parts, const WorldOptions& options) {
  const bool follows = options.scheme->follows_paths();
  for (const auto& pool : parts.stencil_pools) {
    if (!follows || !pool->facets().renewed) continue;
    return "world: \"" + std::string(pool->name()) +
           "\" changes with what is close, which continuation() does not follow; use statics()";
  }
  for (const auto& pool : parts.row_pools) {
    if (!pool->facets().impact) continue;
    const std::string who = "world: \"" + std::string(pool->name()) + "\" makes velocities jump, ";
    if (!options.scheme->has_inertia())
      return who + "and " + std::string(options.scheme->name()) + " has none; use a scheme of dynamics";
    if (options.scheme->evaluated_at() != 1)
      return who + "which " + std::string(options.scheme->name()) +
             " spreads over the middles of two steps; use another scheme";
  }
  return {};
}

std::string not_by_sweeps(const WorldOptions& options) {
  if (options.method != Method::position_based) return {};
  if (!options.scheme->has_inertia()) {
    return "world: method position_based moves bodies by their inertia, statics has none; use a scheme "
           "of dynamics or another method";
  }
  if (options.consistent_mass) {
    return "world: method position_based takes each node by itself, a consistent mass matrix couples "
           "them; leave consistent_mass off or use another method";
  }
  return {};
}

}  // namespace

std::string not_across_ranks(const WorldOptions& options) {
  const std::string end = ", which is not shared out over ranks yet; ";
  switch (options.method) {
    case Method::automatic:
    case Method::saddle_point:
    case Method::condensation:
      return {};
    default:
      return "world: method " + std::string(to_string(options.method)) + " iterates on multipliers" + end +
             "use saddle_point, or run on one process";
  }
}

std::string incompatible(const SystemParts& parts, const WorldOptions& options) {
  const bool ascent = options.method == Method::dual_ascent || options.method == Method::augmented_ascent;
  if (ascent && options.scheme->follows_paths()) {
    return "world: method " + std::string(to_string(options.method)) +
           " finds stable equilibria only, paths of equilibria lead through unstable ones; use another "
           "method with continuation()";
  }
  if (std::string why = not_this_scheme(parts, options); !why.empty()) return why;
  if (std::string why = not_met_in_the_middle(parts, *options.scheme); !why.empty()) return why;
  if (std::string why = no_coupling(parts, options); !why.empty()) return why;
  return not_by_sweeps(options);
}

}  // namespace isochor
