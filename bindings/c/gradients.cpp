// Gradients of an equilibrium: outputs, parameters and the table of derivatives.
#include "isochor/gradients.h"

#include <memory>

#include "handles.h"
#include "scenes/parameters_by_keys.h"

namespace isochor::c {

namespace {

// One entry of an array of the query; what refusals of it begin with.
std::string place(const char* list, std::size_t k) {
  return std::string(list) + "[" + std::to_string(k) + "]";
}

// Refusals of `f` with the place that they are about.
template <class F>
auto at_place(const std::string& where, const F& f) {
  try {
    return f();
  } catch (const Refused& refused) {
    if (refused.status != ISO_REFUSED) throw;
    refuse(where + ": " + refused.message);
  }
}

std::vector<Index> nodes_of(const World& world, const iso_output& o) {
  std::vector<Index> nodes(o.count);
  if (o.nodes != nullptr) {
    std::copy_n(o.nodes, o.count, nodes.begin());
    return nodes;
  }
  const std::size_t all = world.positions(id(o.body)).size();
  if (o.count != all)
    refuse(std::to_string(o.count) + " vectors for the " + std::to_string(all) + " nodes of body \"" +
           world.body_name(id(o.body)) + "\"; give one a node, or say which nodes");
  for (std::size_t n = 0; n < all; ++n) nodes[n] = static_cast<Index>(n);
  return nodes;
}

Output::Function function_of(iso_positions_fn function, void* user) {
  return [function, user](std::span<const Vec3> x, std::span<Vec3> gradient) -> Result<double> {
    return function(user, &x.front().x, &gradient.front().x, x.size());
  };
}

Output output_from(const World& world, const iso_output& o) {
  switch (o.kind) {
    case ISO_OUTPUT_POSITIONS:
    case ISO_OUTPUT_SQUARE:
    case ISO_OUTPUT_DISTANCE: {
      const BodyId body = body_of(world, o.body);
      std::vector<Vec3> given = vectors(o.vectors, o.count, o.stride, "vectors");
      std::vector<Index> nodes = nodes_of(world, o);
      if (o.kind == ISO_OUTPUT_DISTANCE) return Output::distance(body, std::move(nodes), std::move(given));
      if (o.kind == ISO_OUTPUT_SQUARE)
        return Output::square(body, std::move(nodes), std::move(given), o.target);
      return Output::positions(body, std::move(nodes), std::move(given));
    }
    case ISO_OUTPUT_MATERIAL_POINT:
      return Output::material_point(body_of(world, o.body), vector(o.point, "point"),
                                    vector(o.direction, "direction"));
    case ISO_OUTPUT_GAUGE:
      return Output::gauge(effect_of(world, o.effect), text(o.quantity, "quantity"));
    case ISO_OUTPUT_REACTION:
      return Output::reaction(effect_of(world, o.effect), vector(o.force, "force"),
                              vector(o.moment, "moment"));
    case ISO_OUTPUT_ELASTIC_ENERGY:
      return Output::elastic_energy();
    case ISO_OUTPUT_ENERGY:
      return Output::energy(text(o.quantity, "quantity"));
    case ISO_OUTPUT_STRESS:
      return Output::stress(body_of(world, o.body), o.cell, text(o.quantity, "quantity"));
    case ISO_OUTPUT_EFFECT_FORCE:
      return Output::effect_force(effect_of(world, o.effect), body_of(world, o.body),
                                  vector(o.direction, "direction"));
    case ISO_OUTPUT_OF_POSITIONS:
      if (o.function == nullptr) refuse("function is a null pointer");
      return Output::of_positions(body_of(world, o.body), function_of(o.function, o.user));
    default:
      refuse("kind = " + std::to_string(o.kind) + "; give one of ISO_OUTPUT_..., 0 to " +
             std::to_string(ISO_OUTPUT_OF_POSITIONS));
  }
}

// By the path of a key, or by a function of the caller.
NumberInKeys number_from(const iso_parameter& p) {
  if (p.make == nullptr) return need(number_in_keys(text(p.keys, "keys"), text(p.key, "key")));
  if (p.keys != nullptr || p.key != nullptr)
    refuse("keys and a function that makes them are given; leave one of them null");
  return {p.value, [make = p.make, user = p.user](double value) -> Result<std::string> {
            const char* keys = make(user, value);
            if (keys == nullptr) return Error{"the function makes no keys, but returns null"};
            return std::string(keys);
          }};
}

Parameter constant_from(const iso_world& w, const iso_parameter& p) {
  const EffectId effect = effect_of(*w.world, p.effect);
  PartContext context = w.keys.context(*w.world);
  std::erase(context.names_taken, w.world->effect_name(effect));
  return constant_by_keys(effect, text(p.effect_kind, "effect_kind"), number_from(p), std::move(context));
}

Curve curve_from(const iso_parameter& p) {
  Curve out;
  const double* pairs = &given(p.curve, "curve");
  for (std::size_t k = 0; k < p.curve_count; ++k) out.points.push_back({pairs[2 * k], pairs[2 * k + 1]});
  return out;
}

Parameter parameter_from(const iso_world& w, const iso_parameter& p) {
  const World& world = *w.world;
  const auto body = [&] { return body_of(world, p.body); };
  switch (p.kind) {
    case ISO_PARAMETER_AMOUNT_OF:
      return Parameter::amount_of(effect_of(world, p.effect));
    case ISO_PARAMETER_FORCE_AT:
      return Parameter::force_at(body(), vector(p.point, "point"), vector(p.vector, "vector"));
    case ISO_PARAMETER_GRAVITY:
      return Parameter::gravity(vector(p.vector, "vector"));
    case ISO_PARAMETER_DENSITY:
      return Parameter::density(body(), text_or_none(p.region));
    case ISO_PARAMETER_MATERIAL:
      return material_by_keys(body(), text_or_none(p.region), number_from(p), w.keys.folder);
    case ISO_PARAMETER_STIFFNESS:
      return Parameter::stiffness(body(), text_or_none(p.region));
    case ISO_PARAMETER_CELL_STIFFNESS:
      return Parameter::cell_stiffness(body());
    case ISO_PARAMETER_CONSTANT_OF:
      return constant_from(w, p);
    case ISO_PARAMETER_SHAPE:
      return Parameter::shape(body(), vectors(p.motion, p.count, p.stride, "motion"));
    case ISO_PARAMETER_INITIAL_VELOCITY:
      return Parameter::initial_velocity(body(), vectors(p.motion, p.count, p.stride, "motion"));
    case ISO_PARAMETER_CURVE_POINT:
      return Parameter::curve_point(effect_of(world, p.effect), curve_from(p), p.number);
    default:
      refuse("kind = " + std::to_string(p.kind) + "; give one of ISO_PARAMETER_..., 0 to " +
             std::to_string(ISO_PARAMETER_CURVE_POINT));
  }
}

GradientQuery::Mode mode_from(int32_t mode) {
  if (mode < ISO_GRADIENTS_AUTOMATIC || mode > ISO_GRADIENTS_TANGENT)
    refuse("query->mode = " + std::to_string(mode) + "; give one of ISO_GRADIENTS_..., 0 to 2");
  return static_cast<GradientQuery::Mode>(mode);
}

std::vector<Parameter> parameters_from(const iso_world& w, const iso_parameter* parameters, size_t count) {
  std::vector<Parameter> out;
  if (count > 0) check_size(parameters, "query->parameters");
  for (std::size_t k = 0; k < count; ++k) {
    const std::string where = place("parameters", k);
    const iso_parameter p = taken(nth(parameters, k), where.c_str());
    out.push_back(at_place(where, [&] { return parameter_from(w, p); }));
    out.back().step = p.step;
  }
  return out;
}

GradientQuery query_from(const iso_world& w, const iso_gradient_query& given) {
  GradientQuery query;
  query.mode = mode_from(given.mode);
  query.unstable = given.unstable != 0;
  if (given.output_count > 0) check_size(given.outputs, "query->outputs");
  for (std::size_t j = 0; j < given.output_count; ++j) {
    const std::string where = place("outputs", j);
    const iso_output o = taken(nth(given.outputs, j), where.c_str());
    query.outputs.push_back(at_place(where, [&] { return output_from(*w.world, o); }));
  }
  query.parameters = parameters_from(w, given.parameters, given.parameter_count);
  return query;
}

TrajectoryQuery query_from(const iso_world& w, const iso_trajectory_query& given) {
  TrajectoryQuery query;
  query.mode = mode_from(given.mode);
  query.kept_states = given.kept_states;
  if (given.step_count > 0) {
    const double* first = &isochor::c::given(given.steps, "query->steps");
    query.steps.assign(first, first + given.step_count);
  }
  if (given.term_count > 0) {
    check_size(given.terms, "query->terms");
    (void)isochor::c::given(given.term_steps, "query->term_steps");
  }
  const std::size_t outputs = given.term_output ? given.output_count : given.term_count;
  if (given.term_output && outputs > given.term_count)
    refuse("query->output_count = " + std::to_string(outputs) + " for " + std::to_string(given.term_count) +
           " terms; give every output a term");
  query.outputs.resize(outputs);
  for (std::size_t k = 0; k < given.term_count; ++k) {
    const std::string where = place("terms", k);
    const std::size_t to = given.term_output ? static_cast<std::size_t>(given.term_output[k]) : k;
    if (given.term_output && (given.term_output[k] < 0 || to >= outputs))
      refuse("query->term_output[" + std::to_string(k) + "] = " + std::to_string(given.term_output[k]) +
             "; there are outputs 0 to " + std::to_string(outputs - 1));
    const iso_output o = taken(nth(given.terms, k), where.c_str());
    query.outputs[to].terms.push_back(
        {given.term_steps[k], at_place(where, [&] { return output_from(*w.world, o); })});
  }
  query.parameters = parameters_from(w, given.parameters, given.parameter_count);
  return query;
}

KeptGradients kept(Gradients told, const World& world, const std::vector<Parameter>& parameters) {
  KeptGradients out;
  out.told = std::move(told);
  for (const auto& row : out.told.by) {
    for (const auto& numbers : row) out.jacobian.insert(out.jacobian.end(), numbers.begin(), numbers.end());
  }
  out.columns.push_back(0);
  for (const Parameter& p : parameters) {
    const Index width = p.kind == Parameter::Kind::cells ? world.mesh(p.body).cell_count() : 1;
    out.columns.push_back(out.columns.back() + static_cast<std::size_t>(width));
  }
  for (const std::string& name : out.told.undecided) out.undecided.push_back(name.c_str());
  return out;
}

void show(const KeptGradients& from, iso_gradient_table& out) {
  out.values = from.told.values.data();
  out.output_count = from.told.values.size();
  out.jacobian = from.jacobian.data();
  out.column_count = from.columns.back();
  out.columns = from.columns.data();
  out.regular = from.told.regular ? 1 : 0;
  out.note = from.told.note.c_str();
  out.undecided = from.undecided.data();
  out.undecided_count = from.undecided.size();
  out.adjoint = from.told.adjoint ? 1 : 0;
  out.kept_states = from.told.kept_states;
  out.steps_again = from.told.steps_again;
  out.state_bytes = from.told.state_bytes;
}

}  // namespace

}  // namespace isochor::c

