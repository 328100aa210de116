#include "scenes/run/step_recorder.h"

#include <algorithm>
#include <cmath>

#include "engine/base/text.h"
#include "scenes/run/step_measures.h"

namespace isochor {

void name_records(const SceneDef& scene, RunResult& result) {
  for (const auto& p : scene.probes) result.probes.push_back(p.name);
  for (const auto& c : scene.cavities) result.cavities.push_back(c.name);
  for (const auto& d : scene.dirichlet) result.supports.push_back(d.name);
}

StepRecorder::StepRecorder(const SceneDef& scene, const BuiltScene& built) : scene_(scene), built_(built) {
  for (const ProbeDef& p : scene_.probes) {
    const BodyId id = built_.bodies[static_cast<std::size_t>(p.body)];
    probes_.push_back(locate(built_.world.mesh(id), p.point));
    if (probes_.back().distance == 0) continue;
    const Vec3 X = built_.world.rest_positions(id)[static_cast<std::size_t>(probes_.back().nodes[0])];
    warnings_.push_back("probe \"" + p.name + "\" lies in no cell; it follows the nearest node, at (" +
                        number(X.x) + ", " + number(X.y) + ", " + number(X.z) + "), " +
                        number(probes_.back().distance) + " m away");
  }
}

// The same ones in every record; what is not there now has no number.
std::vector<Gauge> StepRecorder::in_columns(std::vector<Gauge> gauges) const {
  if (built_.gauge_columns.empty()) return gauges;
  std::vector<Gauge> out = built_.gauge_columns;
  for (Gauge& column : out) {
    const auto now = std::find_if(gauges.begin(), gauges.end(), [&](const Gauge& g) {
      return g.effect == column.effect && g.quantity == column.quantity;
    });
    column.value = now == gauges.end() ? std::nan("") : now->value;
  }
  return out;
}

StepRecord StepRecorder::look(int step, const StepReport& report) {
  const World& world = built_.world;
  StepRecord r;
  r.step = step;
  r.time = world.time();
  r.work = report;
  r.substeps = report.substeps;
  r.rejected = report.rejected_substeps;
  r.force_residual = report.force_residual;
  r.row_residual = report.row_residual;
  r.seconds = report.seconds.total;
  r.inverted_cells = report.inverted_cells;
  r.warning = report.warning;
  for (std::size_t p = 0; p < probes_.size(); ++p) {
    const BodyId id = built_.bodies[static_cast<std::size_t>(scene_.probes[p].body)];
    r.probes.push_back(probes_[p].at(world.positions(id)) - probes_[p].at(world.rest_positions(id)));
  }
  r.cavities.resize(scene_.cavities.size());
  const std::vector<Gauge> gauges = world.gauges();
  contacts_.look(r.time, gauges);
  for (const Gauge& g : in_columns(gauges)) {
    const bool of_chamber = g.kind == "cavity" && (g.quantity == "pressure" || g.quantity == "volume");
    if (!of_chamber) r.gauges.push_back(g);
    for (std::size_t c = 0; c < scene_.cavities.size(); ++c) {
      if (!of_chamber || g.effect != scene_.cavities[c].name) continue;
      (g.quantity == "pressure" ? r.cavities[c].pressure : r.cavities[c].volume) = g.value;
    }
  }
  if (scene_.analysis.path_step) {
    r.gauges.push_back(
        {"path", "equilibrium", "unstable directions", "", static_cast<double>(report.unstable_directions)});
  }
  for (const EffectId id : built_.ids(dirichlet_kind)) {
    const auto [force, moment] = world.reaction(id);
    r.reactions.push_back({force, moment});
  }
  return r;
}

void StepRecorder::measure(StepRecord& r) const {
  r.constitutive_residual = built_.world.constitutive_residual();
  record_measures(scene_, built_, r);
}

}  // namespace isochor
