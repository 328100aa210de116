#include "engine/step/ladder.h"

#include "engine/step/stepper.h"

namespace isochor {

namespace {

// What another start or another method would meet just the same.
bool final_word(const SaddleReport& r) {
  return r.status == SaddleStatus::converged || r.status == SaddleStatus::cancelled ||
         r.status == SaddleStatus::out_of_memory;
}

bool not_given_up(Stepper&, const Climb& c) {
  return !c.own_given_up;
}

// Nodes that were put where they meet an obstacle may have turned over their cells.
bool guess_failed(Stepper&, const Climb& c) {
  return c.stuck && !c.own_given_up &&
         (c.from_guess || (c.stopped && c.report.status == SaddleStatus::not_finite));
}

template <Method method>
bool stands_in(Stepper& s, const Climb& c) {
  return c.stuck && !final_word(c.report) && s.methods().may_stand_in(method) && !s.gives_up_on(method) &&
         s.methods().stand_in(method) != nullptr;
}

SaddleReport solve_here(Stepper& s, Climb& c, const SaddleOptions& options) {
  return s.solve(c.problem, options);
}

SaddleReport solve_from_state(Stepper& s, Climb& c, const SaddleOptions& options) {
  s.begin_at_state();
  return s.solve(c.problem, options);
}

template <Method method>
SaddleReport solve_by(Stepper& s, Climb& c, const SaddleOptions& options) {
  s.begin_at_state();
  return s.solve_by(*s.methods().stand_in(method), c.problem, options);
}

constexpr Rung rungs[] = {
    {"the method of the world, from inertia's prediction (statics: from the state)",
     "it did not fail in the last two increments of the step, or nothing stands in for it", "",
     Method::automatic, not_given_up, solve_here},
    {"the same from the state", "the prediction led nowhere", "", Method::automatic, guess_failed,
     solve_from_state},
    {"augmented_gradients from the state",
     "a dual method or an ascent is stuck, and it did not fail as often itself", "dual.stand_ins",
     Method::augmented_gradients, stands_in<Method::augmented_gradients>,
     solve_by<Method::augmented_gradients>},
    {"saddle_point from the state", "a dual or augmented method is stuck", "dual.stand_ins",
     Method::saddle_point, stands_in<Method::saddle_point>, solve_by<Method::saddle_point>},
};

constexpr Remedy all_remedies[] = {
    {"half the increment, to the smallest fraction", "any failure but lasting singularity",
     "rejected_substeps"},
    {"a damped motion to the equilibrium", "statics, the increment cannot be halved", "rescues"},
};

}  // namespace

std::span<const Rung> ladder() {
  return rungs;
}

std::span<const Remedy> remedies() {
  return all_remedies;
}

}  // namespace isochor
