// Outputs of an equilibrium: how each depends on positions, multipliers and forces of supports, and the
// solution of its own linear system (the adjoint).
#include <algorithm>
#include <cmath>

#include "engine/base/text.h"
#include "engine/scene/free_motions.h"
#include "engine/solve/evaluator.h"
#include "engine/world/gradient_parts.h"

namespace isochor {

Output Output::positions(BodyId body, std::vector<Index> nodes, std::vector<Vec3> weights) {
  Output o;
  o.body = body;
  o.nodes = std::move(nodes);
  o.vectors = std::move(weights);
  return o;
}

Output Output::node(BodyId body, Index node, const Vec3& direction) {
  return positions(body, {node}, {direction});
}

Output Output::material_point(BodyId body, const Vec3& point, const Vec3& direction) {
  Output o = positions(body, {}, {direction});
  o.point = point;
  o.at_point = true;
  return o;
}

Output Output::distance(BodyId body, std::vector<Index> nodes, std::vector<Vec3> targets) {
  Output o = positions(body, std::move(nodes), std::move(targets));
  o.kind = Kind::distance;
  return o;
}

Output Output::gauge(EffectId effect, std::string quantity) {
  Output o;
  o.kind = Kind::gauge;
  o.effect = effect;
  o.quantity = std::move(quantity);
  return o;
}

Output Output::reaction(EffectId effect, const Vec3& force, const Vec3& moment) {
  Output o;
  o.kind = Kind::reaction;
  o.effect = effect;
  o.force = force;
  o.moment = moment;
  return o;
}

Output Output::elastic_energy() {
  return energy("elastic");
}

Output Output::energy(std::string part) {
  Output o;
  o.kind = Kind::energy;
  o.quantity = std::move(part);
  return o;
}

Output Output::square(BodyId body, std::vector<Index> nodes, std::vector<Vec3> weights, double target) {
  Output o = positions(body, std::move(nodes), std::move(weights));
  o.kind = Kind::square;
  o.target = target;
  return o;
}

Output Output::stress(BodyId body, Index cell, std::string measure) {
  Output o;
  o.kind = Kind::stress;
  o.body = body;
  o.cell = cell;
  o.quantity = std::move(measure);
  return o;
}

Output Output::effect_force(EffectId effect, BodyId body, const Vec3& direction) {
  Output o;
  o.kind = Kind::force;
  o.effect = effect;
  o.body = body;
  o.force = direction;
  return o;
}

Output Output::of_positions(BodyId body, Function function) {
  Output o;
  o.kind = Kind::function;
  o.body = body;
  o.function = std::move(function);
  return o;
}

void OutputSeed::add(const OutputSeed& other) {
  value += other.value;
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] += other.x[i];
    through[i] += other.through[i];
    v[i] += other.v[i];
  }
  for (std::size_t r = 0; r < multiplier.size(); ++r) multiplier[r] += other.multiplier[r];
  held.insert(held.end(), other.held.begin(), other.held.end());
  energies += other.energies;
  stresses.insert(stresses.end(), other.stresses.begin(), other.stresses.end());
}

Result<OutputSeed> World::Impl::Equilibrium::seed_of(const Output& output) {
  OutputSeed seed(w.state.x.size(), w.state.lambda.size());
  for (std::size_t k = 0; k < output.vectors.size(); ++k) {
    if (!finite(output.vectors[k])) {
      return Error{"gradients: the vector " + std::to_string(k) + " is " + point_text(output.vectors[k]) +
                   "; give finite numbers"};
    }
  }
  if (!finite(output.force) || !finite(output.moment)) {
    return Error{"gradients: the force is " + point_text(output.force) + " and the moment " +
                 point_text(output.moment) + "; give finite numbers"};
  }
  Result<void> done;
  switch (output.kind) {
    case Output::Kind::energy:
      seed_energy(output, seed);
      break;
    case Output::Kind::gauge:
      done = seed_gauge(output, seed);
      break;
    case Output::Kind::reaction:
      done = seed_reaction(output, seed);
      break;
    case Output::Kind::stress:
      done = seed_stress(output, seed);
      break;
    case Output::Kind::force:
      seed_force(output, seed);
      break;
    case Output::Kind::function:
      done = seed_function(output, seed);
      break;
    case Output::Kind::positions:
    case Output::Kind::distance:
    case Output::Kind::square:
      done = seed_positions(output, seed);
      break;
  }
  if (!done) return done.failure();
  if (!std::isfinite(seed.value)) {
    return Error{"gradients: the output is " + number(seed.value) + "; it has no derivative there"};
  }
  return seed;
}

