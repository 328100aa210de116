#include "engine/world/equations.h"

#include "engine/solve/evaluator.h"
#include "engine/world/memory_terms.h"

namespace isochor {

namespace {

template <class T>
void add_to(std::vector<T>& sum, double factor, const std::vector<T>& other) {
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += factor * other[i];
}

}  // namespace

Equations::Equations(const System& s, std::size_t watched)
    : force(at(s.nodes())),
      theta(at(s.rows())),
      position(s.free_bases().size()),
      seen(watched),
      kept(MemoryTerms::numbers(s)) {}

void Equations::add(double factor, const Equations& other) {
  add_to(force, factor, other.force);
  add_to(theta, factor, other.theta);
  add_to(position, factor, other.position);
  add_to(seen, factor, other.seen);
  add_to(kept, factor, other.kept);
}

Equations equations_at(const EquationsAt& where, const State& state, std::span<const Watched> watched) {
  const System& s = where.system;
  SaddleProblem p = where.data.problem(s, state, state.t);
  if (where.inertia) where.inertia->add_to(p);
  Assembly& assembly = where.assembly;
  assembly.set_increment(p.increment, p.memory);
  if (s.has_lag()) assembly.renew_lag(state.x, state.lambda, p.prescribed);
  assembly.evaluate(Want::gradient, Definiteness::exact, state.x, state.lambda, p.prescribed);
  Equations out(s);
  assembly.residual(out.force);
  for (std::size_t i = 0; i < out.force.size(); ++i) out.force[i] -= p.force[i];
  if (p.mass_scale > 0) {
    std::vector<Vec3> off(out.force.size()), pull(off.size());
    for (std::size_t i = 0; i < off.size(); ++i) off[i] = state.x[i] - p.predicted[i];
    assembly.mass_times(off, pull);
    for (std::size_t i = 0; i < off.size(); ++i) out.force[i] += p.mass_scale * pull[i];
  }
  assembly.row_values(out.theta);
  for (std::size_t r = 0; r < out.theta.size(); ++r) out.theta[r] -= p.target[r];
  add_compliance(s, -1, state.lambda, out.theta);
  for (const LawPlace& law : s.laws()) {
    const auto first = at(s.first_row(law.row_pool));
    std::vector<double> strain(at(s.parts().row_pools[at(law.row_pool)]->rows()));
    s.evaluate_law(law, p.increment.t0, p.increment.t1, p.memory, state.lambda, strain, {});
    for (std::size_t r = 0; r < strain.size(); ++r) out.theta[first + r] -= strain[r];
  }
  out.position.assign(p.position.begin(), p.position.end());
  out.kept = MemoryTerms::kept(s, assembly, state.x, p.memory);
  for (const Watched& one : watched) out.seen.push_back(watched_value(where, state, one));
  return out;
}

Result<Equations> World::Impl::equations_beside(Description next, std::span<const Watched> watched,
                                                const Inertia* inertia) {
  auto built = build_beside(next);
  if (!built) return built.failure();
  SystemParts& parts = built.value().parts;
  parts.treatment = system().parts().treatment;
  parts.border_wide_rows = system().parts().border_wide_rows;
  const std::vector<double> weight = gravity_mass(next.builder, parts, options);
  auto compiled = System::compile(std::move(parts), &system());
  if (!compiled) return compiled.failure();
  const std::shared_ptr<const System> changed = std::move(compiled).value();
  if (changed->nodes() != system().nodes() || changed->rows() != system().rows() ||
      changed->prescribed_rows() != system().prescribed_rows() ||
      changed->free_bases().size() != system().free_bases().size() ||
      changed->memory() != system().memory() ||
      MemoryTerms::numbers(*changed) != MemoryTerms::numbers(system()))
    return Error{"the scene has other unknowns, rows or memory then, so that there is no derivative"};
  IncrementData its_data(*changed, amounts.gravity, state, weight);
  Assembly its_assembly(changed, *parallel);
  return equations_at({*changed, its_assembly, its_data, built.value().instances, next.builder, inertia},
                      state, watched);
}

}  // namespace isochor
