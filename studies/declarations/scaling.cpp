// Threads and sizes.
#include <algorithm>
#include <cmath>
#include <thread>

#include "studies/analysis.h"
#include "studies/problems.h"

namespace isochor::studies {

namespace {

std::vector<Cell> cells(bool quick) {
  std::vector<Cell> out;
  const Problem& p = problem("cantilever");
  const int all = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  for (const char* name : {"tet4_node", "edge_node", "tet10_node"}) {
    const Formulation& f = formulation(name);
    for (std::size_t k = 1; k < (quick ? 2u : 4u); ++k) {
      // 20, 40 and 60 boxes along, of Tet10 half as many.
      const std::size_t level = k < 2 || f.quadratic() ? k : k + 1;
      for (int threads = 1; threads <= std::max(2, all); threads *= 2) {
        Cell c = problem_cell(p, f, level);
        c.id += "/threads_" + std::to_string(threads);
        c.knobs["threads"] = threads;
        c.threads = threads;
        out.push_back(std::move(c));
      }
    }
  }
  return out;
}

std::vector<Section> present(std::span<const Measured> all) {
  Section s{"Threads and sizes",
            "The same scene at several thread counts and on several meshes. The state must be the same, bit "
            "for bit, at "
            "any thread count. Growth: the exponent of the time in the unknowns, between neighboring meshes "
            "at one thread."};
  Diagram d{"Time at one thread", "", "unknowns", "wall time [s]"};
  d.log_x = d.log_y = true;
  Table t{"",
          {"formulation", "mesh", "unknowns", "threads", "seconds", "speedup", "evaluation [s]",
           "factorization [s]", "growth", "same state"},
          {}};
  for (const auto& f : label_values(all, "formulation")) {
    const Cells of = where(all, "formulation", f);
    Line line{f, {}, {}};
    const Measured *one = nullptr, *coarser = nullptr;
    for (const Measured* m : of) {
      if (!m->good()) continue;
      std::string growth;
      if (m->knob("threads") == 1) {
        coarser = one;
        one = m;
        line.x.push_back(m->unknowns());
        line.y.push_back(m->seconds);
        if (coarser)
          growth = text(
              std::log(m->seconds / coarser->seconds) / std::log(m->unknowns() / coarser->unknowns()), 2);
      }
      const bool paired = one && one->label("mesh") == m->label("mesh");
      if (paired && one->hash != m->hash) t.failed.push_back(t.rows.size());
      t.rows.push_back({f, m->label("mesh"), text(m->unknowns(), 7), text(m->knob("threads")),
                        text(m->seconds), paired ? text(one->seconds / m->seconds) : "",
                        text(m->stages.evaluate), text(m->stages.factor), growth,
                        paired ? (one->hash == m->hash ? "yes" : "NO") : ""});
    }
    d.lines.push_back(std::move(line));
  }
  s.diagrams.push_back(std::move(d));
  s.tables.push_back(std::move(t));
  return {s, all_cells(all)};
}

}  // namespace

Study scaling_study() {
  return {"scaling", "Threads and sizes", "How time grows with the mesh and shrinks with threads.", cells,
          present};
}

}  // namespace isochor::studies
