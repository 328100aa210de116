// What accuracy costs: error against a reference for wall time, by formulation, mesh and setting.
#include <algorithm>
#include <cmath>
#include <limits>

#include "studies/analysis.h"
#include "studies/problems.h"
#include "studies/study.h"

namespace isochor::studies {

namespace {

Cell cell_of(const Problem& p, const Formulation& f, std::size_t level, const std::string& sweep) {
  Cell c = problem_cell(p, f, level);
  c.labels["sweep"] = sweep;
  return c;
}

// Meshes of a formulation; the quick study leaves out the finest of three or more.
std::size_t levels(const Problem& p, const Formulation& f, bool quick) {
  const std::size_t all = level_count(p, f);
  return quick ? std::min<std::size_t>(2, all) : all;
}

void add_meshes(std::vector<Cell>& out, const Problem& p, bool quick) {
  for (const Formulation& f : formulations()) {
    for (std::size_t level = 0; level < levels(p, f, quick); ++level) {
      out.push_back(cell_of(p, f, level, "mesh"));
      // Small, and converging to one answer: a one-field Tet10 needs hundreds of iterations here.
      out.back().guarded = level == 0 && (p.name == "cantilever" || p.name == "cook") && f.name != "tet10";
    }
  }
}

// Settings that change the time and not, or only a little, the answer; each alone, on one mesh.
void add_knobs(std::vector<Cell>& out, const Problem& p, bool quick) {
  for (const char* name : {"edge_node", "tet10_node"}) {
    const Formulation& f = formulation(name);
    const std::size_t level = std::min<std::size_t>(1, level_count(p, f) - 1);
    constexpr std::pair<Solver, const char*> solvers[] = {
        {Solver::mumps, "mumps"}, {Solver::cholmod, "cholmod"}, {Solver::eigen, "eigen"}};
    for (const auto& [solver, word] : solvers) {
      Cell c = cell_of(p, f, level, "solver");
      c.id += std::string("/") + word;
      c.labels["solver"] = word;
      c.scene.analysis.solver = solver;
      out.push_back(std::move(c));
    }
    for (const double tolerance : {1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-9}) {
      if (quick && (tolerance == 1e-3 || tolerance == 1e-6)) continue;
      Cell c = cell_of(p, f, level, "tolerance");
      c.id += "/tolerance_" + text(tolerance, 1);
      c.knobs["tolerance"] = tolerance;
      c.scene.analysis.force_tolerance = tolerance;
      c.scene.analysis.row_tolerance = 0.1 * tolerance;
      out.push_back(std::move(c));
    }
  }
}

std::vector<Cell> cells(bool quick) {
  std::vector<Cell> out;
  for (const Problem& p : problems()) {
    add_meshes(out, p, quick);
  }
  add_knobs(out, problem("cantilever"), quick);
  if (!quick) add_knobs(out, problem("cook"), quick);
  return out;
}

// No error below what the reference itself is worth is drawn as better than that.
double drawn_error(const Measured& m) {
  return m.error ? std::max({*m.error, m.uncertainty, 1e-9}) : std::nan("");
}

std::string hint(const Measured& m) {
  return "mesh " + m.label("mesh") + ", " + std::to_string(m.displacements) + " + " +
         std::to_string(m.multipliers) + " unknowns, " + std::to_string(m.iterations) + " iterations";
}

Diagram against(const Cells& cells, const std::string& title, bool time) {
  Diagram d{title, "", time ? "wall time [s]" : "unknowns", "relative error"};
  d.log_x = d.log_y = true;
  const auto x = [&](const Measured& m) { return time ? m.seconds : m.unknowns(); };
  std::vector<double> cost, error;
  for (const Measured* m : cells) {
    if (!m->good()) continue;
    cost.push_back(x(*m));
    error.push_back(drawn_error(*m));
  }
  if (time) {
    Line front{"best of all (Pareto front)", {}, {}};
    front.front = true;
    for (const std::size_t i : pareto_front(cost, error)) {
      front.x.push_back(cost[i]);
      front.y.push_back(error[i]);
    }
    d.lines.push_back(std::move(front));
  }
  for (const Formulation& f : formulations()) {
    Line line{std::string(f.label), {}, {}};
    for (const Measured* m : where(cells, "formulation", line.name)) {
      if (!m->good()) continue;
      line.x.push_back(x(*m));
      line.y.push_back(drawn_error(*m));
      line.hints.push_back(hint(*m));
    }
    if (!line.x.empty()) d.lines.push_back(std::move(line));
  }
  return d;
}

Section time_section(std::span<const Measured> meshes) {
  Section s{
      "Error against wall time",
      "Down and to the left is better; points of a line are meshes. The broad band joins the settings that "
      "no other beats in both. Time is from reading the mesh to the last step, without outputs. Errors below "
      "the uncertainty of a reference are drawn at it."};
  for (const auto& p : label_values(meshes, "problem"))
    s.diagrams.push_back(against(where(meshes, "problem", p), p, true));
  return s;
}

Section unknowns_section(std::span<const Measured> meshes) {
  Section s{"Error against unknowns",
            "Observed order: of the error in the mesh size, between two neighboring meshes (slope "
            "against unknowns times the number of directions that are refined)."};
  Table t{"Observed orders", {"problem", "formulation", "meshes", "errors", "orders"}, {}};
  for (const auto& p : label_values(meshes, "problem")) {
    const Cells of_problem = where(meshes, "problem", p);
    s.diagrams.push_back(against(of_problem, p, false));
    for (const Formulation& f : formulations()) {
      std::string errors, orders;
      const Measured* last = nullptr;
      int count = 0;
      for (const Measured* m : where(of_problem, "formulation", std::string(f.label))) {
        if (!m->error) continue;
        errors += (errors.empty() ? "" : ", ") + percent(*m->error);
        if (last) {
          const auto order =
              observed_order(last->unknowns(), *last->error, m->unknowns(), *m->error, m->knob("dimension"));
          // Below the uncertainty of the reference the slope means nothing.
          const bool noise = *m->error < 2 * m->uncertainty;
          orders += (orders.empty() ? "" : ", ") + (order && !noise ? text(*order, 2) : std::string("–"));
        }
        last = m;
        ++count;
      }
      if (count > 0) t.rows.push_back({p, std::string(f.label), std::to_string(count), errors, orders});
    }
  }
  s.tables.push_back(std::move(t));
  return s;
}

// "1 % costs 0.8 s with ...".
Section cost_section(std::span<const Measured> meshes) {
  Section s{
      "What accuracy costs",
      "The cheapest setting measured that reaches the error, its time, and the time of one-field Tet4 and of "
      "Tet4 with plain nodal pressure at the same error (between two meshes: read off the line through "
      "them)."};
  Table t{
      "", {"problem", "error", "costs [s]", "with", "one-field Tet4 [s]", "Tet4, nodal pressure [s]"}, {}};
  for (const auto& p : label_values(meshes, "problem")) {
    const Cells cells = where(meshes, "problem", p);
    for (const double error : {0.1, 0.03, 0.01, 0.003, 0.001}) {
      const Measured* best = cheapest(cells, error);
      const auto of = [&](const char* name) {
        const auto seconds =
            seconds_at(where(cells, "formulation", std::string(formulation(name).label)), error);
        return seconds ? text(*seconds, 2) : std::string("not reached");
      };
      t.rows.push_back({p, percent(error), best ? text(best->seconds, 2) : "not reached",
                        best ? best->label("formulation") + ", mesh " + best->label("mesh") : "", of("tet4"),
                        of("tet4_node")});
    }
  }
  s.tables.push_back(std::move(t));
  return s;
}

Section profile_section(std::span<const Measured> meshes) {
  Section s{
      "Performance profiles",
      "Over all problems, at 3 % and at 1 % error: the share of problems that a formulation solves within a "
      "factor of the time of the best one there (Dolan and Moré 2002). High and left is better; a line that "
      "ends below 1 does not reach the error on the rest."};
  const auto names = label_values(meshes, "problem");
  for (const double error : {0.03, 0.01}) {
    std::vector<std::vector<double>> costs;
    for (const Formulation& f : formulations()) {
      costs.emplace_back();
      for (const auto& p : names) {
        const auto seconds =
            seconds_at(where(where(meshes, "problem", p), "formulation", std::string(f.label)), error);
        costs.back().push_back(seconds.value_or(std::nan("")));
      }
    }
    Diagram d{"Within " + percent(error), "", "factor of the best time", "share of problems"};
    d.log_x = true;
    const auto profiles = performance_profiles(costs);
    double widest = 1;
    for (const Profile& profile : profiles) {
      if (!profile.factor.empty()) widest = std::max(widest, profile.factor.back());
    }
    for (std::size_t f = 0; f < profiles.size(); ++f) {
      Line line{std::string(formulations()[f].label), profiles[f].factor, profiles[f].share};
      line.steps = true;
      if (line.x.empty()) continue;
      line.x.push_back(2 * widest);
      line.y.push_back(line.y.back());
      d.lines.push_back(std::move(line));
    }
    s.diagrams.push_back(std::move(d));
  }
  return s;
}

Section knobs_section(std::span<const Measured> all) {
  Section s{
      "Which knob buys what",
      "One setting at a time on one mesh. Tolerance: of the unbalanced force relative to the forces that "
      "cancel, rows at a tenth of it. Deviation: from the answer with the tightest tolerance on the same "
      "mesh, "
      "so what the tolerance alone adds to the error of the mesh."};
  Table solvers{"Linear solver", {"problem", "formulation", "solver", "seconds", "factor [s]", "error"}, {}};
  Table tolerances{"Newton tolerance",
                   {"problem", "formulation", "tolerance", "seconds", "iterations", "deviation", "error"},
                   {}};
  for (const Measured& m : all) {
    if (m.label("sweep") != "solver") continue;
    if (!m.good()) solvers.failed.push_back(solvers.rows.size());
    solvers.rows.push_back({m.label("problem"), m.label("formulation"), m.label("solver"), text(m.seconds, 2),
                            text(m.stages.factor, 2), m.error ? percent(*m.error) : m.reason});
  }
  Diagram d{"Deviation against Newton tolerance", "", "tolerance", "relative deviation"};
  d.log_x = d.log_y = true;
  const Cells sweep = where(all, "sweep", "tolerance");
  for (const auto& p : label_values(all, "problem")) {
    for (const auto& f : label_values(all, "formulation")) {
      const Cells line_cells = where(where(sweep, "problem", p), "formulation", f);
      const Measured* tightest = nullptr;
      for (const Measured* m : line_cells) {
        if (m->value && (!tightest || m->knob("tolerance") < tightest->knob("tolerance"))) tightest = m;
      }
      if (!tightest) continue;
      Line line{f + ", " + p, {}, {}};
      for (const Measured* m : line_cells) {
        if (!m->value) continue;
        const double deviation = std::abs(*m->value / *tightest->value - 1);
        if (m != tightest) {
          line.x.push_back(m->knob("tolerance"));
          line.y.push_back(std::max(deviation, 1e-16));
        }
        tolerances.rows.push_back({p, f, text(m->knob("tolerance"), 1), text(m->seconds, 2),
                                   std::to_string(m->iterations), m == tightest ? "0" : text(deviation, 2),
                                   m->error ? percent(*m->error) : ""});
      }
      d.lines.push_back(std::move(line));
    }
  }
  s.diagrams.push_back(std::move(d));
  s.tables = {std::move(tolerances), std::move(solvers)};
  return s;
}

std::vector<Section> present(std::span<const Measured> all) {
  std::vector<Measured> meshes;
  for (const Measured& m : all) {
    if (m.label("sweep") == "mesh") meshes.push_back(m);
  }
  return {cost_section(meshes),    time_section(meshes), unknowns_section(meshes),
          profile_section(meshes), knobs_section(all),   all_cells(all)};
}

}  // namespace

Study accuracy_study() {
  return {
      "accuracy", "What accuracy costs",
      "Relative error against independent references for wall time: which element, mesh and setting buys the "
      "most accuracy a second.",
      cells, present};
}

}  // namespace isochor::studies
