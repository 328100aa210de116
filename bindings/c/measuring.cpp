// What can be read from a world between steps.
#include "handles.h"

namespace isochor::c {

void GaugeList::show(std::vector<Gauge> gauges) {
  kept = std::move(gauges);
  shown.clear();
  for (const Gauge& g : kept)
    shown.push_back({g.effect.c_str(), g.kind.c_str(), g.quantity.c_str(), g.unit.c_str(), g.value});
}

namespace {

// A question to a compiled world.
iso_status ask(iso_world* world, const char* call, const auto& question) {
  return enter(world, call, [&] {
    need(world->world->compile());
    question(*world->world);
  });
}

void put_volume(const VolumeMeasures& from, iso_measures& out) {
  out = {};
  out.size = sizeof out;
  out.volume = from.volume;
  out.rest_volume = from.rest_volume;
  out.min_J = from.min_J;
  out.max_J = from.max_J;
}

void put_body(const BodyMeasures& from, iso_measures& out) {
  put_volume(from, out);
  out.volume_row_residual = from.volume_row_residual;
  out.mass = from.mass;
  put(from.center_of_mass, out.center_of_mass);
  put(from.linear_momentum, out.linear_momentum);
  put(from.angular_momentum, out.angular_momentum);
}

void show(KeptResponse& kept, iso_response& out) {
  for (const auto& one : kept.response.positions)
    kept.positions.push_back({one.empty() ? nullptr : &one.front().x, one.size()});
  kept.gauges.show(std::move(kept.response.gauges));
  for (const auto& [force, moment] : kept.response.reactions) {
    iso_wrench& wrench = kept.reactions.emplace_back();
    put(force, wrench.force);
    put(moment, wrench.moment);
  }
  out = {kept.positions.data(),         kept.positions.size(),      kept.gauges.shown.data(),
         kept.gauges.shown.size(),      kept.reactions.data(),      kept.reactions.size(),
         kept.response.regular ? 1 : 0, kept.response.note.c_str(), kept.response.unstable_directions};
}

ResponseInput input_from(const World& world, const iso_input& input) {
  const Vec3 force = vector(input.force, "force");
  if (force == Vec3{}) return ResponseInput::amount_of(effect_of(world, input.effect));
  return ResponseInput::force_at(body_of(world, input.body), vector(input.point, "point"), force);
}

}  // namespace

}  // namespace isochor::c

using namespace isochor;
using namespace isochor::c;

extern "C" iso_status iso_gauges(iso_world* world, const iso_gauge** out, size_t* count) {
  return ask(world, "iso_gauges", [&](World& w) {
    (void)given(out, "out");
    (void)given(count, "count");
    world->answers.gauges.show(w.gauges());
    *out = world->answers.gauges.shown.data();
    *count = world->answers.gauges.shown.size();
  });
}

extern "C" iso_status iso_gauge_value(iso_world* world, const char* effect, const char* quantity,
                                      double* out) {
  return ask(world, "iso_gauge_value", [&](World& w) {
    const std::string of = text(effect, "effect"), what = text(quantity, "quantity");
    (void)given(out, "out");
    std::string known;
    for (const Gauge& g : w.gauges()) {
      if (g.effect == of && g.quantity == what) {
        *out = g.value;
        return;
      }
      known += (known.empty() ? "\"" : ", \"") + g.effect + "\" \"" + g.quantity + "\"";
    }
    refuse("there is no gauge \"" + of + "\" \"" + what + "\"; there are " +
           (known.empty() ? "none" : known));
  });
}

extern "C" iso_status iso_reaction(iso_world* world, iso_effect effect, double force[3], double moment[3]) {
  return ask(world, "iso_reaction", [&](World& w) {
    const auto [f, m] = w.reaction(effect_of(w, effect));
    put(f, force);
    put(m, moment);
  });
}

extern "C" iso_status iso_measure(iso_world* world, iso_body body, const char* region, iso_measures* out) {
  return ask(world, "iso_measure", [&](World& w) {
    Filled<iso_measures> told(out, "out");
    const BodyMeasures measures = w.measures(body_of(w, body));
    if (region == nullptr) {
      put_body(measures, *told);
      told.give();
      return;
    }
    std::string known;
    for (const VolumeMeasures& part : measures.regions) {
      if (part.name == region) {
        put_volume(part, *told);
        told.give();
        return;
      }
      known += (known.empty() ? "\"" : ", \"") + part.name + "\"";
    }
    refuse("there is no region \"" + std::string(region) + "\"; there are " + known);
  });
}

extern "C" iso_status iso_energy(iso_world* world, iso_energies* out) {
  return ask(world, "iso_energy", [&](World& w) {
    Filled<iso_energies> told(out, "out");
    const Energies e = w.energies();
    *told = {told->size, e.kinetic, e.elastic, e.gravity, e.loads, e.pressures};
    told.give();
  });
}

extern "C" iso_status iso_momentum(iso_world* world, double linear[3], double angular[3]) {
  return ask(world, "iso_momentum", [&](World& w) {
    const auto [p, l] = w.momentum();
    put(p, linear);
    put(l, angular);
  });
}

