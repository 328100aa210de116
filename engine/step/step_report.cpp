#include "engine/step/step_report.h"

#include <algorithm>

#include "engine/base/text.h"

namespace isochor {

void add_solve(StepReport& total, const SaddleReport& r) {
  total += r;
  total.negative_pivots = r.negative_pivots;
  total.force_residual = r.force_residual;
  total.row_residual = r.row_residual;
  total.linear_residual = std::max(total.linear_residual, r.linear_residual);
}

namespace {

// Where nodes of the scene are: "nodes 3, 4 of body \"finger\"".
std::string name_nodes(std::span<const Index> nodes, const std::vector<BodyData>& bodies) {
  std::string text;
  const BodyData* named = nullptr;
  for (const Index n : nodes) {
    const auto body = std::find_if(bodies.begin(), bodies.end(), [n](const BodyData& b) {
      return n >= b.first_node && n < b.first_node + b.mesh.node_count();
    });
    if (body == bodies.end() || (named && &*body != named)) continue;
    text += (named ? ", " : nodes.size() == 1 ? "node " : "nodes ") + std::to_string(n - body->first_node);
    named = &*body;
  }
  return named ? text + " of body \"" + named->name + "\"" : std::string("a point of an effect");
}

// What a matrix that stayed singular says about the scene.
std::string singular_text(const SaddleReport& r, const std::vector<BodyData>& bodies) {
  if (r.null_nodes.empty())
    return "; rows without compliance may repeat each other or lack stabilization, or a part is not held";
  const std::string where = name_nodes(r.null_nodes, bodies);
  if (r.null_rows.empty()) {
    return "; " + where +
           " can move without any force (a mechanism, or a load at which the shape gives way): "
           "hold them, or use a dynamic scheme";
  }
  std::string rows;
  for (const std::string& name : r.null_rows) rows += (rows.empty() ? "\"" : ", \"") + name + "\"";
  return "; the rows of " + rows + " depend on each other around " + where +
         ": what one says follows from the others, or contradicts them; drop one, or give one a compliance "
         "(pressures at nodes: a stabilization)";
}

}  // namespace

std::string failure_text(const SaddleReport& r, double t, const std::vector<BodyData>& bodies) {
  std::string text = "no equilibrium found at t = " + number(t) + ": " + std::string(to_string(r.status));
  if (!r.message.empty()) text += " (" + r.message + ")";
  if (r.status == SaddleStatus::singular) text += singular_text(r, bodies);
  return text;
}

StepReport invalid_step(std::string reason, double time) {
  StepReport report;
  report.status = StepStatus::invalid;
  report.reason = std::move(reason);
  report.time = time;
  return report;
}

}  // namespace isochor
