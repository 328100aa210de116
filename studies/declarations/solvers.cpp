// Direct solvers on the same systems.
#include <algorithm>

#include "studies/analysis.h"
#include "studies/problems.h"

namespace isochor::studies {

namespace {

constexpr std::pair<Solver, const char*> kSolvers[] = {
    {Solver::mumps, "mumps"}, {Solver::cholmod, "cholmod"}, {Solver::eigen, "eigen"}};

std::vector<Cell> cells(bool quick) {
  std::vector<Cell> out;
  const Problem& p = problem("cantilever");
  for (const char* name : {"tet4_node", "edge_node", "tet10_node"}) {
    const Formulation& f = formulation(name);
    for (std::size_t k = 0; k < (quick ? 2u : 3u); ++k) {
      // After 20 x 2 x 2 boxes 40 x 4 x 4, of Tet10 20 x 2 x 2.
      const std::size_t level = k < 2 || f.quadratic() ? k : k + 1;
      for (const auto& [solver, word] : kSolvers) {
        Cell c = problem_cell(p, f, level);
        c.id += std::string("/") + word;
        c.labels["solver"] = word;
        c.scene.analysis.solver = solver;
        out.push_back(std::move(c));
      }
    }
  }
  return out;
}

double factor_milliseconds(const Measured& m) {
  return 1e3 * m.stages.factor / std::max(1, m.factorizations);
}

std::vector<Section> present(std::span<const Measured> all) {
  Section s{
      "Factorization",
      "Milliseconds for one factorization of the saddle-point matrix, against its unknowns. The answers must "
      "agree whatever the solver: compare the errors in the table."};
  Table t{"",
          {"formulation", "mesh", "unknowns", "solver", "factor non-zeros", "one factorization [ms]",
           "one solve [ms]", "iterations", "whole run [s]", "error"},
          {}};
  for (const auto& f : label_values(all, "formulation")) {
    Diagram d{f, "", "unknowns", "one factorization [ms]"};
    d.log_x = d.log_y = true;
    for (const auto& [solver, word] : kSolvers) {
      Line line{word, {}, {}};
      for (const Measured* m : where(where(all, "formulation", f), "solver", word)) {
        if (!m->good()) continue;
        line.x.push_back(m->unknowns());
        line.y.push_back(factor_milliseconds(*m));
      }
      d.lines.push_back(std::move(line));
    }
    s.diagrams.push_back(std::move(d));
  }
  for (const Measured& m : all) {
    if (!m.good()) t.failed.push_back(t.rows.size());
    t.rows.push_back({m.label("formulation"), m.label("mesh"), text(m.unknowns(), 6), m.label("solver"),
                      std::to_string(m.factor_nonzeros), text(factor_milliseconds(m)),
                      text(1e3 * m.stages.solve / std::max(1, m.solves)), std::to_string(m.iterations),
                      text(m.seconds), m.error ? percent(*m.error, 6) : m.status});
  }
  s.tables.push_back(std::move(t));
  return {s, all_cells(all)};
}

}  // namespace

Study solvers_study() {
  return {"solvers", "Linear solvers",
          "How long the direct solvers take on the same systems, and that they agree.", cells, present};
}

}  // namespace isochor::studies
