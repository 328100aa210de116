#include "engine/world/watched.h"

#include <cmath>
#include <limits>

#include "engine/solve/evaluator.h"
#include "engine/world/cell_stress.h"
#include "engine/world/equations.h"

namespace isochor {

namespace {

constexpr std::array<const char*, 6> kComponents{"xx", "yy", "zz", "xy", "yz", "zx"};

// Index of a component; 6: none.
std::size_t component(const std::string& name) {
  std::size_t k = 0;
  while (k < kComponents.size() && name != kComponents[k]) ++k;
  return k;
}

Stress deviator(const Stress& s) {
  const double mean = (s[0] + s[1] + s[2]) / 3;
  return {s[0] - mean, s[1] - mean, s[2] - mean, s[3], s[4], s[5]};
}

double gravity_energy(const EquationsAt& where, const State& state) {
  const Vec3 g = where.data.gravity(state.t);
  std::vector<Vec3> force(state.x.size());
  for (std::size_t i = 0; i < force.size(); ++i) force[i] = where.data.weight()[i] * g;
  return 0 - work_on(force, state.x, where.system.parts().rest);
}

// Of stencils alone: no time passes, so that nothing dissipates.
double elastic_energy(const EquationsAt& where, const State& state) {
  Assembly& assembly = where.assembly;
  if (where.inertia && !where.system.facets().dissipative.empty()) {
    assembly.set_increment({0, {}, state.t, state.t}, {});
    assembly.evaluate(Want::value, Definiteness::exact, state.x, state.lambda, where.data.prescribed());
    assembly.set_increment(where.inertia->increment, {});
  }
  return assembly.energy() + compliance_energy(where.system, state.lambda);
}

// Energy of the rows with a law of their own, the gas in chambers: multiplier times strain less the law's
// potential. The strain is that of the positions: the multipliers of some schemes belong to other times, and
// an error of theirs counts by its square then.
double law_energy(const EquationsAt& where, const State& state) {
  const System& system = where.system;
  if (system.laws().empty()) return 0;
  std::vector<double> phi(at(system.rows()));
  where.assembly.row_values(phi);
  double energy = 0;
  for (const auto& law : system.laws()) {
    const auto first = at(system.first_row(law.row_pool));
    const auto rows = at(system.parts().row_pools[at(law.row_pool)]->rows());
    std::vector<double> strain(rows);
    energy -= system.evaluate_law(law, state.t, state.t, state.extra, state.lambda, strain, {});
    for (std::size_t r = first; r < first + rows; ++r)
      energy += state.lambda[r] * (phi[r] - where.data.target()[r]);
  }
  return energy;
}

double given_energy(const EquationsAt& where, const State& state, std::span<const double> phi) {
  std::vector<double> rest_phi(phi.size());
  where.assembly.evaluate(Want::value, Definiteness::exact, where.system.parts().rest, state.lambda,
                          where.data.prescribed());
  where.assembly.prescribed_row_values(rest_phi);
  double energy = 0;
  for (std::size_t r = 0; r < phi.size(); ++r) energy += where.data.prescribed()[r] * (phi[r] - rest_phi[r]);
  return energy;
}

double effect_force(const EquationsAt& where, const State& state, const Watched& watched) {
  const BodyData& body = where.builder.bodies()[at(watched.body)];
  const auto& owner = where.builder.owners().stencil_pool;
  double sum = 0;
  for (std::size_t p = 0; p < owner.size(); ++p) {
    if (owner[p] != watched.effect) continue;
    const auto pool = static_cast<Index>(p);
    const PoolAnswers all(where.system, where.assembly, pool, Want::gradient, state.x);
    const auto& nodes = where.system.parts().stencil_pools[p]->nodes().item;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (nodes[i] >= body.first_node && nodes[i] < body.first_node + body.mesh.node_count())
        sum -= dot(watched.direction, all.gradient[i]);
    }
  }
  return sum;
}

double stress_value(const EquationsAt& where, const State& state, const Watched& watched) {
  const BodyData& body = where.builder.bodies()[at(watched.body)];
  const Recovery recovery(body, where.system.parts(), where.assembly, state);
  return stress_measure(watched.quantity,
                        CellStress(body, where.system.parts(), watched.cell).whole(recovery.in));
}

}  // namespace

bool is_stress_measure(const std::string& name) {
  return name == "von_mises" || name == "pressure" || component(name) < 6;
}

