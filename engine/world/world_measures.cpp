// What a host asks about bodies and the scene as a whole: volumes, momentum, energies, how faces have turned.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "engine/world/equations.h"
#include "engine/world/recovery.h"
#include "engine/world/world_impl.h"

namespace isochor {

std::vector<Vec3> World::Impl::momenta() {
  std::vector<Vec3> out(state.v.size());
  assembly().mass_times(state.v, out);
  return out;
}

BodyMeasures World::measures(BodyId body) const {
  Impl& w = *impl_;
  if (!w.find_body(body, "measures") || !w.ready()) return {};
  const BodyData& b = w.said.builder.body(body);
  BodyMeasures m = measure_body(b, w.system().parts(), w.state.x);
  m.name = b.name;
  const std::vector<Vec3> moving = w.momenta();
  for (Index i = b.first_node; i < b.first_node + b.mesh.node_count(); ++i) {
    m.mass += w.system().parts().mass[at(i)];
    m.linear_momentum += moving[at(i)];
    m.angular_momentum += cross(w.state.x[at(i)], moving[at(i)]);
    m.center_of_mass += w.system().parts().mass[at(i)] * w.state.x[at(i)];
  }
  m.center_of_mass = (1 / m.mass) * m.center_of_mass;
  // What the rows of the body leave over, summed: the nodal rows of a region add up to its volume change less
  // what their compliance grants. A body with one-field elements grants itself whatever it does.
  const std::vector<double> theta = w.row_residuals();
  const auto& pools = w.system().parts().row_pools;
  for (std::size_t p = 0; p < pools.size(); ++p) {
    const bool of_body = pools[p]->law == RowLaw::compliant &&
                         std::any_of(b.regions.begin(), b.regions.end(), [&](const RegionData& r) {
                           return r.has_volume_pool(pools[p]->stencil_pool);
                         });
    const bool spanning = pools[p]->law == RowLaw::compliant &&
                          std::any_of(b.spanning.begin(), b.spanning.end(), [&](const SpanningVolume& v) {
                            return v.pool == pools[p]->stencil_pool;
                          });
    if (!of_body && !spanning) continue;
    const auto first = at(w.system().first_row(static_cast<Index>(p)));
    double sum = 0, volume = 0;
    for (std::size_t r = 0; r < at(pools[p]->rows()); ++r) {
      sum += theta[first + r];
      volume += pools[p]->measure[r];
    }
    m.volume_row_residual = std::max(m.volume_row_residual, std::abs(sum) / volume);
  }
  m.volume_error = m.volume_row_residual;
  return m;
}

double World::elastic_energy() const {
  Impl& w = *impl_;
  if (!w.ready()) return 0;
  w.evaluate_state(Want::value);
  double energy = w.assembly().energy();
  for (const ComplianceEntry& e : w.system().compliance()) {
    const double product = e.value * w.state.lambda[at(e.row)] * w.state.lambda[at(e.col)];
    energy += e.row == e.col ? 0.5 * product : product;
  }
  return energy;
}

double World::kinetic_energy() const {
  double energy = 0;
  if (!impl_->scene_made() || !impl_->ready()) return energy;
  const std::vector<Vec3> moving = impl_->momenta();
  for (std::size_t i = 0; i < moving.size(); ++i) energy += 0.5 * dot(moving[i], impl_->state.v[i]);
  return energy;
}

Energies World::energies() const {
  Energies e;
  Impl& w = *impl_;
  if (!w.ready()) return e;
  const SystemParts& parts = w.system().parts();
  w.evaluate_state(Want::gradient);
  e.pressures = pressure_energy({w.system(), w.assembly(), *w.data, w.instances, w.said.builder}, w.state);
  e.elastic = elastic_energy();
  e.kinetic = kinetic_energy();
  std::vector<Vec3> force = load_forces(parts, w.state);
  e.loads = 0 - work_on(force, w.state.x, parts.rest);
  const Vec3 g = w.data->gravity(w.state.t);
  for (std::size_t i = 0; i < force.size(); ++i) force[i] = w.data->weight()[i] * g;
  e.gravity = 0 - work_on(force, w.state.x, parts.rest);
  return e;
}

std::array<Vec3, 2> World::momentum() const {
  std::array<Vec3, 2> sum{};
  if (!impl_->scene_made() || !impl_->ready()) return sum;
  const std::vector<Vec3> moving = impl_->momenta();
  for (std::size_t i = 0; i < moving.size(); ++i) {
    sum[0] += moving[i];
    sum[1] += cross(impl_->state.x[i], moving[i]);
  }
  return sum;
}

}  // namespace isochor
