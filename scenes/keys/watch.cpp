// What is watched, written and compared.
#include "scenes/effects/shared_keys.h"
#include "scenes/keys/parts.h"

namespace isochor::keys {

ISOCHOR_WORDS(Component, ISOCHOR_WORD(Component, magnitude), ISOCHOR_WORD(Component, x),
              ISOCHOR_WORD(Component, y), ISOCHOR_WORD(Component, z));
ISOCHOR_WORDS(Quantity, ISOCHOR_WORD(Quantity, displacement), ISOCHOR_WORD(Quantity, cavity_pressure),
              ISOCHOR_WORD(Quantity, cavity_volume), ISOCHOR_WORD(Quantity, cable_tension),
              ISOCHOR_WORD(Quantity, cable_length), ISOCHOR_WORD(Quantity, rigid_x),
              ISOCHOR_WORD(Quantity, rigid_y), ISOCHOR_WORD(Quantity, rigid_z),
              ISOCHOR_WORD(Quantity, contact_force), ISOCHOR_WORD(Quantity, contact_area),
              ISOCHOR_WORD(Quantity, contact_pressure), ISOCHOR_WORD(Quantity, contact_gap),
              ISOCHOR_WORD(Quantity, reaction_force), ISOCHOR_WORD(Quantity, reaction_moment),
              ISOCHOR_WORD(Quantity, orientation_angle), ISOCHOR_WORD(Quantity, orientation_axis),
              ISOCHOR_WORD(Quantity, orientation_normal), ISOCHOR_WORD(Quantity, volume_row_residual),
              // Its former name, which scenes may still have.
              {static_cast<int>(Quantity::volume_row_residual), "volume_error"},
              ISOCHOR_WORD(Quantity, volume_change), ISOCHOR_WORD(Quantity, volume),
              ISOCHOR_WORD(Quantity, constitutive_residual), ISOCHOR_WORD(Quantity, min_J),
              ISOCHOR_WORD(Quantity, max_J), ISOCHOR_WORD(Quantity, elastic_energy),
              ISOCHOR_WORD(Quantity, kinetic_energy), ISOCHOR_WORD(Quantity, gravity_potential),
              ISOCHOR_WORD(Quantity, load_potential), ISOCHOR_WORD(Quantity, potential_energy),
              ISOCHOR_WORD(Quantity, total_energy), ISOCHOR_WORD(Quantity, linear_momentum),
              ISOCHOR_WORD(Quantity, angular_momentum), ISOCHOR_WORD(Quantity, newton_iterations));

void describe(Visitor& io, ProbeDef& p) {
  io.about("probe", "A point of a body; results are interpolated in its cell.");
  io.required_text({"name", "", "of the probe"}, p.name);
  io.body(body_key, p.body);
  io.required_vector({"point", "m", "position at rest"}, p.point);
}

void describe(Visitor& io, OrientationDef& o) {
  io.about("orientation",
           "A face or another set of nodes: how it has turned and moved since rest, and where it looks. See "
           "[orientations](#orientations).");
  io.required_text({"name", "", "of the orientation"}, o.name);
  io.object({"where", "", "its nodes"}, o.where);
}

void describe(Visitor& io, OutputDef& o) {
  const OutputDef d;
  io.about("outputs", "What a run leaves in its folder.");
  io.integer(Key("every", "", "a frame every so many steps and at the end; 0: none").least(0), o.every,
             d.every);
  io.flag({"page", "", "the HTML results page"}, o.page, d.page);
  io.integer(Key("checkpoint_steps", "",
                 "steps between [checkpoints](#runs-that-are-stopped); 0: as `checkpoint_seconds` says")
                 .least(0),
             o.checkpoint_steps, d.checkpoint_steps);
  io.number(Key("checkpoint_seconds", "s",
                "of wall time, after which the next step ends with a checkpoint; 0: only as "
                "`checkpoint_steps` says")
                .least(0),
            o.checkpoint_seconds, d.checkpoint_seconds);
}

void describe(Visitor& io, MetricDef& m) {
  const MetricDef d;
  io.about("metric", "A number of the scene that has a name, where known with a reference.");
  io.required_text({"name", "", "of the metric"}, m.name);
  io.word({"quantity", "", "what is told; `volume_error` is the former name of `volume_row_residual`"},
          m.quantity, d.quantity);
  io.text({"of", "",
           "the probe (`displacement`: or orientation), cavity, cable, rigid body, contact, support or "
           "orientation, where the quantity has one; of `volume_change`, `volume`, `min_J`, `max_J` a body "
           "or `\"body.region\"`, of momentum a body, otherwise the whole scene"},
          m.of, d.of);
  io.word({"component", "", "of a vector"}, m.component, d.component);
  io.number({"scale", "", "multiplies the value"}, m.scale, d.scale);
  io.optional_number(Key("time", "s", "the end of a reported step").absent("the end"), m.time);
  io.optional_number({"reference", "", "after scaling"}, m.reference);
  io.optional_number(Key("tolerance", "", "relative; absolute for the reference 0").least(0), m.tolerance);
  io.text({"source", "", "where the reference is from"}, m.source, d.source);
  io.text({"unit", "", "that is shown"}, m.unit, d.unit);
}

}  // namespace isochor::keys
