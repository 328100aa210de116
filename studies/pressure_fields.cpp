#include "studies/pressure_fields.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "studies/pressure_tests.h"

namespace isochor::studies {

namespace {

struct Solved {
  std::vector<double> pressure, volume;  // of cells at rest [Pa, m^3]
  std::vector<Vec3> center;
  double sinking = 0;  // largest displacement [m]
  double grown = 0;    // change of the volume, relative
  int iterations = 0;
};

Result<Solved> solve(const SceneDef& scene, int threads) {
  auto built = build(scene, {threads});
  if (!built) return built.failure();
  World& world = built.value().world;
  const StepPlan plan = plan_steps(scene.analysis);
  Solved out;
  for (int step = 0; step < plan.steps; ++step) {
    const StepReport report = world.advance(plan.h);
    if (report.status != StepStatus::converged) return Error{report.reason};
    out.iterations += report.iterations;
  }
  const BodyId body = built.value().bodies[0];
  out.pressure = world.fields(body).cell_pressure;
  const BodyMeasures measures = world.measures(body);
  out.grown = measures.volume / measures.rest_volume - 1;
  const Mesh& mesh = world.mesh(body);
  const auto per = static_cast<std::size_t>(nodes_per_cell(mesh.cell_type));
  for (std::size_t c = 0; c * per < mesh.cells.size(); ++c) {
    std::array<Vec3, 4> x;
    Vec3 center;
    for (std::size_t k = 0; k < 4; ++k) {
      x[k] = mesh.nodes[static_cast<std::size_t>(mesh.cells[c * per + k])];
      center += 0.25 * x[k];
    }
    out.center.push_back(center);
    out.volume.push_back(dot(x[1] - x[0], cross(x[2] - x[0], x[3] - x[0])) / 6);
  }
  const auto now = world.positions(body), rest = world.rest_positions(body);
  for (std::size_t i = 0; i < now.size(); ++i) {
    const Vec3 d = now[i] - rest[i];
    out.sinking = std::max(out.sinking, std::sqrt(dot(d, d)));
  }
  return out;
}

// Distance in L2 over the norm of `exact`.
double distance(const std::vector<double>& value, const std::vector<double>& exact,
                const std::vector<double>& volume) {
  double difference = 0, size = 0;
  for (std::size_t c = 0; c < value.size(); ++c) {
    difference += volume[c] * (value[c] - exact[c]) * (value[c] - exact[c]);
    size += volume[c] * exact[c] * exact[c];
  }
  return std::sqrt(difference / size);
}

}  // namespace

Result<Numbers> column_pressure(const SceneDef& scene, int threads) {
  const auto* box = std::get_if<BoxMeshDef>(&scene.bodies[0].mesh);
  if (!box) return Error{"the column is no box"};
  auto solved = solve(scene, threads);
  if (!solved) return solved.failure();
  const Solved& s = solved.value();
  std::vector<double> exact;
  for (const Vec3& p : s.center)
    exact.push_back(scene.bodies[0].materials[0].density * scene.analysis.options.gravity.z *
                    (box->upper.z - p.z));
  return Numbers{{"pressure error", distance(s.pressure, exact, s.volume)},
                 {"sinking", s.sinking / (box->upper.z - box->lower.z)},
                 {"iterations", s.iterations}};
}

Probe pressure_against(SceneDef reference) {
  auto kept = std::make_shared<std::optional<std::vector<double>>>();
  return [kept, reference = std::move(reference)](const SceneDef& scene, int threads) -> Result<Numbers> {
    if (!*kept) {
      auto solved = solve(reference, threads);
      if (!solved) return Error{"the reference: " + solved.error()};
      *kept = std::move(solved.value().pressure);
    }
    auto solved = solve(scene, threads);
    if (!solved) return solved.failure();
    const Solved& s = solved.value();
    if (s.pressure.size() != (*kept)->size()) return Error{"the reference has other cells"};
    auto rough = pressure_roughness(scene, threads);
    if (!rough) return rough.failure();
    Numbers out = rough.value();
    out["pressure error"] = distance(s.pressure, **kept, s.volume);
    out["least"] = *std::min_element(s.pressure.begin(), s.pressure.end());
    out["largest"] = *std::max_element(s.pressure.begin(), s.pressure.end());
    out["volume"] = s.grown;
    out["iterations"] = s.iterations;
    return out;
  };
}

}  // namespace isochor::studies
