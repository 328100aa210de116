#include "scenes/run/accuracy.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "engine/base/base.h"
#include "isochor/mesh_io.h"
#include "scenes/body_parts.h"
#include "scenes/check_values.h"
#include "scenes/run/error_places.h"

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

bool all_of_element(const SceneDef& scene, Element e) {
  return std::all_of(scene.bodies.begin(), scene.bodies.end(),
                     [&](const SceneBody& b) { return b.element == e; });
}

// Meshes of Tet4 from files, which another element can be laid on; boxes are cut finer at once.
bool on_linear_files(const SceneDef& scene) {
  return std::all_of(scene.bodies.begin(), scene.bodies.end(), [&](const SceneBody& b) {
    const auto* file = std::get_if<MeshFile>(&b.mesh);
    if (!file) return false;
    const auto mesh = read_mesh(path_in(scene.folder, file->path));
    return mesh && mesh.value().cell_type == CellType::tet4;
  });
}

// A component of a displacement that is less of it than this is worth as much of the whole: what is left of
// symmetry on an unsymmetric mesh has no error of its own that refinement could be asked to halve.
constexpr double kLeastComponent = 0.1;

// What the displacement of a probe that a metric is a component of amounts to, in the unit of the metric; 0:
// it is none.
double whole_of(const MetricDef& m, const RunResult& result) {
  const auto probe = std::find(result.probes.begin(), result.probes.end(), m.of);
  if (m.quantity != Quantity::displacement || probe == result.probes.end() || result.records.empty())
    return 0;
  const auto off = [&](const StepRecord& r) { return std::abs(r.time - m.time.value_or(r.time)); };
  const auto then =
      m.time ? std::min_element(result.records.begin(), result.records.end(),
                                [&](const StepRecord& a, const StepRecord& b) { return off(a) < off(b); })
             : std::prev(result.records.end());
  return std::abs(m.scale) * norm(then->probes[static_cast<std::size_t>(probe - result.probes.begin())]);
}

}  // namespace

double Answer::shown() const {
  return vector ? norm(value) : value.x;
}

bool has_answers(const SceneDef& scene) {
  return !scene.probes.empty() || std::any_of(scene.metrics.begin(), scene.metrics.end(),
                                              [](const MetricDef& m) { return has_error(m.quantity); });
}

std::vector<Answer> answers_of(const RunResult& result) {
  std::vector<Answer> out;
  for (const MetricValue& m : result.metrics) {
    if (!has_error(m.def.quantity) || !m.reached) continue;
    // A change of volume is relative to the volume as it is.
    const double size = m.def.quantity == Quantity::volume_change
                            ? std::abs(m.def.scale)
                            : std::max(std::abs(m.value), kLeastComponent * whole_of(m.def, result));
    out.push_back({m.def.name, m.def.unit, {m.value, 0, 0}, size, false});
  }
  for (std::size_t p = 0; !result.records.empty() && p < result.probes.size(); ++p) {
    const Vec3& u = result.records.back().probes[p];
    out.push_back({"probe " + result.probes[p], "m", u, norm(u), true});
  }
  return out;
}

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
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    if (std::holds_alternative<LatticeMesh>(scene.bodies[b].mesh)) {
      return Error{
          "no indicator: the cubes of " + place("bodies", b) +
          " are cut anew from its surface at every spacing; run the scene with half of mesh.lattice.spacing "
          "and compare"};
    }
  }
  if (all_of_element(scene, Element::tet10) && on_linear_files(scene)) {
    for (SceneBody& b : out.scene.bodies) b.element = Element::tet4_edge_smoothed;
    out.comparison = Comparison::worse_element;
    out.how = "the same mesh with edge-smoothed Tet4, whose error this is: an upper limit for Tet10";
    return out;
  }
  for (SceneBody& b : out.scene.bodies) ++b.refine;
  out.comparison = Comparison::finer_mesh;
  out.how = "the same mesh with every cell cut into eight, four thirds of the difference";
  return out;
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
  quiet.origins = false;
  const RunResult other = run_scene(compared.value().scene, quiet);
  a.seconds = other.wall_s;
  if (other.status != RunStatus::converged) {
    a.reason = "no indicator: the scene it would be compared with (" + a.how + ") ended as " +
               to_string(other.status) + ": " + other.reason;
    return a;
  }
  const std::vector<Answer> answers = answers_of(result), others = answers_of(other);
  for (const Answer& mine : answers) {
    const auto found =
        std::find_if(others.begin(), others.end(), [&](const Answer& o) { return o.name == mine.name; });
    if (found == others.end()) continue;
    AccuracyEntry e{mine.name, mine.unit, mine.shown(), found->shown(), norm(mine.value - found->value), {}};
    if (a.comparison == Comparison::finer_mesh) e.indicator *= kHalvedCells;
    if (found->size > 0) e.relative = e.indicator / found->size;
    a.entries.push_back(std::move(e));
  }
  add_places(result.origins, a.entries);
  return a;
}

}  // namespace isochor