extern "C" iso_status iso_fields(iso_world* world, iso_body body, iso_body_fields* out) {
  return ask(world, "iso_fields", [&](World& w) {
    Filled<iso_body_fields> told(out, "out");
    BodyFields& f = world->answers.fields;
    f = w.fields(body_of(w, body));
    *told = {told->size,
             f.node_pressure.size(),
             f.cell_J.size(),
             data(f.node_pressure),
             data(f.node_stress),
             data(f.cell_J),
             data(f.cell_pressure),
             data(f.cell_von_mises),
             data(f.cell_stress),
             data(f.cell_max_stretch),
             data(f.node_contact_pressure),
             data(f.node_friction)};
    told.give();
  });
}

extern "C" iso_status iso_contacts(iso_world* world, const iso_contact** out, size_t* count) {
  return ask(world, "iso_contacts", [&](World& w) {
    (void)given(out, "out");
    (void)given(count, "count");
    Answers& a = world->answers;
    a.contact_points = w.contacts();
    a.contacts.clear();
    for (const ContactPoint& p : a.contact_points) {
      iso_contact& c = a.contacts.emplace_back();
      c.effect = handle(p.effect);
      c.body = p.body.c_str();
      c.partner = p.partner.c_str();
      c.node = p.node;
      put(p.position, c.position);
      c.gap = p.gap;
      put(p.normal, c.normal);
      put(p.normal_force, c.normal_force);
      put(p.friction, c.friction);
      c.area = p.area;
    }
    *out = a.contacts.data();
    *count = a.contacts.size();
  });
}

extern "C" iso_status iso_contact_pairs(iso_world* world, const iso_contact_pair** out, size_t* count) {
  return ask(world, "iso_contact_pairs", [&](World& w) {
    (void)given(out, "out");
    (void)given(count, "count");
    Answers& a = world->answers;
    a.contact_sums = w.contact_pairs();
    a.contact_pairs.clear();
    for (const ContactPair& p : a.contact_sums)
      a.contact_pairs.push_back(
          {p.body.c_str(), p.partner.c_str(), {p.force.x, p.force.y, p.force.z}, p.normal, p.points});
    *out = a.contact_pairs.data();
    *count = a.contact_pairs.size();
  });
}

extern "C" iso_status iso_turn(iso_world* world, const char* where, iso_orientation* out) {
  return ask(world, "iso_turn", [&](World& w) {
    Filled<iso_orientation> told(out, "out");
    const Selection selection = need(selection_from_keys(text(where, "where"), world->keys.context(w)));
    const Orientation o = need(w.orientation(selection));
    told->angle = o.angle;
    put(o.axis, told->axis);
    put(o.displacement, told->displacement);
    put(o.normal, told->normal);
    told->misfit = o.misfit;
    told.give();
  });
}

extern "C" iso_status iso_derivatives(iso_world* world, const iso_input* inputs, size_t count,
                                      const iso_response** out) {
  return ask(world, "iso_derivatives", [&](World& w) {
    (void)given(out, "out");
    if (count > 0) check_size(inputs, "inputs");
    std::vector<ResponseInput> asked;
    for (std::size_t i = 0; i < count; ++i) asked.push_back(input_from(w, taken(nth(inputs, i), "inputs")));
    std::vector<Response> made = need(w.derivatives(asked));
    Answers& a = world->answers;
    a.kept_responses.clear();
    a.kept_responses.resize(made.size());
    a.responses.assign(made.size(), {});
    for (std::size_t i = 0; i < made.size(); ++i) {
      a.kept_responses[i].response = std::move(made[i]);
      show(a.kept_responses[i], a.responses[i]);
    }
    *out = a.responses.data();
  });
}

extern "C" iso_status iso_size(iso_world* world, iso_world_size* out) {
  return ask(world, "iso_size", [&](World& w) {
    Filled<iso_world_size> told(out, "out");
    const WorldSize s = w.size();
    *told = {told->size,        s.nodes,           s.displacement_unknowns, s.multipliers, s.matrix_size,
             s.matrix_nonzeros, s.factor_nonzeros, s.engine_bytes,          s.table_bytes};
    told.give();
  });
}

extern "C" iso_status iso_constitutive_residual(iso_world* world, double* out) {
  return ask(world, "iso_constitutive_residual",
             [&](World& w) { given(out, "out") = w.constitutive_residual(); });
}

extern "C" iso_status iso_method(iso_world* world, const char** out) {
  return ask(world, "iso_method", [&](World& w) {
    (void)given(out, "out");
    world->answers.method = w.method();
    *out = world->answers.method.c_str();
  });
}

extern "C" iso_status iso_warnings(iso_world* world, const char* const** out, size_t* count) {
  return ask(world, "iso_warnings", [&](World& w) {
    (void)given(out, "out");
    (void)given(count, "count");
    Answers& a = world->answers;
    a.kept_warnings = w.warnings();
    a.warnings.clear();
    for (const std::string& warning : a.kept_warnings) a.warnings.push_back(warning.c_str());
    *out = a.warnings.data();
    *count = a.warnings.size();
  });
}