double stress_measure(const std::string& name, const Stress& s) {
  if (name == "pressure") return (s[0] + s[1] + s[2]) / 3;
  if (name != "von_mises") return s[component(name)];
  const Stress d = deviator(s);
  double square = 0;
  for (std::size_t k = 0; k < 6; ++k) square += (k < 3 ? 1 : 2) * d[k] * d[k];
  return std::sqrt(1.5 * square);
}

Stress stress_weights(const std::string& name, const Stress& s) {
  Stress out{};
  if (name == "pressure") {
    out = {1. / 3, 1. / 3, 1. / 3, 0, 0, 0};
  } else if (name == "von_mises") {
    const Stress d = deviator(s);
    const double size = stress_measure(name, s);
    for (std::size_t k = 0; k < 6; ++k) out[k] = (k < 3 ? 1.5 : 3) * d[k] / size;
  } else {
    out[component(name)] = 1;
  }
  return out;
}

double gauge_value(const EffectInstance& effect, const std::string& quantity, const System& system,
                   const State& state) {
  std::vector<Gauge> all;
  effect.gauges({system, state}, all);
  for (const Gauge& g : all) {
    if (g.quantity == quantity) return g.value;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

double watched_value(const EquationsAt& where, const State& state, const Watched& watched) {
  switch (watched.what) {
    case Watched::What::gauge:
      return gauge_value(*where.instances[at(watched.effect)], watched.quantity, where.system, state);
    case Watched::What::stress:
      return stress_value(where, state, watched);
    case Watched::What::force:
      return effect_force(where, state, watched);
    case Watched::What::elastic:
      return elastic_energy(where, state);
    case Watched::What::gravity:
      return gravity_energy(where, state);
    case Watched::What::loads:
      return 0 - work_on(load_forces(where.system.parts(), state), state.x, where.system.parts().rest);
    case Watched::What::pressures:
      return pressure_energy(where, state);
    case Watched::What::kinetic: {
      std::vector<Vec3> moving(state.v.size());
      where.assembly.mass_times(state.v, moving);
      double sum = 0;
      for (std::size_t i = 0; i < moving.size(); ++i) sum += 0.5 * dot(moving[i], state.v[i]);
      return sum;
    }
  }
  return 0;
}

Recovery::Recovery(const BodyData& body, const SystemParts& parts, const Assembly& assembly,
                   const State& state)
    : in{body, parts, state.x, multipliers, nodal, {}, state.t} {
  for (Index p = 0; p < static_cast<Index>(parts.stencil_pools.size()); ++p)
    multipliers.push_back(assembly.function_multipliers(p));
  in.function_multiplier = multipliers;
}

PoolAnswers::PoolAnswers(const System& system, const Assembly& assembly, Index pool, Want want,
                         std::span<const Vec3> x) {
  const StencilPool& stencils = *system.parts().stencil_pools[at(pool)];
  const auto functions = static_cast<std::size_t>(stencils.functions());
  energy.resize(at(stencils.stencils()));
  value.resize(energy.size() * functions);
  gradient.resize(stencils.nodes().item.size());
  jacobian.resize(gradient.size() * functions);
  if (want == Want::hessian && stencils.has_hessian())
    hessian.resize(static_cast<std::size_t>(stencils.hessian_offset().back()));
  StencilSlots slots;
  slots.energy = energy;
  slots.value = value;
  slots.gradient = gradient;
  slots.jacobian = jacobian;
  slots.hessian = hessian;
  stencils.evaluate(assembly.request(pool, want, x), slots);
}

std::vector<Vec3> load_forces(const SystemParts& parts, const State& state) {
  std::vector<Vec3> force(state.x.size());
  for (const auto& load : parts.loads) load->add(state.t, force);
  for (std::size_t i = 0; i < state.forces.size(); ++i) force[i] += state.forces[i];
  return force;
}

double work_on(std::span<const Vec3> force, std::span<const Vec3> x, std::span<const Vec3> rest) {
  double sum = 0;
  for (std::size_t i = 0; i < force.size(); ++i) sum += dot(force[i], x[i] - rest[i]);
  return sum;
}

double pressure_energy(const EquationsAt& where, const State& state) {
  const double of_laws = law_energy(where, state);
  if (where.system.prescribed_rows() == 0) return of_laws;
  std::vector<double> phi(where.data.prescribed().size());
  where.assembly.prescribed_row_values(phi);
  const double given = given_energy(where, state, phi);
  // Others read the same evaluation.
  where.assembly.evaluate(Want::gradient, Definiteness::exact, state.x, state.lambda,
                          where.data.prescribed());
  return given + of_laws;
}

}  // namespace isochor
