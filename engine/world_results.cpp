// What a host reads from a world.
#include <algorithm>
#include <cmath>
#include <cstring>

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

std::uint64_t World::state_hash() const {
  return impl_->state.hash();
}

namespace {

constexpr std::uint64_t kSaveMagic = 0x31726f68636f7369ull;  // "isochor1"

template <class T>
void put(std::vector<std::byte>& out, const T* data, std::size_t count) {
  const auto* p = reinterpret_cast<const std::byte*>(data);
  out.insert(out.end(), p, p + count * sizeof(T));
}

template <class T>
bool take(std::span<const std::byte>& in, T* data, std::size_t count) {
  if (in.size() < count * sizeof(T)) return false;
  if (count > 0) std::memcpy(data, in.data(), count * sizeof(T));  // of nothing there is no address
  in = in.subspan(count * sizeof(T));
  return true;
}

}  // namespace

std::vector<std::byte> World::save() const {
  std::vector<std::byte> out;
  Impl& w = *impl_;
  if (!w.compile()) return out;
  std::vector<double> amounts;
  w.save_amounts(amounts);
  const std::uint64_t sizes[5] = {w.state.x.size(), w.state.lambda.size(), w.state.extra.size(),
                                  amounts.size(), w.reactions.size()};
  put(out, &kSaveMagic, 1);
  put(out, &w.state.layout, 1);
  put(out, sizes, 5);
  put(out, &w.state.t, 1);
  put(out, w.state.x.data(), w.state.x.size());
  put(out, w.state.v.data(), w.state.v.size());
  put(out, w.state.lambda.data(), w.state.lambda.size());
  put(out, w.state.extra.data(), w.state.extra.size());
  put(out, amounts.data(), amounts.size());
  put(out, w.reactions.data(), w.reactions.size());
  return out;
}

Result<void> World::load(std::span<const std::byte> bytes) {
  Impl& w = *impl_;
  if (auto r = w.compile(); !r) return r;
  std::uint64_t magic = 0, layout = 0, sizes[5] = {};
  if (!take(bytes, &magic, 1) || magic != kSaveMagic) {
    return Error{"load: these bytes are no saved state of a world (wrong first eight bytes)"};
  }
  if (!take(bytes, &layout, 1) || layout != w.state.layout) {
    return Error{
        "load: the state was saved from another scene or mesh; load it into a world built the same way"};
  }
  if (!take(bytes, sizes, 5) || sizes[0] != w.state.x.size() || sizes[1] != w.state.lambda.size() ||
      sizes[3] > bytes.size() || sizes[2] != w.state.extra.size() || sizes[4] != w.reactions.size()) {
    return Error{"load: the saved state is damaged (sizes do not fit this scene)"};
  }
  // Read everything before anything is replaced.
  State next;
  next.layout = layout;
  next.x.resize(sizes[0]);
  next.v.resize(sizes[0]);
  next.lambda.resize(sizes[1]);
  next.extra.resize(sizes[2]);
  std::vector<double> amounts(sizes[3]);
  std::vector<Vec3> reactions(sizes[4]);
  if (!take(bytes, &next.t, 1) || !take(bytes, next.x.data(), sizes[0]) ||
      !take(bytes, next.v.data(), sizes[0]) || !take(bytes, next.lambda.data(), sizes[1]) ||
      !take(bytes, next.extra.data(), sizes[2]) || !take(bytes, amounts.data(), sizes[3]) ||
      !take(bytes, reactions.data(), sizes[4]) || !bytes.empty()) {
    return Error{"load: the saved state is truncated or too long"};
  }
  std::size_t with_amount = 0;
  for (const auto& instance : w.instances) with_amount += instance->amount() ? 1 : 0;
  if (amounts.size() != 7 * with_amount) return Error{"load: the saved state belongs to other effects"};
  w.load_amounts(amounts);
  w.state = std::move(next);
  w.settled.reset();
  w.reactions = std::move(reactions);
  if (const auto around = w.look_around(w.state.x, false); !around.error.empty()) return Error{around.error};
  return {};
}

}  // namespace isochor
