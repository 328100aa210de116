#include <cmath>

#include "studies/chaos/draft.h"

namespace isochor::studies {

namespace {

Method draw_method(ChaosRandom& random, bool dynamic) {
  if (random.chance(0.4)) return Method::automatic;
  const Method method =
      random.pick({Method::saddle_point, Method::saddle_point, Method::condensation, Method::dual_gradients,
                   Method::augmented_gradients, Method::dual_ascent, Method::augmented_ascent,
                   Method::augmented_ascent, Method::position_based, Method::position_based});
  // Refused in statics; a few such scenes are enough.
  if (method == Method::position_based && !dynamic && random.chance(0.9)) return Method::saddle_point;
  return method;
}

Solver draw_solver(ChaosRandom& random) {
  if (random.chance(0.6)) return Solver::automatic;
  return random.pick({Solver::multifrontal, Solver::multifrontal, Solver::mumps, Solver::cholmod,
                      Solver::eigen, Solver::eigen, Solver::iterative, Solver::iterative});
}

void draw_limits(ChaosRandom& random, AnalysisDef& a) {
  if (random.chance(0.15)) a.options.max_iterations = random.pick({1, 3, 8, 20, 200});
  if (random.chance(0.15)) a.options.force_tolerance = random.pick({1e-4, 1e-6, 1e-11});
  if (random.chance(0.1)) a.options.row_tolerance = random.pick({1e-4, 1e-6, 1e-8, 1e-12});
  if (random.chance(0.2)) a.options.smallest_fraction = random.pick({1.0, 0.25, 1.0 / 256});
  if (random.chance(0.2)) a.options.transient_rescue = false;
}

}  // namespace

Curve ChaosDraft::curve(ChaosRandom& random, double value, double start) const {
  switch (random.whole(0, 5)) {
    case 0:  // at once
      return Curve::constant(value);
    case 1:  // up and down again
      return {{{0, start}, {0.5 * duration, value}, {duration, start}}};
    case 2:  // a jump in the middle
      return {{{0, start}, {0.5 * duration, start}, {0.51 * duration, value}}};
    default:
      return {{{0, start}, {duration, value}}};
  }
}

double ChaosDraft::load_factor(ChaosRandom& random) {
  if (random.chance(0.7)) return random.decades(-3, 0);
  return random.chance(0.5) ? random.decades(-9, -3) : random.decades(0, 5);
}

void draft_analysis(ChaosDraft& draft) {
  ChaosRandom random = draft.random("analysis");
  AnalysisDef& a = draft.scene().analysis;
  draft.length = random.chance(0.8) ? random.decades(-2, 0) : random.decades(-4, 3);
  draft.young = random.chance(0.8) ? random.decades(4, 6) : random.decades(0, 11);
  draft.density = random.chance(0.8) ? 1000 : random.decades(0, 5);
  draft.dynamic = random.chance(0.55);
  a.steps = random.whole(1, draft.size.most_steps);
  if (draft.dynamic) {
    a.type = AnalysisType::dynamics;
    a.scheme = random.pick({SchemeWord::implicit_euler, SchemeWord::implicit_euler,
                            SchemeWord::implicit_euler, SchemeWord::bdf2, SchemeWord::generalized_alpha,
                            SchemeWord::newmark, SchemeWord::implicit_midpoint});
    if (a.scheme == SchemeWord::generalized_alpha) a.spectral_radius = random.pick({0.0, 0.5, 0.8, 1.0});
    // The time that a wave takes through the body, by a factor from a hundredth to thousands.
    const double wave = draft.length * std::sqrt(draft.density / draft.young);
    const double h = wave * (random.chance(0.8) ? random.decades(-1, 2) : random.decades(-3, 5));
    a.duration = a.steps * h;
    if (random.chance(0.1)) a.options.time_error = random.decades(-6, -2);
    if (random.chance(0.15)) a.options.consistent_mass = true;
  } else {
    a.duration = random.chance(0.85) ? 1 : random.between(0.1, 3);
    if (random.chance(0.08)) a.path_step = draft.length * random.decades(-3, 0);
  }
  draft.duration = a.duration;
  a.options.method = draw_method(random, draft.dynamic);
  if (a.options.method == Method::position_based) a.options.sweeps = random.whole(1, 40);
  a.options.solver = draw_solver(random);
  if (a.options.method == Method::position_based && random.chance(0.95)) a.options.consistent_mass = false;
  if (a.path_step &&
      (a.options.method == Method::augmented_ascent || a.options.method == Method::dual_ascent))
    a.options.method = Method::saddle_point;
  if (random.chance(0.3))
    a.options.definiteness = random.pick({Definiteness::projected, Definiteness::absolute});
  draw_limits(random, a);
  draft.scene().outputs.every = 0;
  draft.scene().outputs.page = false;
}

void draft_drive(ChaosDraft& draft) {
  ChaosRandom random = draft.random("drive");
  ChaosDrive& drive = draft.out.drive;
  drive.single_increments = random.chance(0.2);
  switch (random.whole(0, 9)) {
    case 0:
      drive.budget_iterations = random.whole(1, 4);
      break;
    case 1:
      drive.budget_seconds = random.decades(-4, -1);
      break;
    case 2:
    case 3:
      drive.wall_seconds = random.pick({0.02, 0.1, 0.3, 1.0, 2.0});
      drive.cancels = random.chance(0.3);
      break;
    default:
      break;
  }
  if (random.chance(0.2)) drive.reload_after = random.whole(0, draft.scene().analysis.steps - 1);
}

}  // namespace isochor::studies
