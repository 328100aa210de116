// A swing in dynamics: what the time step costs and what it does to the answer.
#include <algorithm>
#include <cmath>

#include "studies/analysis.h"
#include "studies/problems.h"

namespace isochor::studies {

namespace {

constexpr double kDuration = 0.25;  // [s], a part of the first swing

// A beam at rest that gravity takes hold of at once.
SceneDef swing(const Formulation& f, int steps) {
  SceneDef scene = make_scene(problem("cantilever"), f, 1);
  scene.analysis.options.gravity = {0, -9.8, 0};
  scene.analysis.options.gravity_curve = Curve::constant(1);
  scene.analysis.type = AnalysisType::dynamics;
  scene.analysis.duration = kDuration;
  scene.analysis.steps = steps;
  for (MetricDef& m : scene.metrics) m.reference.reset();
  return scene;
}

std::vector<Cell> cells(bool quick) {
  std::vector<Cell> out;
  for (const char* name : {"tet4_node", "edge_node"}) {
    for (int steps = 4; steps <= (quick ? 64 : 256); steps *= 2) {
      Cell c;
      const Formulation& f = formulation(name);
      c.id = "swing/" + std::string(f.name) + "/" + std::to_string(steps);
      c.labels = {{"formulation", std::string(f.label)}};
      c.knobs["step"] = kDuration / steps;
      c.scene = swing(f, steps);
      c.metric = "tip down";
      c.guarded = steps == 4;
      out.push_back(std::move(c));
    }
  }
  return out;
}

std::vector<Section> present(std::span<const Measured> all) {
  Section s{
      "Swing of a beam",
      "The cantilever, horizontal and at rest, falls under full gravity for 0.25 s with implicit Euler. "
      "Deviation: of the tip from that of the smallest step on the same mesh (our own answer, not an "
      "independent one). A method of first order halves it with the step."};
  Diagram step{"Deviation against time step", "", "time step [s]", "relative deviation"};
  Diagram time{"Deviation against wall time", "", "wall time [s]", "relative deviation"};
  step.log_x = step.log_y = time.log_x = time.log_y = true;
  Table t{"", {"formulation", "step [s]", "tip [m]", "deviation", "order", "iterations", "seconds"}, {}};
  for (const auto& f : label_values(all, "formulation")) {
    const Cells cells_of = where(all, "formulation", f);
    const Measured* finest = nullptr;
    for (const Measured* m : cells_of) {
      if (m->value && m->good() && (!finest || m->knob("step") < finest->knob("step"))) finest = m;
    }
    Line by_step{f, {}, {}}, by_time{f, {}, {}};
    double last = 0;
    for (const Measured* m : cells_of) {
      if (!m->value || !m->good() || !finest) {
        t.failed.push_back(t.rows.size());
        t.rows.push_back({f, text(m->knob("step")), "", m->status, "", "", ""});
        continue;
      }
      const double deviation = std::abs(*m->value / *finest->value - 1);
      if (m != finest) {
        by_step.x.push_back(m->knob("step"));
        by_time.x.push_back(m->seconds);
        by_step.y.push_back(deviation);
        by_time.y.push_back(deviation);
      }
      t.rows.push_back({f, text(m->knob("step")), text(*m->value, 5), m == finest ? "" : percent(deviation),
                        last > 0 && m != finest ? text(std::log2(last / deviation), 2) : "",
                        std::to_string(m->iterations), text(m->seconds)});
      last = deviation;
    }
    step.lines.push_back(std::move(by_step));
    time.lines.push_back(std::move(by_time));
  }
  s.diagrams = {std::move(step), std::move(time)};
  s.tables.push_back(std::move(t));
  return {s, all_cells(all)};
}

}  // namespace

Study timesteps_study() {
  return {"timesteps", "Time steps", "What a smaller time step buys in dynamics, and what it costs.", cells,
          present};
}

}  // namespace isochor::studies
