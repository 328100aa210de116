// How much load a single step takes.
#include <algorithm>

#include "studies/analysis.h"
#include "studies/problems.h"

namespace isochor::studies {

namespace {

std::vector<Cell> cells(bool quick) {
  std::vector<Cell> out;
  const Problem& p = problem("cantilever");
  for (const char* name : {"tet4_node", "edge_node", "tet10_node"}) {
    const Formulation& f = formulation(name);
    for (const double load : {0.1, 1.0, 5.0, 20.0, 50.0}) {
      Cell c = problem_cell(p, f, quick ? 0 : 1);
      c.id = "load/" + std::string(f.name) + "/" + text(load);
      c.knobs["load"] = load;
      c.scene.gravity = {0, -9.8 * load, 0};
      c.reference.reset();
      c.source.clear();
      c.guarded = quick && load <= 5;
      out.push_back(std::move(c));
    }
  }
  return out;
}

std::vector<Section> present(std::span<const Measured> all) {
  Section s{"The whole load in one step",
            "The cantilever at nu = 0.5 under a multiple of gravity, asked for in one increment. "
            "Factorizations beyond the "
            "iterations are tries at increments that were cut or matrices that were mended; min J is the "
            "smallest volume "
            "ratio of a cell (below zero: turned over)."};
  Table t{"",
          {"formulation", "load / g", "status", "tip [m]", "iterations", "factorizations", "min J", "max J",
           "volume error", "seconds"},
          {}};
  Diagram d{"Newton iterations", "", "load / g", "iterations"};
  d.log_x = true;
  for (const auto& f : label_values(all, "formulation")) {
    Line line{f, {}, {}};
    for (const Measured* m : where(all, "formulation", f)) {
      if (!m->good()) t.failed.push_back(t.rows.size());
      t.rows.push_back({f, text(m->knob("load")), m->status, m->good() && m->value ? text(*m->value, 4) : "",
                        std::to_string(m->iterations), std::to_string(m->factorizations),
                        text(m->number("min J")), text(m->number("max J")),
                        text(m->number("volume error"), 2), text(m->seconds)});
      if (!m->good()) continue;
      line.x.push_back(m->knob("load"));
      line.y.push_back(m->iterations);
    }
    d.lines.push_back(std::move(line));
  }
  s.diagrams.push_back(std::move(d));
  s.tables.push_back(std::move(t));
  return {s, all_cells(all)};
}

}  // namespace

Study stability_study() {
  return {"stability", "Stability",
          "How much load one increment takes, and whether elements stay right side out.", cells, present};
}

}  // namespace isochor::studies
