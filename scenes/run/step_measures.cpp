#include "scenes/run/step_measures.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace isochor {

namespace {

void add_parts(const BodyMeasures& body, std::vector<VolumeMeasures>& parts) {
  parts.push_back(body);
  if (body.regions.size() < 2) return;
  for (VolumeMeasures region : body.regions) {
    region.name = body.name + "." + region.name;
    parts.push_back(std::move(region));
  }
}

void add_orientation(const std::string& name, const Result<Orientation>& found, std::vector<Gauge>& gauges) {
  constexpr double kDegrees = 180 / std::numbers::pi;
  const double none = std::nan("");
  const Orientation o =
      found ? found.value()
            : Orientation{none, {none, none, none}, {none, none, none}, {none, none, none}, none};
  const auto add = [&](const std::string& quantity, const char* unit, double value) {
    gauges.push_back({name, "orientation", quantity, unit, value});
  };
  const auto add_vector = [&](const std::string& quantity, const char* unit, const Vec3& v) {
    for (int k = 0; k < 3; ++k) add(quantity + "_" + "xyz"[k], unit, v[k]);
  };
  add("angle", "deg", kDegrees * o.angle);
  add_vector("axis", "1", o.axis);
  add_vector("normal", "1", o.normal);
  add_vector("displacement", "m", o.displacement);
}

}  // namespace

std::vector<VolumeMeasures> volume_parts(const BuiltScene& built) {
  std::vector<VolumeMeasures> parts;
  for (const BodyId id : built.bodies) add_parts(built.world.measures(id), parts);
  return parts;
}

void record_measures(const SceneDef& scene, const BuiltScene& built, StepRecord& r) {
  const World& world = built.world;
  r.min_J = INFINITY;
  r.max_J = -INFINITY;
  for (const BodyId id : built.bodies) {
    const BodyMeasures m = world.measures(id);
    r.volume_row_residual = std::max(r.volume_row_residual, m.volume_row_residual);
    r.min_J = std::min(r.min_J, m.min_J);
    r.max_J = std::max(r.max_J, m.max_J);
    r.total.volume += m.volume;
    r.total.rest_volume += m.rest_volume;
    r.momenta.push_back({m.linear_momentum, m.angular_momentum});
    add_parts(m, r.parts);
  }
  r.total.min_J = r.min_J;
  r.total.max_J = r.max_J;
  r.energy = world.energies();
  r.momentum = world.momentum();
  for (const OrientationDef& o : scene.orientations)
    add_orientation(o.name, world.orientation(o.where), r.gauges);
}

}  // namespace isochor
