#include <algorithm>
#include <cmath>

#include "scenes/run/run.h"

namespace isochor {

namespace {

template <class T>
std::size_t place_of(const std::vector<T>& items, const std::string& name) {
  const auto it = std::find_if(items.begin(), items.end(), [&](const T& t) { return t.name == name; });
  return static_cast<std::size_t>(it - items.begin());
}

double component(const Vec3& v, Component c) {
  if (c == Component::magnitude) return std::sqrt(dot(v, v));
  return v[static_cast<int>(c) - static_cast<int>(Component::x)];
}

double gauge(const StepRecord& r, const std::string& effect, const char* quantity) {
  const auto it = std::find_if(r.gauges.begin(), r.gauges.end(),
                               [&](const Gauge& g) { return g.effect == effect && g.quantity == quantity; });
  return it == r.gauges.end() ? std::nan("") : it->value;
}

double turned(const StepRecord& r, const MetricDef& m, const std::string& what) {
  const auto of = [&](const char* axis) { return gauge(r, m.of, (what + axis).c_str()); };
  return component({of("_x"), of("_y"), of("_z")}, m.component);
}

// Of the whole scene where nothing is named.
const VolumeMeasures& part(const StepRecord& r, const std::string& name) {
  return name.empty() ? r.total : r.parts[place_of(r.parts, name)];
}

std::array<Vec3, 2> momentum(const SceneDef& scene, const StepRecord& r, const std::string& body) {
  return body.empty() ? r.momentum : r.momenta[place_of(scene.bodies, body)];
}

double quantity(const SceneDef& scene, const MetricDef& m, const std::vector<StepRecord>& records,
                const StepRecord& r) {
  switch (m.quantity) {
    case Quantity::displacement:
      if (place_of(scene.probes, m.of) == scene.probes.size()) return turned(r, m, "displacement");
      return component(r.probes[place_of(scene.probes, m.of)], m.component);
    case Quantity::cavity_pressure:
      return r.cavities[place_of(scene.cavities, m.of)].pressure;
    case Quantity::cavity_volume:
      return r.cavities[place_of(scene.cavities, m.of)].volume;
    case Quantity::cable_tension:
      return gauge(r, m.of, "tension");
    case Quantity::cable_length:
      return gauge(r, m.of, "length");
    case Quantity::rigid_x:
      return gauge(r, m.of, "x");
    case Quantity::rigid_y:
      return gauge(r, m.of, "y");
    case Quantity::rigid_z:
      return gauge(r, m.of, "z");
    case Quantity::contact_force:
      return component({gauge(r, m.of, "force_x"), gauge(r, m.of, "force_y"), gauge(r, m.of, "force_z")},
                       m.component);
    case Quantity::contact_area:
      return gauge(r, m.of, "contact_area");
    case Quantity::contact_pressure:
      return gauge(r, m.of, "largest_pressure");
    case Quantity::contact_gap:
      return gauge(r, m.of, "smallest_gap");
    case Quantity::reaction_force:
      return component(r.reactions[place_of(scene.dirichlet, m.of)].force, m.component);
    case Quantity::reaction_moment:
      return component(r.reactions[place_of(scene.dirichlet, m.of)].moment, m.component);
    case Quantity::orientation_angle:
      return gauge(r, m.of, "angle");
    case Quantity::orientation_axis:
      return turned(r, m, "axis");
    case Quantity::orientation_normal:
      return turned(r, m, "normal");
    case Quantity::volume_row_residual:
      return r.volume_row_residual;
    case Quantity::volume_change:
      return part(r, m.of).volume_change();
    case Quantity::volume:
      return part(r, m.of).volume;
    case Quantity::constitutive_residual:
      return r.constitutive_residual;
    case Quantity::min_J:
      return part(r, m.of).min_J;
    case Quantity::max_J:
      return part(r, m.of).max_J;
    case Quantity::elastic_energy:
      return r.energy.elastic;
    case Quantity::kinetic_energy:
      return r.energy.kinetic;
    case Quantity::gravity_potential:
      return r.energy.gravity;
    case Quantity::load_potential:
      return r.load_potential();
    case Quantity::potential_energy:
      return r.potential_energy();
    case Quantity::total_energy:
      return r.total_energy();
    case Quantity::linear_momentum:
      return component(momentum(scene, r, m.of)[0], m.component);
    case Quantity::angular_momentum:
      return component(momentum(scene, r, m.of)[1], m.component);
    case Quantity::newton_iterations:
      break;
  }
  int sum = 0;
  for (const StepRecord& s : records) sum += s.step <= r.step ? s.work.iterations : 0;
  return sum;
}

}  // namespace

std::vector<MetricValue> evaluate_metrics(const SceneDef& scene, const std::vector<StepRecord>& records) {
  std::vector<MetricValue> out;
  if (records.empty()) return out;
  const StepPlan plan = plan_steps(scene.analysis);
  for (const MetricDef& m : scene.metrics) {
    MetricValue v{m, std::nan(""), true, {}, {}};
    const int step = m.time ? static_cast<int>(std::lround(*m.time / plan.h)) : plan.steps;
    const auto it = std::find_if(records.begin(), records.end(), [&](const StepRecord& r) {
      return r.step == step && std::abs(r.time - step * plan.h) <= 1e-6 * plan.h;
    });
    v.reached = it != records.end();
    // A number of the end is shown as far as the run got, but not held against its reference.
    if (v.reached || !m.time)
      v.value = m.scale * quantity(scene, m, records, v.reached ? *it : records.back());
    if (v.reached && m.reference) {
      const double difference = v.value - *m.reference;
      v.error = *m.reference == 0 ? difference : difference / std::abs(*m.reference);
      if (m.tolerance) v.within = std::abs(*v.error) <= *m.tolerance;
    }
    out.push_back(std::move(v));
  }
  return out;
}

}  // namespace isochor
