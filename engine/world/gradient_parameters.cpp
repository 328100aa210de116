// Parameters of an equilibrium: how the equations change with each, positions and multipliers held.
//   exact         forces, gravity, densities, stiffnesses of regions and cells
//   difference    amounts: the scene as it is, its amount moved; constants of materials and effects, and
//                 rest positions: the changed scene is compiled beside the present one
#include <algorithm>
#include <cmath>

#include "engine/base/text.h"
#include "engine/scene/free_motions.h"
#include "engine/step/time_scheme.h"
#include "engine/world/gradient_parts.h"

namespace isochor {

Parameter Parameter::amount_of(EffectId effect) {
  Parameter p;
  p.effect = effect;
  return p;
}

Parameter Parameter::curve_point(EffectId effect, Curve curve, Index number) {
  Parameter p = amount_of(effect);
  p.kind = Kind::curve;
  p.curve = std::move(curve);
  p.number = number;
  return p;
}

Parameter Parameter::force_at(BodyId body, const Vec3& point, const Vec3& force) {
  Parameter p;
  p.kind = Kind::force;
  p.body = body;
  p.point = point;
  p.vector = force;
  return p;
}

Parameter Parameter::gravity(const Vec3& direction) {
  Parameter p;
  p.kind = Kind::gravity;
  p.vector = direction;
  return p;
}

Parameter Parameter::density(BodyId body, std::string region) {
  Parameter p;
  p.kind = Kind::density;
  p.body = body;
  p.region = std::move(region);
  return p;
}

Parameter Parameter::material(BodyId body, std::string region, double value,
                              std::function<Result<MaterialPtr>(double)> law) {
  Parameter p;
  p.kind = Kind::material;
  p.body = body;
  p.region = std::move(region);
  p.value = value;
  p.law = std::move(law);
  return p;
}

Parameter Parameter::stiffness(BodyId body, std::string region) {
  Parameter p;
  p.kind = Kind::stiffness;
  p.body = body;
  p.region = std::move(region);
  return p;
}

Parameter Parameter::cell_stiffness(BodyId body) {
  Parameter p;
  p.kind = Kind::cells;
  p.body = body;
  return p;
}

Parameter Parameter::constant_of(EffectId effect, double value,
                                 std::function<Result<EffectPtr>(double)> definition) {
  Parameter p;
  p.kind = Kind::constant;
  p.effect = effect;
  p.value = value;
  p.definition = std::move(definition);
  return p;
}

Parameter Parameter::shape(BodyId body, std::vector<Vec3> motion) {
  Parameter p;
  p.kind = Kind::shape;
  p.body = body;
  p.motion = std::move(motion);
  return p;
}

Parameter Parameter::initial_velocity(BodyId body, std::vector<Vec3> motion) {
  Parameter p = shape(body, std::move(motion));
  p.kind = Kind::velocity;
  return p;
}

namespace {

// Five values of a smooth function around or on one side of where it is; errors go with the fourth power of
// the distance.
struct Difference {
  std::array<int, 5> at;
  std::array<double, 5> weight;
};
constexpr Difference central{{-2, -1, 0, 1, 2}, {1. / 12, -8. / 12, 0, 8. / 12, -1. / 12}};
constexpr Difference above{{0, 1, 2, 3, 4}, {-25. / 12, 48. / 12, -36. / 12, 16. / 12, -3. / 12}};
constexpr Difference below{{0, -1, -2, -3, -4}, {25. / 12, -48. / 12, 36. / 12, -16. / 12, 3. / 12}};

constexpr double small = 1e-4;  // of a parameter, or of the size of a cell

double largest(std::span<const Vec3> list) {
  double out = 0;
  for (const Vec3& v : list) out = std::max(out, norm(v));
  return out;
}

// How far one side is from the mirror image of the other, against what changed at all.
bool is_linear(const Equations& up, const Equations& here, const Equations& down) {
  constexpr double straight = 1e-10;
  double bend = 0, change = 0;
  bool linear = true;
  const auto begin = [&] { bend = change = 0; };
  const auto end = [&] { linear = linear && bend <= straight * change; };
  const auto vectors = [&](const std::vector<Vec3>& u, const std::vector<Vec3>& h,
                           const std::vector<Vec3>& d) {
    begin();
    for (std::size_t i = 0; i < u.size(); ++i) {
      bend = std::max(bend, norm(u[i] - 2.0 * h[i] + d[i]));
      change = std::max(change, norm(u[i]) + norm(d[i]));
    }
    end();
  };
  const auto numbers = [&](const std::vector<double>& u, const std::vector<double>& h,
                           const std::vector<double>& d) {
    begin();
    for (std::size_t i = 0; i < u.size(); ++i) {
      bend = std::max(bend, std::abs(u[i] - 2 * h[i] + d[i]));
      change = std::max(change, std::abs(u[i]) + std::abs(d[i]));
    }
    end();
  };
  vectors(up.force, here.force, down.force);
  vectors(up.position, here.position, down.position);
  numbers(up.theta, here.theta, down.theta);
  numbers(up.seen, here.seen, down.seen);
  return linear;
}

// Cube root of the mean volume of the cells of a body.
double cell_size(const BodyData& body, std::span<const Vec3> rest) {
  std::vector<double> volume(rest.size(), 0);
  double sum = 0;
  for (const RegionData& region : body.regions)
    add_nodal_volume(*body.reference, rest, body.global_cells, region.cells, 1, volume);
  for (const double v : volume) sum += v;
  return std::cbrt(sum / body.mesh.cell_count());
}

}  // namespace

Result<void> World::Impl::Equilibrium::check_body(BodyId body, const char* who) const {
  const auto& builder = w.said.builder;
  if (builder.has_body(body)) return {};
  return Error{std::string("gradients: ") + who + ": " + builder.no_body(body)};
}

Result<CellTerms> World::Impl::Equilibrium::cell_terms(BodyId body) const {
  // Energies of bodies beside those that are known here would be left out.
  const auto& owner = w.said.builder.owners().stencil_pool;
  const auto known = [&](Index pool) {
    for (const BodyData& b : w.said.builder.bodies()) {
      for (const RegionData& r : b.regions) {
        if (r.elastic_pool == pool || r.guard_pool == pool) return true;
      }
    }
    return false;
  };
  for (std::size_t p = 0; p < owner.size(); ++p) {
    const StencilPool& pool = *w.system().parts().stencil_pools[p];
    if (owner[p] >= 0 || !pool.has_energy() || known(static_cast<Index>(p))) continue;
    return Error{"gradients: how the energy of \"" + std::string(pool.name()) +
                 "\" goes with the stiffness of cells is not known; take constants of the material"};
  }
  return CellTerms{
      w.said.builder.body(body), w.system(), w.assembly(), *w.parallel, w.state.x, w.state.lambda};
}

Result<Equations> World::Impl::Equilibrium::change_by(const Parameter& p) {
  Equations change(w.system(), watched.size());
  if (!finite(p.vector) || !finite(p.point)) {
    return Error{"gradients: the vector is " + point_text(p.vector) + " and the point " +
                 point_text(p.point) + " m; give finite numbers"};
  }
  if (!(p.step >= 0) || !std::isfinite(p.step)) {
    return Error{"gradients: step = " + number(p.step) +
                 "; give how far to move the value, a positive number, or 0 for the usual"};
  }
  switch (p.kind) {
    case Parameter::Kind::amount:
      return change_by_amount(p);
    case Parameter::Kind::force: {
      if (auto r = check_body(p.body, "force"); !r) return r.failure();
      auto point = embed(w.said.builder.body(p.body), w.system().parts().rest, p.point, "gradients");
      if (!point) return point.failure();
      for (std::size_t k = 0; k < point.value().nodes.size(); ++k)
        change.force[at(point.value().nodes[k])] -= point.value().weight[k] * p.vector;
      add_work(Watched::What::loads, change);
      return change;
    }
    case Parameter::Kind::gravity:
      for (std::size_t i = 0; i < change.force.size(); ++i) change.force[i] -= w.data->weight()[i] * p.vector;
      add_work(Watched::What::gravity, change);
      return change;
    case Parameter::Kind::curve:
      return change_by_curve(p);
    case Parameter::Kind::density:
      return change_by_density(p);
    case Parameter::Kind::stiffness:
      return change_by_stiffness(p);
    case Parameter::Kind::cells:
      return Error{
          "gradients: cell_stiffness is a number a cell, and tangents would solve as often; ask by the "
          "adjoint"};
    case Parameter::Kind::material:
    case Parameter::Kind::constant:
    case Parameter::Kind::shape:
      return change_beside(p);
    case Parameter::Kind::velocity:
      if (!inertia)
        return Error{"gradients: an equilibrium has no velocity to begin with; ask trajectory_gradients()"};
      return check_motion(p);
  }
  return change;
}

Result<Equations> World::Impl::Equilibrium::change_by_amount(const Parameter& p) {
  const auto e = static_cast<std::size_t>(p.effect);
  Amount* amount = w.instances[e]->amount();
  if (!amount) {
    return Error{"gradients: effect \"" + w.said.sources[e]->name() + "\" has no amount to change"};
  }
  const auto moved = [&](double by) {
    amount->shift(by);
    Equations out = equations_at(present(), w.state, watched);
    amount->shift(0);
    return out;
  };
  // Far where the equations are linear in it, as rounding then counts for less.
  const double far = std::max(1.0, std::abs(amount->value(w.state.t)));
  Equations up = moved(far);
  const Equations down = moved(-far);
  Equations change(w.system(), watched.size());
  if (is_linear(up, here, down)) {
    change.add(0.5 / far, up);
    change.add(-0.5 / far, down);
  } else {
    const double h = p.step > 0 ? p.step : small * far;
    for (std::size_t k = 0; k < central.at.size(); ++k) {
      if (central.at[k] != 0) change.add(central.weight[k] / h, moved(central.at[k] * h));
    }
  }
  return change;
}

// Loads that do not depend on positions have changed by minus the forces of the change so far.
void World::Impl::Equilibrium::add_work(Watched::What energy, Equations& change) const {
  Watched one;
  one.what = energy;
  const Index k = place_of(one);
  if (k >= 0) change.seen[at(k)] += work_on(change.force, w.state.x, w.system().parts().rest);
}

// The amount moves by as much of the point as the curve has of it now.
Result<Equations> World::Impl::Equilibrium::change_by_curve(const Parameter& p) {
  const auto e = static_cast<std::size_t>(p.effect);
  const Amount* amount = w.instances[e]->amount();
  const std::string who = "gradients: curve of effect \"" + w.said.sources[e]->name() + "\": ";
  const auto points = static_cast<Index>(p.curve.points.size());
  if (!amount) return Error{who + "it has no amount to change"};
  if (p.number < 0 || p.number >= points)
    return Error{who + "there is no point " + std::to_string(p.number) + "; it has " +
                 std::to_string(points) + ", by number from 0"};
  const double said = evaluate(p.curve, w.state.t), now = amount->value(w.state.t);
  if (!(std::abs(said - now) <= 1e-12 * std::max(std::abs(said), std::abs(now)))) {
    return Error{who + "at " + number(w.state.t) + " s it is " + number(said) + ", but the amount is " +
                 number(now) + "; give the curve that the amount follows, which no host has set since"};
  }
  Curve unit = p.curve;
  for (auto& point : unit.points) point[1] = 0;
  unit.points[at(p.number)][1] = 1;
  const double part = evaluate(unit, w.state.t);
  Equations change(w.system(), watched.size());
  if (part == 0) return change;
  auto whole = change_by_amount(p);
  if (!whole) return whole;
  change.add(part, whole.value());
  return change;
}

Result<Equations> World::Impl::Equilibrium::change_by_density(const Parameter& p) {
  if (auto r = check_body(p.body, "density"); !r) return r.failure();
  const BodyData& body = w.said.builder.body(p.body);
  auto regions = w.said.builder.regions(
      p.body, p.region.empty() ? std::span<const std::string>() : std::span(&p.region, 1), "gradients");
  if (!regions) return regions.failure();
  // Drag goes with mass, in a way that its pool alone knows.
  if (inertia && !w.system().facets().dissipative.empty()) return density_beside(p, regions.value());
  // As gravity acts (gravity_mass()).
  const bool lumped = w.options.scheme->has_inertia() && !w.options.consistent_mass;
  std::vector<double> volume(w.state.x.size(), 0);
  for (const std::size_t r : regions.value()) {
    (lumped ? add_lumped_mass : add_nodal_volume)(*body.reference, w.system().parts().rest, body.global_cells,
                                                  body.regions[r].cells, 1, volume);
  }
  const Vec3 g = w.data->gravity(w.state.t);
  Equations change(w.system(), watched.size());
  for (std::size_t i = 0; i < volume.size(); ++i) change.force[i] -= volume[i] * g;
  add_work(Watched::What::gravity, change);
  if (inertia) add_mass_change(body, regions.value(), change);
  return change;
}

// The equations are linear in densities.
Result<Equations> World::Impl::Equilibrium::density_beside(const Parameter& p,
                                                           std::span<const std::size_t> regions) {
  const BodyData& body = w.said.builder.body(p.body);
  double by = 0;
  for (const std::size_t r : regions) by = std::max(by, body.regions[r].density);
  if (!(by > 0)) by = 1;
  const auto at_density = [&](double more) -> Result<Equations> {
    Description next{w.said.builder.again(), w.said.places, w.said.sources, w.said.order};
    for (const std::size_t r : regions) {
      const RegionData& region = body.regions[r];
      if (auto set = next.builder.set_density(p.body, region.name, region.density + more); !set)
        return set.failure();
    }
    return w.equations_beside(std::move(next), watched, inertia);
  };
  auto more = at_density(by), present_one = at_density(0);
  if (!more) return Error{"gradients: density: " + more.error()};
  if (!present_one) return Error{"gradients: density: " + present_one.error()};
  Equations change(w.system(), watched.size());
  change.add(1 / by, more.value());
  change.add(-1 / by, present_one.value());
  return change;
}

// What resists, and kinetic energy, per unit of density.
void World::Impl::Equilibrium::add_mass_change(const BodyData& body, std::span<const std::size_t> regions,
                                               Equations& change) const {
  const auto rest = w.system().parts().rest;
  std::vector<double> mass(rest.size(), 0);
  std::vector<MassEntry> entries;
  for (const std::size_t r : regions) {
    const std::span<const Index> cells = body.regions[r].cells;
    if (w.system().block_mass().empty())
      add_lumped_mass(*body.reference, rest, body.global_cells, cells, 1, mass);
    else
      add_consistent_mass(*body.reference, rest, body.global_cells, cells, 1, entries);
  }
  const auto add_heavy = [&](std::span<const Vec3> v, std::span<Vec3> to) {
    for (std::size_t i = 0; i < v.size(); ++i) to[i] += mass[i] * v[i];
    for (const MassEntry& e : entries) {
      to[at(e.row)] += e.value * v[at(e.col)];
      if (e.row != e.col) to[at(e.col)] += e.value * v[at(e.row)];
    }
  };
  std::vector<Vec3> off(rest.size());
  for (std::size_t i = 0; i < off.size(); ++i)
    off[i] = inertia->mass_scale * (w.state.x[i] - inertia->predicted[i]);
  add_heavy(off, change.force);
  Watched kinetic;
  kinetic.what = Watched::What::kinetic;
  const Index k = place_of(kinetic);
  if (k < 0) return;
  std::vector<Vec3> moving(rest.size());
  add_heavy(w.state.v, moving);
  for (std::size_t i = 0; i < moving.size(); ++i) change.seen[at(k)] += 0.5 * dot(moving[i], w.state.v[i]);
}

// Nothing of an increment depends on the velocities before the first.
Result<Equations> World::Impl::Equilibrium::check_motion(const Parameter& p) const {
  if (auto r = check_body(p.body, "initial_velocity"); !r) return r.failure();
  const BodyData& body = w.said.builder.body(p.body);
  if (p.motion.size() != at(body.mesh.node_count()) ||
      !std::all_of(p.motion.begin(), p.motion.end(), finite)) {
    return Error{"gradients: initial_velocity: motion has " + std::to_string(p.motion.size()) +
                 " vectors, body \"" + body.name + "\" " + std::to_string(body.mesh.node_count()) +
                 " nodes; give one a node of World::mesh(), all finite"};
  }
  return Equations(w.system(), watched.size());
}

Result<Equations> World::Impl::Equilibrium::change_by_stiffness(const Parameter& p) {
  if (auto r = check_body(p.body, "stiffness"); !r) return r.failure();
  const BodyData& body = w.said.builder.body(p.body);
  auto regions = w.said.builder.regions(
      p.body, p.region.empty() ? std::span<const std::string>() : std::span(&p.region, 1), "gradients");
  if (!regions) return regions.failure();
  std::vector<double> rate(at(body.mesh.cell_count()), 0);
  for (const std::size_t r : regions.value()) {
    for (const Index c : body.regions[r].cells) rate[at(c)] = 1;
  }
  Equations change(w.system(), watched.size());
  const auto terms = cell_terms(p.body);
  if (!terms) return terms.failure();
  double energy = 0;
  auto done = terms.value().each_force([&](const CellTerms::Stencil& stencil) {
    const double factor = stencil.share * rate[at(stencil.cell)];
    energy += factor * stencil.energy;
    for (std::size_t a = 0; a < stencil.nodes.size(); ++a)
      change.force[at(stencil.nodes[a])] += factor * stencil.forces[a];
  });
  if (!done) return done.failure();
  terms.value().each_row([&](Index cell, Index row, double value) {
    change.theta[at(row)] += rate[at(cell)] * value;
    energy -= 0.5 * rate[at(cell)] * value * w.state.lambda[at(row)];
  });
  Watched elastic;
  elastic.what = Watched::What::elastic;
  if (const Index k = place_of(elastic); k >= 0) change.seen[at(k)] = energy;
  add_stress_of(rate, p.body, change);
  return change;
}

// The scene with the parameter at another value. Where a law refuses the value, `refused_by_law`.
Result<Description> World::Impl::Equilibrium::beside(const Parameter& p, double value, bool& refused_by_law) {
  Description next{w.said.builder.again(), w.said.places, w.said.sources, w.said.order};
  refused_by_law = false;
  if (p.kind == Parameter::Kind::material) {
    auto made = p.law(value);
    refused_by_law = !made;
    if (!made) return made.failure();
    if (auto r = next.builder.set_material(p.body, p.region, made.value()); !r) return r.failure();
  } else if (p.kind == Parameter::Kind::constant) {
    auto made = p.definition(value);
    refused_by_law = !made;
    if (!made) return made.failure();
    if (!made.value()) return Error{"the definition of the effect is empty"};
    auto checked = made.value()->check();
    refused_by_law = !checked;
    if (!checked) return checked.failure();
    next.sources[static_cast<std::size_t>(p.effect)] = std::move(made).value();
  } else {
    std::vector<Vec3> by = p.motion;
    for (Vec3& v : by) v = value * v;
    next.builder.move_nodes(p.body, by);
  }
  return next;
}

Result<Equations> World::Impl::Equilibrium::change_beside(const Parameter& p) {
  const bool shape = p.kind == Parameter::Kind::shape, effect = p.kind == Parameter::Kind::constant;
  const std::string who = shape    ? "gradients: shape: "
                          : effect ? "gradients: constant of effect \"" +
                                         w.said.sources[static_cast<std::size_t>(p.effect)]->name() + "\": "
                                   : std::string("gradients: constant of a material: ");
  if (!effect) {
    if (auto r = check_body(p.body, "a parameter"); !r) return r.failure();
  }
  if (!shape && !(effect ? p.definition != nullptr : p.law != nullptr))
    return Error{who + "there is no function that makes it"};
  // What the state remembers of the past would have been another.
  if ((shape || effect) && !w.system().facets().remembering_rows.empty())
    return Error{who +
                 "chambers with gas or liquid remember what they were filled with, which depends on it; "
                 "control their pressure or volume"};
  double h = p.step > 0 ? p.step : small * std::abs(p.value);
  if (shape) {
    const BodyData& body = w.said.builder.body(p.body);
    if (p.motion.size() != at(body.mesh.node_count())) {
      return Error{who + "motion has " + std::to_string(p.motion.size()) + " vectors, body \"" + body.name +
                   "\" " + std::to_string(body.mesh.node_count()) +
                   " nodes; give one a node of World::mesh()"};
    }
    const double most = largest(p.motion);
    if (!(most > 0) || !std::isfinite(most)) return Error{who + "motion is zero or not finite"};
    h = small * cell_size(body, w.system().parts().rest) / most;
  }
  if (!(h > 0) || !std::isfinite(h))
    return Error{who + "value = " + number(p.value) +
                 ": nothing says how far to move it; set Parameter::step"};

  const double value = shape ? 0 : p.value;
  bool refused = false;
  const auto equations = [&](int steps) -> Result<Equations> {
    auto next = beside(p, value + steps * h, refused);
    if (!next) return Error{who + next.error()};
    auto out = w.equations_beside(std::move(next).value(), watched, inertia);
    if (!out) return Error{who + out.error()};
    return out;
  };
  Result<Equations> as_it_is(Error{""});
  if (!compared) {
    as_it_is = equations(0);
    if (!as_it_is) return as_it_is.failure();
    if (!is_here(as_it_is.value())) {
      return Error{who + "at value = " + number(value) +
                   " it is not what the scene has: the function makes another one; give the value that the "
                   "scene was made with"};
    }
  }
  // On both sides, or on the one that there is (Poisson's ratio ends at 0.5).
  const Difference* how = &central;
  for (const Difference* d : {&above, &below}) {
    bool end = false;
    if (auto next = beside(p, value + d->at[2] * h, end); !next && end) how = d == &above ? &below : &above;
  }
  if (how != &central && !as_it_is) as_it_is = equations(0);
  Equations change(w.system(), watched.size());
  for (std::size_t k = 0; k < how->at.size(); ++k) {
    if (how->weight[k] == 0) continue;
    if (how->at[k] == 0) {
      if (!as_it_is) return as_it_is.failure();
      change.add(how->weight[k] / h, as_it_is.value());
      continue;
    }
    auto there = equations(how->at[k]);
    if (!there) return there.failure();
    change.add(how->weight[k] / h, there.value());
  }
  return change;
}

std::vector<Vec3> World::Impl::Equilibrium::way_of(std::span<const Vec3> position) const {
  const System& s = w.system();
  std::vector<Vec3> way(at(s.nodes()));
  for (Index i = 0; i < s.nodes(); ++i) {
    const Index b = s.basis_of()[at(i)];
    if (b < 0) continue;
    const FreeBasis& basis = s.free_bases()[at(b)];
    Vec3 q = transposed_times(basis.directions, position[at(b)]);
    for (int c = 0; c < basis.count; ++c) q[c] = 0;
    way[at(i)] = basis.directions * q;
  }
  return way;
}

double World::Impl::Equilibrium::held(const OutputSeed& seed, const Equations& change) {
  double sum = 0;
  for (const Index k : seed.held) sum += k >= 0 ? change.seen[at(k)] : 0;
  return sum;
}

double World::Impl::Equilibrium::by_adjoint(const OutputSeed& seed, const Adjoint& adjoint,
                                            const Equations& change) const {
  double sum = held(seed, change);
  const std::vector<Vec3> way = way_of(change.position);
  for (std::size_t i = 0; i < way.size(); ++i)
    sum += dot(adjoint.given[i], way[i]) - dot(adjoint.force[i], change.force[i]);
  for (std::size_t r = 0; r < adjoint.row.size(); ++r) sum -= adjoint.row[r] * change.theta[r];
  return sum;
}

// Along the solution in dx and dlambda.
double World::Impl::Equilibrium::by_tangent(const OutputSeed& seed, const Equations& change) const {
  double sum = held(seed, change);
  for (std::size_t i = 0; i < dx.size(); ++i)
    sum += dot(seed.x[i], dx[i]) + dot(seed.through[i], change.force[i]);
  for (std::size_t r = 0; r < dlambda.size(); ++r) sum += seed.multiplier[r] * dlambda[r];
  return sum;
}

Result<std::vector<double>> World::Impl::Equilibrium::by_cells(const OutputSeed& seed, const Adjoint& adjoint,
                                                               BodyId body) {
  if (auto r = check_body(body, "cell_stiffness"); !r) return r.failure();
  std::vector<double> out(at(w.said.builder.body(body).mesh.cell_count()), 0);
  const auto terms = cell_terms(body);
  if (!terms) return terms.failure();
  const StressShares stress = stress_shares(seed, body);
  for (const auto& [cell, value] : stress.own) out[at(cell)] += value;
  auto done = terms.value().each_force([&](const CellTerms::Stencil& stencil) {
    double sum = seed.energies * stencil.energy + stress.of(stencil, w.state.x);
    for (std::size_t a = 0; a < stencil.nodes.size(); ++a)
      sum -= dot(adjoint.force[at(stencil.nodes[a])], stencil.forces[a]);
    out[at(stencil.cell)] += stencil.share * sum;
  });
  if (!done) return done.failure();
  terms.value().each_row([&](Index cell, Index row, double value) {
    const double held = 0.5 * seed.energies * w.state.lambda[at(row)];
    out[at(cell)] -= (adjoint.row[at(row)] + held) * value;
  });
  return out;
}

}  // namespace isochor
