#include "studies/agreement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>

namespace isochor::studies {

namespace {

struct End {
  std::vector<std::vector<Vec3>> x;  // of each body
  std::vector<double> length;
  int iterations = 0;
  std::string refused;
};

Result<End> run(SceneDef scene, Method method, Solver solver, int most_steps, int threads) {
  scene.analysis.options.method = method;
  scene.analysis.options.solver = solver;
  End end;
  auto built = build(scene, {threads});
  if (!built) return built.failure();
  World& world = built.value().world;
  if (const auto compiled = world.compile(); !compiled) {
    end.refused = compiled.error();
    return end;
  }
  const StepPlan plan = plan_steps(scene.analysis);
  const int steps = most_steps > 0 ? std::min(most_steps, plan.steps) : plan.steps;
  for (int step = 0; step < steps; ++step) {
    const StepReport report = world.advance(plan.h);
    if (report.status != StepStatus::converged) return Error{report.reason};
    end.iterations += report.iterations;
  }
  for (const BodyId body : built.value().bodies) {
    const auto x = world.positions(body);
    const auto rest = world.rest_positions(body);
    end.x.emplace_back(x.begin(), x.end());
    Vec3 lower = rest[0], upper = rest[0];
    for (const Vec3& p : rest) {
      for (int a = 0; a < 3; ++a) {
        lower[a] = std::min(lower[a], p[a]);
        upper[a] = std::max(upper[a], p[a]);
      }
    }
    const Vec3 d = upper - lower;
    end.length.push_back(std::sqrt(dot(d, d)));
  }
  return end;
}

Result<Numbers> compare(const End& a, const End& b) {
  double most = 0;
  for (std::size_t k = 0; k < a.x.size(); ++k) {
    for (std::size_t i = 0; i < a.x[k].size(); ++i) {
      const Vec3 d = a.x[k][i] - b.x[k][i];
      most = std::max(most, std::sqrt(dot(d, d)) / a.length[k]);
    }
  }
  return Numbers{{"distance", most},
                 {"iterations", a.iterations},
                 {"reference iterations", b.iterations},
                 {"refused", 0}};
}

}  // namespace

std::vector<Probe> agreement_probes(const SceneDef& scene, std::span<const SameEnd> ways, int steps) {
  // Of saddle_point, found once for all ways.
  auto reference = std::make_shared<std::optional<End>>();
  std::vector<Probe> out;
  for (const SameEnd& way : ways) {
    out.push_back([scene, way, steps, reference](const SceneDef&, int threads) -> Result<Numbers> {
      auto one = run(scene, way.method, way.solver, steps, threads);
      if (!one) return one.failure();
      if (!one.value().refused.empty()) return Numbers{{"refused", 1}};
      if (!*reference) {
        auto other = run(scene, Method::saddle_point, Solver::automatic, steps, threads);
        if (!other) return other.failure();
        *reference = std::move(other).value();
      }
      return compare(one.value(), **reference);
    });
  }
  return out;
}

}  // namespace isochor::studies
