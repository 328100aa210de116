// What a host reads from a world.
#include <algorithm>
#include <cmath>

#include "engine/recovery.h"
#include "engine/surface_fields.h"
#include "engine/world_impl.h"

namespace isochor {

void World::Impl::evaluate_state(Want want) {
  evaluate_data(state.t);
  newton->assembly().set_increment({0, {}, state.t, state.t},
                                   std::span<const double>(state.extra).first(at(system->memory())));
  newton->assembly().evaluate(want, Definiteness::exact, state.x, state.lambda, prescribed);
}

double World::time() const {
  return impl_->state.t;
}

namespace {

std::span<const Vec3> part(const BodyData& body, const std::vector<Vec3>& all) {
  return {all.data() + body.first_node, at(body.mesh.node_count())};
}

}  // namespace

std::span<const Vec3> World::positions(BodyId body) const {
  const BodyData& b = impl_->builder.body(body);
  return impl_->compiled() ? part(b, impl_->state.x) : std::span<const Vec3>(b.mesh.nodes);
}

std::span<const Vec3> World::velocities(BodyId body) const {
  if (!impl_->compiled()) return {};
  return part(impl_->builder.body(body), impl_->state.v);
}

std::span<const Vec3> World::rest_positions(BodyId body) const {
  return impl_->builder.body(body).mesh.nodes;
}
const Mesh& World::mesh(BodyId body) const {
  return impl_->builder.body(body).mesh;
}
const std::string& World::body_name(BodyId body) const {
  return impl_->builder.body(body).name;
}
Index World::body_count() const {
  return impl_->builder.body_count();
}
const std::vector<std::string>& World::warnings() const {
  return impl_->builder.warnings();
}

BodyMeasures World::measures(BodyId body) const {
  Impl& w = *impl_;
  if (!w.compile()) return {};
  const BodyData& b = w.builder.body(body);
  BodyMeasures m = measure_body(b, w.system->parts(), w.state.x);
  double mass = 0;
  for (Index i = b.first_node; i < b.first_node + b.mesh.node_count(); ++i) {
    mass += w.system->parts().mass[at(i)];
    m.center_of_mass += w.system->parts().mass[at(i)] * w.state.x[at(i)];
  }
  m.center_of_mass = (1 / mass) * m.center_of_mass;
  // What the rows of the body leave over, summed: the nodal rows of a region add up to its volume change less
  // what their compliance grants. A body with one-field elements grants itself whatever it does.
  const std::vector<double> theta = w.row_residuals();
  const auto& pools = w.system->parts().row_pools;
  for (std::size_t p = 0; p < pools.size(); ++p) {
    const bool of_body =
        pools[p]->law == RowLaw::compliant &&
        std::any_of(b.regions.begin(), b.regions.end(), [&](const RegionData& r) {
          return r.volume_pool[0] == pools[p]->stencil_pool || r.volume_pool[1] == pools[p]->stencil_pool;
        });
    const bool spanning = pools[p]->law == RowLaw::compliant &&
                          std::any_of(b.spanning.begin(), b.spanning.end(), [&](const SpanningVolume& v) {
                            return v.pool == pools[p]->stencil_pool;
                          });
    if (!of_body && !spanning) continue;
    const auto first = at(w.system->first_row(static_cast<Index>(p)));
    double sum = 0, volume = 0;
    for (std::size_t r = 0; r < at(pools[p]->rows()); ++r) {
      sum += theta[first + r];
      volume += pools[p]->measure[r];
    }
    m.volume_error = std::max(m.volume_error, std::abs(sum) / volume);
  }
  return m;
}

std::vector<double> World::Impl::row_residuals() {
  evaluate_state(Want::value);
  std::vector<double> theta(at(system->rows()));
  newton->assembly().row_values(theta);
  for (std::size_t r = 0; r < theta.size(); ++r) theta[r] -= target[r];
  for (const ComplianceEntry& e : system->compliance()) {
    theta[at(e.row)] -= e.value * state.lambda[at(e.col)];
    if (e.row != e.col) theta[at(e.col)] -= e.value * state.lambda[at(e.row)];
  }
  for (const auto& law : system->laws()) {
    const RowPool& pool = *system->parts().row_pools[at(law.row_pool)];
    const auto first = at(system->first_row(law.row_pool)), rows = at(pool.rows());
    std::vector<double> strain(rows);
    const auto memory =
        std::span<const double>(state.extra)
            .subspan(at(system->first_memory(law.row_pool)), static_cast<std::size_t>(pool.memory()));
    pool.evaluate_law({state.t, state.t, memory}, std::span<const double>(state.lambda).subspan(first, rows),
                      strain, {});
    for (std::size_t r = 0; r < rows; ++r) theta[first + r] -= strain[r];
  }
  for (std::size_t r = 0; system->has_bounds() && r < theta.size(); ++r) {
    const double d = system->row_metric()[r], l = state.lambda[r];
    theta[r] = d * (std::clamp(l + theta[r] / d, system->row_lower()[r], system->row_upper()[r]) - l);
  }
  return theta;
}

BodyFields World::fields(BodyId body) const {
  Impl& w = *impl_;
  if (!w.compile()) return {};
  w.evaluate_state(Want::gradient);
  const SystemParts& parts = w.system->parts();
  std::vector<std::span<const double>> multipliers;
  for (Index p = 0; p < static_cast<Index>(parts.stencil_pools.size()); ++p) {
    multipliers.push_back(w.newton->assembly().function_multipliers(p));
  }
  std::vector<double> nodal(parts.rest.size(), std::nan(""));
  for (const auto& instance : w.instances) instance->node_multipliers({*w.system, w.state}, nodal);
  BodyFields fields = recover_fields({w.builder.body(body), parts, w.state.x, multipliers, nodal});
  add_surface_fields(w.instances, {*w.system, w.state}, w.builder.body(body), fields);
  return fields;
}

std::vector<Gauge> World::gauges() const {
  std::vector<Gauge> out;
  if (!impl_->compile()) return out;
  for (const auto& instance : impl_->instances) instance->gauges({*impl_->system, impl_->state}, out);
  return out;
}

std::array<Vec3, 2> World::reaction(EffectId effect) const {
  std::array<Vec3, 2> sum{};
  Impl& w = *impl_;
  const auto i = static_cast<std::size_t>(effect);
  if (!w.compile() || i >= w.held_by.size()) return sum;
  for (const HeldDirection& h : w.held_by[i]) {
    const Vec3 f = dot(h.direction, w.reactions[at(h.node)]) * h.direction;
    sum[0] += f;
    sum[1] += cross(w.state.x[at(h.node)], f);
  }
  return sum;
}

double World::elastic_energy() const {
  Impl& w = *impl_;
  if (!w.compile()) return 0;
  w.evaluate_state(Want::value);
  double energy = w.newton->assembly().energy();
  for (const ComplianceEntry& e : w.system->compliance()) {
    const double product = e.value * w.state.lambda[at(e.row)] * w.state.lambda[at(e.col)];
    energy += e.row == e.col ? 0.5 * product : product;
  }
  return energy;
}

double World::kinetic_energy() const {
  double energy = 0;
  if (!impl_->compiled()) return energy;
  const auto& v = impl_->state.v;
  std::vector<Vec3> momentum(v.size());
  impl_->newton->assembly().mass_times(v, momentum);
  for (std::size_t i = 0; i < v.size(); ++i) energy += 0.5 * dot(momentum[i], v[i]);
  return energy;
}

double World::constitutive_residual() const {
  Impl& w = *impl_;
  if (!w.compile()) return 0;
  const std::vector<double> theta = w.row_residuals();
  double worst = 0;
  for (std::size_t r = 0; r < theta.size(); ++r) {
    worst = std::max(worst, std::abs(theta[r]) / w.system->row_measure()[r]);
  }
  return worst;
}

WorldSize World::size() const {
  WorldSize s;
  Impl& w = *impl_;
  if (!w.compile()) return s;
  s.nodes = w.system->nodes();
  s.displacement_unknowns = w.system->free_unknowns();
  s.multipliers = w.system->rows();
  s.matrix_size = w.system->kkt().size;
  s.matrix_nonzeros = w.system->kkt().nonzeros();
  s.factor_nonzeros = w.newton->factor_nonzeros();
  s.engine_bytes = w.newton->assembly().memory_bytes();
  return s;
}

}  // namespace isochor