Result<void> World::Impl::Equilibrium::seed_positions(const Output& output, OutputSeed& seed) {
  if (auto r = check_body(output.body, "an output"); !r) return r.failure();
  const BodyData& body = w.said.builder.body(output.body);
  if (output.at_point) {
    auto point = embed(body, w.system().parts().rest, output.point, "gradients");
    if (!point) return point.failure();
    for (std::size_t k = 0; k < point.value().nodes.size(); ++k)
      seed.x[at(point.value().nodes[k])] += point.value().weight[k] * output.vectors[0];
    seed.value = dot(output.vectors[0], point.value().at(w.state.x));
    return {};
  }
  if (output.nodes.empty() || output.nodes.size() != output.vectors.size()) {
    return Error{"gradients: an output names " + std::to_string(output.nodes.size()) + " nodes and " +
                 std::to_string(output.vectors.size()) + " vectors; give one vector a node, at least one"};
  }
  for (std::size_t k = 0; k < output.nodes.size(); ++k) {
    const Index n = output.nodes[k];
    if (n < 0 || n >= body.mesh.node_count()) {
      return Error{"gradients: an output names node " + std::to_string(n) + " of body \"" + body.name +
                   "\", which has nodes 0 to " + std::to_string(body.mesh.node_count() - 1)};
    }
    const Vec3& x = w.state.x[at(body.first_node + n)];
    Vec3& slot = seed.x[at(body.first_node + n)];
    if (output.kind == Output::Kind::distance) {
      const Vec3 off = x - output.vectors[k];
      seed.value += 0.5 * dot(off, off);
      slot += off;
    } else {
      seed.value += dot(output.vectors[k], x);
      slot += output.vectors[k];
    }
  }
  if (output.kind != Output::Kind::square) return {};
  if (!std::isfinite(output.target))
    return Error{"gradients: target = " + number(output.target) + "; give a finite number"};
  const double off = seed.value - output.target;
  for (Vec3& v : seed.x) v = off * v;
  seed.value = 0.5 * off * off;
  return {};
}

Result<void> World::Impl::Equilibrium::seed_function(const Output& output, OutputSeed& seed) {
  if (auto r = check_body(output.body, "an output"); !r) return r.failure();
  if (!output.function) return Error{"gradients: there is no function of positions"};
  const BodyData& body = w.said.builder.body(output.body);
  const auto first = at(body.first_node), count = at(body.mesh.node_count());
  const auto made = output.function(std::span<const Vec3>(w.state.x).subspan(first, count),
                                    std::span(seed.x).subspan(first, count));
  if (!made) return Error{"gradients: the function of positions: " + made.error()};
  seed.value = made.value();
  if (std::isfinite(seed.value) && std::all_of(seed.x.begin(), seed.x.end(), finite)) return {};
  return Error{"gradients: the function of positions makes " + number(seed.value) +
               ", or a gradient that is not finite; give finite numbers"};
}

