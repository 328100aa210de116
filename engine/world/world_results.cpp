// What a host reads from a world.
#include <algorithm>
#include <cmath>

#include "engine/world/recovery.h"
#include "engine/world/surface_fields.h"
#include "engine/world/world_impl.h"

namespace isochor {

void World::Impl::evaluate_state(Want want) {
  data->evaluate(system(), state.t);
  assembly().set_increment({0, {}, state.t, state.t}, pool_memory());
  assembly().evaluate(want, Definiteness::exact, state.x, state.lambda, data->prescribed());
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
  const BodyData* b = impl_->find_body(body, "positions");
  if (!b) return {};
  return impl_->scene_made() ? part(*b, impl_->state.x) : std::span<const Vec3>(b->mesh.nodes);
}

std::span<const Vec3> World::velocities(BodyId body) const {
  const BodyData* b = impl_->find_body(body, "velocities");
  if (!b || !impl_->scene_made()) return {};
  return part(*b, impl_->state.v);
}

std::shared_ptr<const void> World::keep_views() const {
  return impl_->views;
}

void World::Impl::leave_views(std::shared_ptr<LeftViews> next) noexcept {
  if (views.use_count() > 1) {
    views->x = std::move(state.x);
    views->v = std::move(state.v);
  }
  views = std::move(next);
}

std::span<const Vec3> World::rest_positions(BodyId body) const {
  return mesh(body).nodes;
}
const Mesh& World::mesh(BodyId body) const {
  static const Mesh none;
  const BodyData* b = impl_->find_body(body, "mesh");
  return b ? b->mesh : none;
}
const std::string& World::body_name(BodyId body) const {
  static const std::string none;
  // Like effect_name(), of what was said last: a name is no reason to compile.
  if (auto known = check(body); !known) {
    if (impl_->options.log) impl_->options.log("body_name: " + known.error());
    return none;
  }
  return impl_->latest().builder.body(body).name;
}
Index World::body_count() const {
  return impl_->latest().builder.body_slots().taken();
}
std::vector<BodyId> World::bodies() const {
  const Builder& builder = impl_->latest().builder;
  std::vector<BodyId> all;
  for (Index b = 0; b < builder.body_slots().size(); ++b) {
    if (builder.body_slots().holds(b))
      all.push_back(WorldNumbers::make<BodyTag>(b, builder.world(), builder.body_slots().generation(b)));
  }
  return all;
}
std::vector<EffectId> World::effects() const {
  const Description& d = impl_->latest();
  std::vector<EffectId> all;
  for (const Index e : d.order)
    all.push_back(WorldNumbers::make<EffectTag>(e, d.builder.world(), d.places.generation(e)));
  return all;
}
const std::string& World::effect_name(EffectId effect) const {
  static const std::string none;
  if (auto r = check(effect); !r) {
    impl_->tell("effect_name: " + r.error());
    return none;
  }
  return impl_->latest().sources[static_cast<std::size_t>(effect)]->name();
}
const std::vector<std::string>& World::warnings() const {
  return impl_->said.builder.warnings();
}

std::vector<double> World::Impl::row_residuals() {
  evaluate_state(Want::value);
  std::vector<double> theta(at(system().rows()));
  assembly().row_values(theta);
  for (std::size_t r = 0; r < theta.size(); ++r) theta[r] -= data->target()[r];
  for (const ComplianceEntry& e : system().compliance()) {
    theta[at(e.row)] -= e.value * state.lambda[at(e.col)];
    if (e.row != e.col) theta[at(e.col)] -= e.value * state.lambda[at(e.row)];
  }
  for (const auto& law : system().laws()) {
    const auto first = at(system().first_row(law.row_pool));
    const auto rows = at(system().parts().row_pools[at(law.row_pool)]->rows());
    std::vector<double> strain(rows);
    system().evaluate_law(law, state.t, state.t, state.extra, state.lambda, strain, {});
    for (std::size_t r = 0; r < rows; ++r) theta[first + r] -= strain[r];
  }
  for (std::size_t r = 0; system().has_bounds() && r < theta.size(); ++r) {
    const double d = system().row_metric()[r], l = state.lambda[r];
    theta[r] = d * (std::clamp(l + theta[r] / d, system().row_lower()[r], system().row_upper()[r]) - l);
  }
  return theta;
}

BodyFields World::fields(BodyId body) const {
  Impl& w = *impl_;
  if (!w.find_body(body, "fields") || !w.ready()) return {};
  w.evaluate_state(Want::gradient);
  const SystemParts& parts = w.system().parts();
  std::vector<std::span<const double>> multipliers;
  for (Index p = 0; p < static_cast<Index>(parts.stencil_pools.size()); ++p) {
    multipliers.push_back(w.assembly().function_multipliers(p));
  }
  std::vector<double> nodal(parts.rest.size(), std::nan(""));
  for (const Index e : w.said.order) w.instances[at(e)]->node_multipliers({w.system(), w.state}, nodal);
  std::vector<std::span<const double>> memory(parts.stencil_pools.size());
  for (const auto& stencils : w.system().facets().remembering)
    memory[at(stencils.pool)] = stencils.in(w.pool_memory());
  BodyFields fields =
      recover_fields({w.said.builder.body(body), parts, w.state.x, multipliers, nodal, memory, w.state.t});
  add_surface_fields(w.instances, {w.system(), w.state}, w.said.builder.body(body), fields);
  return fields;
}

std::vector<Gauge> World::gauges() const {
  std::vector<Gauge> out;
  if (!impl_->ready()) return out;
  for (const Index e : impl_->said.order)
    impl_->instances[at(e)]->gauges({impl_->system(), impl_->state}, out);
  return out;
}

std::array<Vec3, 2> World::reaction(EffectId effect) const {
  std::array<Vec3, 2> sum{};
  Impl& w = *impl_;
  const auto i = static_cast<std::size_t>(effect);
  if (auto r = check(effect); !r) {
    w.tell("reaction: " + r.error());
    return sum;
  }
  if (!w.ready()) return sum;
  if (i >= w.instances.size() || !w.instances[i]) return sum;
  return w.reaction_of(static_cast<Index>(i), w.state);
}

double World::constitutive_residual() const {
  Impl& w = *impl_;
  if (!w.ready()) return 0;
  const std::vector<double> theta = w.row_residuals();
  double worst = 0;
  for (std::size_t r = 0; r < theta.size(); ++r) {
    worst = std::max(worst, std::abs(theta[r]) / w.system().row_measure()[r]);
  }
  return worst;
}

WorldSize World::size() const {
  WorldSize s;
  Impl& w = *impl_;
  if (!w.ready()) return s;
  s.nodes = w.system().nodes();
  s.displacement_unknowns = w.system().free_unknowns();
  s.multipliers = w.system().rows();
  s.matrix_size = w.system().kkt().size;
  s.matrix_nonzeros = w.system().kkt().nonzeros();
  s.factor_nonzeros = w.methods.chosen().factor_nonzeros();
  s.engine_bytes = w.assembly().memory_bytes();
  s.table_bytes = w.system().table_bytes();
  return s;
}

}  // namespace isochor