using namespace isochor;
using namespace isochor::c;

extern "C" iso_status iso_gradients(iso_world* world, const iso_gradient_query* query,
                                    iso_gradient_table* out) {
  return enter(world, "iso_gradients", [&] {
    World& w = *world->world;
    Filled<iso_gradient_table> told(out, "out");
    const iso_gradient_query given = taken(query, "query");
    need(w.compile());
    const GradientQuery asked = query_from(*world, given);
    KeptGradients made = kept(need(w.gradients(asked)), w, asked.parameters);
    // Moved as a whole: vectors keep their places, and so do the names that `undecided` points to.
    world->answers.gradients = std::move(made);
    show(world->answers.gradients, *told);
    told.give();
  });
}

extern "C" iso_status iso_trajectory_gradients(iso_world* world, const iso_trajectory_query* query,
                                               iso_gradient_table* out) {
  return enter(world, "iso_trajectory_gradients", [&] {
    World& w = *world->world;
    Filled<iso_gradient_table> told(out, "out");
    const iso_trajectory_query given = taken(query, "query");
    need(w.compile());
    const TrajectoryQuery asked = query_from(*world, given);
    KeptGradients made = kept(need(w.trajectory_gradients(asked)), w, asked.parameters);
    world->answers.gradients = std::move(made);
    show(world->answers.gradients, *told);
    told.give();
  });
}
