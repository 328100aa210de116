// Linear solvers on the same systems, and methods for the same saddle points.
#include <algorithm>

#include "studies/analysis.h"
#include "studies/problems.h"

namespace isochor::studies {

namespace {

struct Way {
  const char* name;
  Solver solver;
  Method method;
};
constexpr Way kWays[] = {{"multifrontal", Solver::multifrontal, Method::saddle_point},
                         {"mumps", Solver::mumps, Method::saddle_point},
                         {"cholmod", Solver::cholmod, Method::saddle_point},
                         {"eigen", Solver::eigen, Method::saddle_point},
                         {"iterative", Solver::iterative, Method::saddle_point},
                         {"dual_gradients", Solver::automatic, Method::dual_gradients},
                         {"augmented_gradients", Solver::automatic, Method::augmented_gradients},
                         {"augmented_ascent", Solver::automatic, Method::augmented_ascent}};

std::vector<Cell> cells(bool quick) {
  std::vector<Cell> out;
  const Problem& p = problem("cantilever");
  for (const char* name : {"tet4_node", "edge_node", "tet10_node"}) {
    const Formulation& f = formulation(name);
    for (std::size_t k = 0; k < (quick ? 2u : 3u); ++k) {
      // After 20 x 2 x 2 boxes 40 x 4 x 4, of Tet10 20 x 2 x 2.
      const std::size_t level = k < 2 || f.quadratic() ? k : k + 1;
      for (const Way& way : kWays) {
        Cell c = problem_cell(p, f, level);
        c.id += std::string("/") + way.name;
        c.labels["solver"] = way.name;
        c.scene.analysis.options.solver = way.solver;
        c.scene.analysis.options.method = way.method;
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
      "Solvers and methods",
      "Seconds of the whole run, and milliseconds for one factorization where there are any (of the saddle "
      "point, or of what a dual method factors), against the unknowns. The answers must agree whatever the "
      "way: compare the errors in the table."};
  Table t{"",
          {"formulation", "mesh", "unknowns", "solver", "factor non-zeros", "one factorization [ms]",
           "one solve [ms]", "iterations", "whole run [s]", "error"},
          {}};
  for (const auto& f : label_values(all, "formulation")) {
    Diagram run{f, "", "unknowns", "whole run [s]"}, one{f, "", "unknowns", "one factorization [ms]"};
    run.log_x = run.log_y = one.log_x = one.log_y = true;
    for (const Way& way : kWays) {
      Line seconds{way.name, {}, {}}, factor{way.name, {}, {}};
      for (const Measured* m : where(where(all, "formulation", f), "solver", way.name)) {
        if (!m->good()) continue;
        seconds.x.push_back(m->unknowns());
        seconds.y.push_back(m->seconds);
        if (factor_milliseconds(*m) <= 0) continue;
        factor.x.push_back(m->unknowns());
        factor.y.push_back(factor_milliseconds(*m));
      }
      run.lines.push_back(std::move(seconds));
      if (!factor.x.empty()) one.lines.push_back(std::move(factor));
    }
    s.diagrams.push_back(std::move(run));
    s.diagrams.push_back(std::move(one));
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
          "How long linear solvers and methods take on the same systems, and that they agree.", cells,
          present};
}

}  // namespace isochor::studies
