#include "scenes/run/accuracy.h"

#include <algorithm>
#include <cmath>

namespace isochor {

namespace {

// A halved cell takes away three quarters of an error of second order, so the whole is 4/3 of the difference.
// Tet10 do better where the solution is smooth, and no better at bonded edges.
constexpr double kHalvedCells = 4.0 / 3.0;

// Counts and residuals have no error of discretization; extremes of J are those of single cells.
bool has_error(Quantity q) {
  switch (q) {
    case Quantity::volume_row_residual:
    case Quantity::constitutive_residual:
    case Quantity::newton_iterations:
    case Quantity::min_J:
    case Quantity::max_J:
      return false;
    default:
      return true;
  }
}

bool boxes_only(const SceneDef& scene) {
  return std::all_of(scene.bodies.begin(), scene.bodies.end(),
                     [](const SceneBody& b) { return std::holds_alternative<BoxMeshDef>(b.mesh); });
}

bool all_of_element(const SceneDef& scene, Element e) {
  return std::all_of(scene.bodies.begin(), scene.bodies.end(),
                     [&](const SceneBody& b) { return b.element == e; });
}

AccuracyEntry entry(std::string name, std::string unit, double value, double other, double difference,
                    double size, Comparison comparison) {
  AccuracyEntry e{std::move(name), std::move(unit), value, other, difference, {}};
  if (comparison == Comparison::finer_boxes) e.indicator *= kHalvedCells;
  if (size > 0) e.relative = e.indicator / size;
  return e;
}

double length(const Vec3& v) {
  return std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
}

}  // namespace

Result<ComparedScene> compared_scene(const SceneDef& scene) {
  ComparedScene out{scene, Comparison::better_element, ""};
  out.scene.outputs.every = 0;
  out.scene.outputs.page = false;
  bool raised = false;
  for (SceneBody& b : out.scene.bodies) {
    if (b.element == Element::tet4) {
      b.element = Element::tet4_edge_smoothed;
      raised = true;
    } else if (b.element == Element::tet4_edge_smoothed) {
      b.element = Element::tet10;
      raised = true;
    }
  }
  if (raised) {
    out.how = "the same mesh with the next better element (Tet4: edge-smoothed, edge-smoothed Tet4: Tet10)";
    return out;
  }
  if (boxes_only(scene)) {
    for (SceneBody& b : out.scene.bodies) {
      for (int& n : std::get<BoxMeshDef>(b.mesh).divisions) n *= 2;
    }
    out.comparison = Comparison::finer_boxes;
    out.how = "the same boxes cut in two in every direction, four thirds of the difference";
    return out;
  }
  if (all_of_element(scene, Element::tet10)) {
    for (SceneBody& b : out.scene.bodies) b.element = Element::tet4_edge_smoothed;
    out.comparison = Comparison::worse_element;
    out.how = "the same mesh with edge-smoothed Tet4, whose error this is: an upper limit for Tet10";
    return out;
  }
  return Error{
      "no indicator: the bodies have the best element there is for their cells, on meshes that are not "
      "boxes; "
      "run the scene on a finer mesh and compare"};
}

Accuracy estimate_accuracy(const SceneDef& scene, const RunResult& result, const RunOptions& options) {
  Accuracy a;
  if (result.status != RunStatus::converged) {
    a.reason = "no indicator: the run itself did not converge";
    return a;
  }
  auto compared = compared_scene(scene);
  if (!compared) {
    a.reason = compared.error();
    return a;
  }
  a.comparison = compared.value().comparison;
  a.how = compared.value().how;
  RunOptions quiet = options;
  quiet.folder.clear();
  quiet.on_step = {};
  const RunResult other = run_scene(compared.value().scene, quiet);
  a.seconds = other.wall_s;
  if (other.status != RunStatus::converged) {
    a.reason = "no indicator: the scene it would be compared with (" + a.how + ") ended as " +
               to_string(other.status) + ": " + other.reason;
    return a;
  }
  for (std::size_t k = 0; k < result.metrics.size() && k < other.metrics.size(); ++k) {
    const MetricValue &m = result.metrics[k], &o = other.metrics[k];
    if (!has_error(m.def.quantity) || !m.reached || !o.reached) continue;
    a.entries.push_back(entry(m.def.name, m.def.unit, m.value, o.value, std::abs(m.value - o.value),
                              std::abs(o.value), a.comparison));
  }
  if (result.records.empty() || other.records.empty()) return a;
  const StepRecord &end = result.records.back(), &other_end = other.records.back();
  for (std::size_t p = 0; p < end.probes.size() && p < other_end.probes.size(); ++p) {
    const Vec3 &u = end.probes[p], &v = other_end.probes[p];
    a.entries.push_back(entry("probe " + result.probes[p], "m", length(u), length(v),
                              length({u.x - v.x, u.y - v.y, u.z - v.z}), length(v), a.comparison));
  }
  return a;
}

}  // namespace isochor