Result<void> World::Impl::Equilibrium::seed_gauge(const Output& output, OutputSeed& seed) {
  const auto e = static_cast<std::size_t>(output.effect);
  const EffectInstance& instance = *w.instances[e];
  const std::string who =
      "gradients: gauge \"" + output.quantity + "\" of effect \"" + w.said.sources[e]->name() + "\"";
  seed.value = gauge_value(instance, output.quantity, w.system(), w.state);
  if (std::isnan(seed.value)) return Error{who + ": there is no such gauge; World::gauges() lists them"};
  for (const GaugeSource& g : instance.gauge_sources()) {
    if (g.quantity != output.quantity) continue;
    const System& s = w.system();
    const RowPool& rows = *s.parts().row_pools[at(g.row_pool)];
    Watched one;
    one.effect = static_cast<Index>(e);
    one.quantity = output.quantity;
    seed.held.push_back(place_of(one));
    if (g.multiplier) {
      // One that is given follows from parameters alone.
      if (rows.law == RowLaw::compliant) seed.multiplier[at(s.first_row(g.row_pool) + g.row)] += g.factor;
      return {};
    }
    const StencilPool& pool = *s.parts().stencil_pools[at(rows.stencil_pool)];
    const auto functions = static_cast<std::size_t>(pool.functions());
    std::vector<double> multiplier(at(pool.stencils()) * functions, 0.0);
    for (Index i = rows.map.offset[at(g.row)]; i < rows.map.offset[at(g.row) + 1]; ++i)
      multiplier[at(rows.map.item[at(i)])] += g.factor * rows.weight[at(i)];
    std::vector<double> energy(at(pool.stencils())), value(multiplier.size());
    std::vector<Vec3> gradient(pool.nodes().item.size()), jacobian(gradient.size() * functions);
    StencilSlots slots;
    slots.energy = energy;
    slots.value = value;
    slots.gradient = gradient;
    slots.jacobian = jacobian;
    StencilRequest request = w.assembly().request(rows.stencil_pool, Want::gradient, w.state.x);
    request.function_multiplier = multiplier;
    request.begin = 0;
    request.end = pool.stencils();
    pool.evaluate(request, slots);
    for (std::size_t i = 0; i < gradient.size(); ++i) seed.x[at(pool.nodes().item[i])] += gradient[i];
    return {};
  }
  return Error{who +
               ": its derivative is not among what gradients() knows; World::derivatives() has that of "
               "every gauge"};
}

// What forces on all nodes along `way` feel of positions and of multipliers: the transpose of how they
// change.
void World::Impl::Equilibrium::forces_back(std::span<const Vec3> way, std::span<Vec3> x,
                                           std::span<double> row) {
  w.assembly().hessian_times(way, x);
  w.assembly().jacobian_times(way, row);
  if (lag) lag->add_transposed(1, way, x, row);
  if (!inertia || !(inertia->mass_scale > 0)) return;
  std::vector<Vec3> heavy(way.size());
  w.assembly().mass_times(way, heavy);
  for (std::size_t i = 0; i < heavy.size(); ++i) x[i] += inertia->mass_scale * heavy[i];
}

// J = sum over held directions d of (force + moment x position) . d (d . R).
Result<void> World::Impl::Equilibrium::seed_reaction(const Output& output, OutputSeed& seed) {
  const auto e = static_cast<std::size_t>(output.effect);
  const bool holds = e < w.held_by.size() && !w.held_by[e].empty();
  if (!holds) {
    return Error{"gradients: effect \"" + w.said.sources[e]->name() +
                 "\" has no reaction at given coordinates; take a support that holds nodes, or "
                 "World::derivatives()"};
  }
  for (const HeldDirection& h : w.held_by[e]) {
    const auto n = at(h.node);
    const Vec3 reaction = dot(h.direction, here.force[n]) * h.direction;
    const Vec3 arm = output.force + cross(output.moment, w.state.x[n]);
    seed.value += dot(arm, reaction);
    seed.through[n] += dot(arm, h.direction) * h.direction;
    seed.x[n] += cross(reaction, output.moment);
  }
  // Forces of supports follow the unknowns.
  std::vector<Vec3> force(seed.x.size());
  std::vector<double> row(seed.multiplier.size());
  forces_back(seed.through, force, row);
  for (std::size_t i = 0; i < force.size(); ++i) seed.x[i] += force[i];
  for (std::size_t r = 0; r < row.size(); ++r) seed.multiplier[r] += row[r];
  return {};
}

Result<Adjoint> World::Impl::Equilibrium::adjoint_of(const OutputSeed& seed) {
  if (auto r = solve_transposed(seed.x, seed.multiplier); !r) return r.failure();
  Adjoint out{dx, seed.x, dlambda};
  std::vector<Vec3> force(dx.size()), pull(dx.size());
  std::vector<double> row(dlambda.size());
  forces_back(dx, force, row);
  w.assembly().constraint_force(dlambda, pull);
  for (std::size_t i = 0; i < dx.size(); ++i) {
    out.given[i] -= force[i] + pull[i];
    out.force[i] -= seed.through[i];
  }
  return out;
}

}  // namespace isochor
