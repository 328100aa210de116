#include "scenes/effects/kind.h"
#include "scenes/effects/shared_keys.h"

namespace isochor {

namespace keys {

void describe(Visitor& io, LinearConstraintDef::Term& t) {
  const LinearConstraintDef::Term d;
  io.about("term", "Of a linear constraint: weight times the displacement of a point along a direction.");
  io.body(body_key, t.body);
  io.required_vector({"point", "m", "in or on the body at rest"}, t.point);
  io.vector({"direction", "", "along which it counts; its length does not"}, t.direction, d.direction);
  io.number({"weight", "", "factor"}, t.weight, d.weight);
}

void describe(Visitor& io, LinearConstraintDef& c) {
  const LinearConstraintDef d;
  io.about("linear_constraint",
           "An equation between displacements of points, see [linear constraints]"
           "(effects/dirichlet.md#linear-constraints).");
  io.required_text(name_key, c.name);
  io.list(Key("terms", "", "whose sum is given").must(), c.terms);
  io.number(Key("stiffness", "N/m", "of a spring on the sum; 0: hard").least(0), c.stiffness, d.stiffness);
  io.number({"value", "m", "what the sum is at amount 1"}, c.value, d.value);
  io.curve({"amount", "", "scales it over time"}, c.amount, CurveStart::zero, c.value != 0);
}

}  // namespace keys

constinit const EffectKind linear_constraints_kind =
    effect_kind<&SceneDef::linear_constraints, linear_constraint>("linear_constraints", "linear constraint",
                                                                  EffectPhase::ties);

}  // namespace isochor
