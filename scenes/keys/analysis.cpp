// How a scene is advanced.
#include "scenes/keys/parts.h"

namespace isochor::keys {

ISOCHOR_WORDS(AnalysisType, {static_cast<int>(AnalysisType::statics), "static"},
              {static_cast<int>(AnalysisType::dynamics), "dynamic"});
ISOCHOR_WORDS(SchemeWord, ISOCHOR_WORD(SchemeWord, implicit_euler), ISOCHOR_WORD(SchemeWord, bdf2),
              ISOCHOR_WORD(SchemeWord, generalized_alpha), ISOCHOR_WORD(SchemeWord, newmark),
              ISOCHOR_WORD(SchemeWord, implicit_midpoint));
ISOCHOR_WORDS(Method, ISOCHOR_WORD(Method, automatic), ISOCHOR_WORD(Method, saddle_point),
              ISOCHOR_WORD(Method, condensation), ISOCHOR_WORD(Method, dual_gradients),
              ISOCHOR_WORD(Method, augmented_gradients), ISOCHOR_WORD(Method, dual_ascent),
              ISOCHOR_WORD(Method, augmented_ascent), ISOCHOR_WORD(Method, position_based));
ISOCHOR_WORDS(Definiteness, ISOCHOR_WORD(Definiteness, exact), ISOCHOR_WORD(Definiteness, projected),
              ISOCHOR_WORD(Definiteness, absolute));
ISOCHOR_WORDS(Solver, ISOCHOR_WORD(Solver, automatic), ISOCHOR_WORD(Solver, mumps),
              ISOCHOR_WORD(Solver, cholmod), ISOCHOR_WORD(Solver, eigen), ISOCHOR_WORD(Solver, iterative),
              ISOCHOR_WORD(Solver, multifrontal), ISOCHOR_WORD(Solver, cholmod_supernodal));

void describe_scheme(Visitor& io, AnalysisDef& a, AnalysisType standard) {
  const AnalysisDef d;
  io.word({"type", "", "what is solved for"}, a.type, standard);
  io.word({"scheme", "", "dynamics: one of the [time schemes](time-schemes.md)"}, a.scheme, d.scheme);
  io.number(Key("spectral_radius", "", "of `generalized_alpha`: what a step leaves of the fastest motion")
                .least(0)
                .most(1),
            a.spectral_radius, d.spectral_radius);
  io.optional_number(
      Key("static_until", "s",
          "dynamics: [equilibria before this time](time-schemes.md#statics-then-dynamics), the "
          "scheme from there")
          .above(0)
          .absent("dynamics from the start"),
      a.static_until);
}

void describe_solving(Visitor& io, WorldOptions& options) {
  const WorldOptions o;
  io.word({"method", "", "[how saddle points are solved](solver.md#methods)"}, options.method, o.method);
  io.integer(Key("sweeps", "", "of method `position_based`, a step").least(1), options.sweeps, o.sweeps);
  io.word({"solver", "", "[who solves the linear systems](solver.md#linear-solvers)"}, options.solver,
          o.solver);
  io.integer(Key("max_iterations", "",
                 "Newton iterations an increment; [more](solver.md#persistence) for bodies in motion")
                 .least(1),
             options.max_iterations, o.max_iterations);
  io.word({"definiteness", "", "[Hessians of elements](materials/definiteness.md#policies)"},
          options.definiteness, o.definiteness);
  io.number(Key("force_tolerance", "", "unbalanced force, relative to the forces that cancel").above(0),
            options.force_tolerance, o.force_tolerance);
  io.number(Key("row_tolerance", "", "what rows may leave over, relative to their measure").above(0),
            options.row_tolerance, o.row_tolerance);
  io.number(Key("smallest_fraction", "", "of a step, down to which increments that fail are halved")
                .above(0)
                .most(1),
            options.smallest_fraction, o.smallest_fraction);
  io.flag(
      {"transient_rescue", "", "statics: a [damped motion](solver.md#the-ladder) before a load is given up"},
      options.transient_rescue, o.transient_rescue);
  io.number(Key("time_error", "",
                "dynamics: [largest local error](time-schemes.md#control-of-the-time-error) of positions an "
                "increment may have, relative to the scene's length; 0: no control")
                .least(0),
            options.time_error, o.time_error);
  io.flag({"consistent_mass", "", "dynamics: the consistent mass matrix, not the lumped one"},
          options.consistent_mass, o.consistent_mass);
}

void describe(Visitor& io, AnalysisDef& a) {
  const AnalysisDef d;
  io.about("analysis", "Statics or dynamics, the steps, and the options of the world.");
  describe_scheme(io, a, d.type);
  io.number(Key("duration", "s", "statics: final load factor").above(0), a.duration, d.duration);
  io.not_both("steps", "step");
  io.integer(Key("steps", "", "results are reported this often").least(1).most(1'000'000), a.steps,
             a.step ? a.steps : d.steps);
  io.optional_number(Key("step", "s",
                         "instead of `steps`; refused where it does not divide the duration (to 1e-5 of it), "
                         "with the numbers of steps that do")
                         .above(0)
                         .absent("by `steps`"),
                     a.step);
  io.optional_number(
      Key("path_step", "m",
          "statics: [follow the path](solver.md#paths) of equilibria through limit "
          "points in steps of this length, at most `steps` of them, until the load factor is `duration`")
          .above(0)
          .absent("none"),
      a.path_step);
  describe_solving(io, a.options);
}

}  // namespace isochor::keys
