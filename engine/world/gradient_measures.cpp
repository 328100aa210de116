// Outputs that are read off a scene rather than off positions alone: energies, stresses of cells, forces of
// effects. Each is watched, so that what a parameter changes of it at held unknowns is found with the change
// of the equations; how it changes with the unknowns is here.
#include <algorithm>
#include <cmath>
#include <map>

#include "engine/base/text.h"
#include "engine/scene/free_motions.h"
#include "engine/solve/evaluator.h"
#include "engine/step/time_scheme.h"
#include "engine/world/cell_stress.h"
#include "engine/world/gradient_parts.h"

namespace isochor {

namespace {

using What = Watched::What;

// The energies that an output is the sum of; empty: there is none of that name.
std::vector<What> parts_of_energy(const std::string& name) {
  if (name == "elastic") return {What::elastic};
  if (name == "gravity") return {What::gravity};
  if (name == "loads") return {What::loads};
  if (name == "pressures") return {What::pressures};
  if (name == "kinetic") return {What::kinetic};
  if (name == "potential") return {What::elastic, What::gravity, What::loads, What::pressures};
  if (name == "total") return {What::elastic, What::gravity, What::loads, What::pressures, What::kinetic};
  return {};
}

Watched watched_energy(What what) {
  Watched one;
  one.what = what;
  return one;
}

Watched watched_stress(const Output& o) {
  Watched one;
  one.what = What::stress;
  one.quantity = o.quantity;
  one.body = static_cast<Index>(o.body);
  one.cell = o.cell;
  return one;
}

Watched watched_force(const Output& o) {
  Watched one;
  one.what = What::force;
  one.effect = static_cast<Index>(o.effect);
  one.body = static_cast<Index>(o.body);
  one.direction = o.force;
  return one;
}

double dot(const Stress& a, const Stress& b) {
  double sum = 0;
  for (std::size_t k = 0; k < 6; ++k) sum += a[k] * b[k];
  return sum;
}

}  // namespace

// --- What is watched ---------------------------------------------------------------------------------------

Index World::Impl::Equilibrium::place_of(const Watched& one) const {
  const auto found = std::find(watched.begin(), watched.end(), one);
  return found == watched.end() ? -1 : static_cast<Index>(found - watched.begin());
}

Result<void> World::Impl::Equilibrium::watch(const Output& output) {
  const auto note = [&](Watched one) {
    if (place_of(one) < 0) watched.push_back(std::move(one));
  };
  if (output.kind == Output::Kind::gauge) {
    Watched one;
    one.effect = static_cast<Index>(output.effect);
    one.quantity = output.quantity;
    note(one);
  } else if (output.kind == Output::Kind::energy) {
    const auto parts = parts_of_energy(output.quantity);
    const bool moves = std::find(parts.begin(), parts.end(), What::kinetic) != parts.end();
    if (parts.empty())
      return Error{
          "gradients: there is no energy \"" + output.quantity +
          "\"; give \"elastic\", \"gravity\", \"loads\", \"pressures\", \"potential\", \"kinetic\" or "
          "\"total\""};
    if (moves && !w.options.scheme->has_inertia())
      return Error{"gradients: energy \"" + output.quantity +
                   "\": nothing moves in statics; take \"potential\""};
    for (const What what : parts) note(watched_energy(what));
  } else if (output.kind == Output::Kind::stress) {
    if (auto r = watch_stress(output); !r) return r;
    note(watched_stress(output));
  } else if (output.kind == Output::Kind::force) {
    if (auto r = watch_force(output); !r) return r;
    note(watched_force(output));
  }
  return {};
}

Result<void> World::Impl::Equilibrium::watch_stress(const Output& o) {
  if (auto r = check_body(o.body, "a stress"); !r) return r;
  const BodyData& body = w.said.builder.body(o.body);
  const std::string who = "gradients: stress \"" + o.quantity + "\" of body \"" + body.name + "\": ";
  if (!is_stress_measure(o.quantity))
    return Error{who +
                 "there is none of that name; give \"von_mises\", \"pressure\" or one of \"xx\", \"yy\", "
                 "\"zz\", \"xy\", \"yz\", \"zx\""};
  if (body.thin()) return Error{who + "of thin bodies no stress is known"};
  if (o.cell < 0 || o.cell >= body.mesh.cell_count())
    return Error{who + "there is no cell " + std::to_string(o.cell) + ", but 0 to " +
                 std::to_string(body.mesh.cell_count() - 1)};
  return {};
}

// What an effect does is what its own stencils do: rows over those of bodies belong to no effect alone.
Result<void> World::Impl::Equilibrium::watch_force(const Output& o) {
  if (auto r = check_body(o.body, "an effect's force"); !r) return r;
  if (!finite(o.force))
    return Error{"gradients: the direction is " + point_text(o.force) + "; give finite numbers"};
  const auto e = static_cast<Index>(o.effect);
  const std::string who = "gradients: force of effect \"" + w.said.sources[at(e)]->name() + "\": ";
  const Owners& owners = w.said.builder.owners();
  const SystemParts& parts = w.system().parts();
  bool any = false;
  for (std::size_t p = 0; p < owners.stencil_pool.size(); ++p) {
    if (owners.stencil_pool[p] != e) continue;
    any = true;
    if (parts.stencil_pools[p]->facets().dissipative)
      return Error{who + "it dissipates, with forces that depend on where a step begins"};
  }
  for (std::size_t p = 0; p < owners.row_pool.size(); ++p) {
    const RowPool& rows = *parts.row_pools[p];
    const bool shared = std::find(rows.owner.begin(), rows.owner.end(), e) != rows.owner.end();
    if (shared || (owners.row_pool[p] == e && owners.stencil_pool[at(rows.stencil_pool)] != e))
      return Error{who + "its rows share their stencils with others"};
  }
  if (any) return {};
  return Error{who +
               "it acts on no nodes by stencils of its own; take the reaction of a support, or the force "
               "of a contact, a cable, a cavity or springs"};
}

void World::Impl::Equilibrium::take_watched(const Watched& one, OutputSeed& seed) const {
  const Index k = place_of(one);
  seed.held.push_back(k);
  seed.value += here.seen[at(k)];
}

// --- Energies ----------------------------------------------------------------------------------------------

// As the equations were evaluated, for who reads the assembly after somebody else.
void World::Impl::Equilibrium::evaluate_here() {
  const SaddleProblem p = problem();
  w.assembly().set_increment(p.increment, p.memory);
  if (w.system().has_lag()) w.assembly().renew_lag(w.state.x, w.state.lambda, p.prescribed);
  w.assembly().evaluate(Want::gradient, Definiteness::exact, w.state.x, w.state.lambda, p.prescribed);
}

void World::Impl::Equilibrium::seed_energy(const Output& output, OutputSeed& seed) {
  const auto add_force = [&](std::span<const Vec3> force) {
    for (std::size_t i = 0; i < force.size(); ++i) seed.x[i] -= force[i];
  };
  for (const What what : parts_of_energy(output.quantity)) {
    take_watched(watched_energy(what), seed);
    if (what == What::elastic) seed_elastic(seed);
    if (what == What::pressures) seed_pressures(seed);
    if (what == What::loads) add_force(load_forces(w.system().parts(), w.state));
    if (what == What::kinetic) {
      std::vector<Vec3> moving(w.state.v.size());
      w.assembly().mass_times(w.state.v, moving);
      for (std::size_t i = 0; i < moving.size(); ++i) seed.v[i] += moving[i];
    }
    if (what != What::gravity) continue;
    const Vec3 g = w.data->gravity(w.state.t);
    for (std::size_t i = 0; i < seed.x.size(); ++i) seed.x[i] -= w.data->weight()[i] * g;
  }
}

void World::Impl::Equilibrium::seed_elastic(OutputSeed& seed) {
  const System& s = w.system();
  const std::vector<double> none(at(s.rows()), 0.0), none_given(at(s.prescribed_rows()), 0.0);
  const SaddleProblem p = problem();
  // No time passes: what is stored, not what is dissipated.
  w.assembly().set_increment({0, {}, w.state.t, w.state.t}, p.memory);
  w.assembly().evaluate(Want::gradient, Definiteness::exact, w.state.x, none, none_given);
  std::vector<Vec3> force(seed.x.size());
  w.assembly().residual(force);
  for (std::size_t i = 0; i < force.size(); ++i) seed.x[i] += force[i];
  add_compliance(s, 1, w.state.lambda, seed.multiplier);
  seed.energies += 1;
  evaluate_here();
}

// lambda (phi - t) less the law's potential, and multipliers that are given times their functions.
void World::Impl::Equilibrium::seed_pressures(OutputSeed& seed) {
  const System& s = w.system();
  if (s.laws().empty() && s.prescribed_rows() == 0) return;
  std::vector<double> lambda(at(s.rows()), 0.0);
  const std::vector<double> none(lambda), none_given(at(s.prescribed_rows()), 0.0);
  for (const LawPlace& law : s.laws()) {
    const auto first = at(s.first_row(law.row_pool));
    for (std::size_t r = first; r < first + at(s.parts().row_pools[at(law.row_pool)]->rows()); ++r) {
      lambda[r] = w.state.lambda[r];
      seed.multiplier[r] += here.theta[r];
    }
  }
  const SaddleProblem p = problem();
  const std::vector<double> given(p.prescribed.begin(), p.prescribed.end());
  std::vector<Vec3> with(seed.x.size()), without(seed.x.size());
  w.assembly().evaluate(Want::gradient, Definiteness::exact, w.state.x, lambda, given);
  w.assembly().residual(with);
  w.assembly().evaluate(Want::gradient, Definiteness::exact, w.state.x, none, none_given);
  w.assembly().residual(without);
  for (std::size_t i = 0; i < with.size(); ++i) seed.x[i] += with[i] - without[i];
  evaluate_here();
}

// --- Forces of effects -------------------------------------------------------------------------------------

void World::Impl::Equilibrium::seed_force(const Output& o, OutputSeed& seed) {
  take_watched(watched_force(o), seed);
  evaluate_here();
  const BodyData& body = w.said.builder.body(o.body);
  std::vector<Vec3> along(seed.x.size());
  std::fill_n(along.begin() + body.first_node, body.mesh.node_count(), o.force);
  const auto& owner = w.said.builder.owners().stencil_pool;
  for (std::size_t p = 0; p < owner.size(); ++p) {
    if (owner[p] == static_cast<Index>(o.effect)) add_pool_forces(static_cast<Index>(p), along, seed);
  }
}

// Of the forces of one pool on all nodes along a way: minus their gradients.
void World::Impl::Equilibrium::add_pool_forces(Index p, std::span<const Vec3> along, OutputSeed& seed) {
  const System& s = w.system();
  const StencilPool& pool = *s.parts().stencil_pools[at(p)];
  const auto functions = static_cast<std::size_t>(pool.functions());
  const PoolAnswers all(s, w.assembly(), p, Want::hessian, w.state.x);
  std::vector<double> felt(at(pool.stencils()) * functions);
  for (Index i = 0; i < pool.stencils(); ++i) {
    const auto nodes = pool.nodes()[i];
    const std::size_t n = nodes.size(), first = functions * at(pool.nodes().offset[at(i)]);
    for (std::size_t k = 0; k < functions; ++k) {
      for (std::size_t a = 0; a < n; ++a)
        felt[at(i) * functions + k] -= isochor::dot(all.jacobian[first + k * n + a], along[at(nodes[a])]);
    }
    if (all.hessian.empty()) continue;
    auto block = static_cast<std::size_t>(pool.hessian_offset()[at(i)]);
    for (std::size_t a = 0; a < n; ++a) {
      for (std::size_t b = 0; b <= a; ++b, ++block) {
        seed.x[at(nodes[a])] -= all.hessian[block] * along[at(nodes[b])];
        if (a != b) seed.x[at(nodes[b])] -= transposed_times(all.hessian[block], along[at(nodes[a])]);
      }
    }
  }
  add_to_rows(s, p, 0, felt, seed.multiplier);
  // And with what the pool holds on to.
  if (lag) lag->add_transposed(-1, along, seed.x, seed.multiplier, p);
}

// --- Stresses ----------------------------------------------------------------------------------------------

Result<void> World::Impl::Equilibrium::seed_stress(const Output& o, OutputSeed& seed) {
  take_watched(watched_stress(o), seed);
  evaluate_here();
  const BodyData& body = w.said.builder.body(o.body);
  const SystemParts& parts = w.system().parts();
  const Recovery recovery(body, parts, w.assembly(), w.state);
  const CellStress cell(body, parts, o.cell);
  const Stress stress = cell.whole(recovery.in);
  if (o.quantity == "von_mises" && !(seed.value > 0)) {
    return Error{"gradients: stress \"von_mises\" of body \"" + body.name + "\" is 0 in cell " +
                 std::to_string(o.cell) + ", where it has no derivative; take its components"};
  }
  const Stress weights = stress_weights(o.quantity, stress);
  seed.stresses.push_back({static_cast<Index>(o.body), o.cell, weights});
  // By a difference of the fourth order around a cell, small against it.
  const double h = 5e-4 * cell.size();
  std::vector<Vec3> x = w.state.x;
  RecoveryInput in = recovery.in;
  in.x = x;
  for (const Index n : cell.nodes()) {
    for (int c = 0; c < 3; ++c) {
      double sum = 0;
      for (const auto& [step, weight] :
           {std::pair(-2, 1. / 12), std::pair(-1, -8. / 12), std::pair(1, 8. / 12), std::pair(2, -1. / 12)}) {
        x[at(n)][c] = w.state.x[at(n)][c] + step * h;
        sum += weight / h * dot(weights, cell.whole(in));
      }
      x[at(n)] = w.state.x[at(n)];
      seed.x[at(n)][c] += sum;
    }
  }
  add_stress_of_rows(cell, recovery.in, weights[0] + weights[1] + weights[2], seed.multiplier);
  return {};
}

// The pressure of rows is linear in their multipliers.
void World::Impl::Equilibrium::add_stress_of_rows(const CellStress& cell, RecoveryInput in, double weight,
                                                  std::span<double> multiplier) const {
  std::vector<std::span<const double>> all(in.function_multiplier.begin(), in.function_multiplier.end());
  const auto functions = cell.functions(in);
  std::map<Index, std::vector<double>> own;
  for (const auto& f : functions) {
    auto& numbers = own[f.pool];
    numbers.assign(all[at(f.pool)].size(), 0.0);
    all[at(f.pool)] = numbers;
  }
  in.function_multiplier = all;
  for (const auto& f : functions) {
    std::vector<double> felt(at(f.count));
    for (Index k = 0; k < f.count; ++k) {
      double& unit = own[f.pool][at(f.first + k)];
      unit = 1;
      felt[at(k)] = weight * cell.of_rows(in);
      unit = 0;
    }
    add_to_rows(w.system(), f.pool, f.first, felt, multiplier);
  }
}

// Stresses of energies are in proportion to stiffness.
void World::Impl::Equilibrium::add_stress_of(std::span<const double> rate, BodyId id, Equations& change) {
  const BodyData& body = w.said.builder.body(id);
  for (std::size_t k = 0; k < watched.size(); ++k) {
    const Watched& one = watched[k];
    if (one.what != What::stress || one.body != static_cast<Index>(id) || rate[at(one.cell)] == 0) continue;
    evaluate_here();
    const Recovery recovery(body, w.system().parts(), w.assembly(), w.state);
    const CellStress cell(body, w.system().parts(), one.cell);
    change.seen[k] += rate[at(one.cell)] *
                      dot(stress_weights(one.quantity, cell.whole(recovery.in)), cell.of_energy(recovery.in));
  }
}

World::Impl::Equilibrium::StressShares World::Impl::Equilibrium::stress_shares(const OutputSeed& seed,
                                                                               BodyId id) {
  StressShares out;
  const BodyData& body = w.said.builder.body(id);
  const SystemParts& parts = w.system().parts();
  for (const OutputSeed::OfStress& one : seed.stresses) {
    if (one.body != static_cast<Index>(id)) continue;
    evaluate_here();
    const Recovery recovery(body, parts, w.assembly(), w.state);
    const CellStress cell(body, parts, one.cell);
    if (cell.patches().empty()) out.own.emplace_back(one.cell, dot(one.weights, cell.of_energy(recovery.in)));
    for (const PatchOfCell& patch : cell.patches()) {
      const Index p = cell.region().elastic_pool;
      const auto& pool = static_cast<const SolidPool&>(*parts.stencil_pools[at(p)]);
      double F[9], strain = 0;
      pool.deformation_gradient(patch.stencil, 0, w.state.x, parts.rest, F, strain);
      const double volume = pool.data().weight[at(patch.stencil)] * (1 + strain);
      Stress& sum = out.patch[{p, patch.stencil}];
      for (std::size_t k = 0; k < 6; ++k) sum[k] += patch.share / volume * one.weights[k];
    }
  }
  return out;
}

// Forces of a patch times positions are its stress times its volume.
double World::Impl::Equilibrium::StressShares::of(const CellTerms::Stencil& stencil,
                                                  std::span<const Vec3> x) const {
  const auto found = patch.find({stencil.pool, stencil.patch});
  if (stencil.patch < 0 || found == patch.end()) return 0;
  Stress sum{};
  for (std::size_t a = 0; a < stencil.nodes.size(); ++a) {
    const Vec3 &f = stencil.forces[a], &p = x[at(stencil.nodes[a])];
    const Stress part{f.x * p.x, f.y * p.y, f.z * p.z, f.x * p.y, f.y * p.z, f.z * p.x};
    for (std::size_t k = 0; k < 6; ++k) sum[k] += part[k];
  }
  return dot(sum, found->second);
}

}  // namespace isochor
