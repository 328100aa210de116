// What accuracy costs: error against a reference for time, by formulation, mesh and setting.
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
  // Times are compared, and processor time on one thread is what repeats best.
  c.threads = 1;
  return c;
}

// Meshes of a formulation. The quick study has one or two of each.
std::size_t levels(const Problem& p, const Formulation& f, bool quick) {
  std::size_t all = level_count(p, f);
  // One-field Tet10 and Hex8 take hundreds of iterations, minutes on the finest meshes.
  if (f.name == "tet10" || f.name == "hex8") all = std::min<std::size_t>(p.name == "cushion" ? 1 : 2, all);
  if (!quick) return all;
  const bool slow = p.name == "thick_sphere" || f.name == "tet10" || (p.name == "cushion" && f.quadratic()) ||
                    (p.name == "torsion" && f.name == "hex8_element");
  if (p.name == "cushion" && f.name == "tet10") return 0;
  return std::min<std::size_t>(slow ? 1 : 2, all);
}

void add_meshes(std::vector<Cell>& out, const Problem& p, bool quick) {
  for (const Formulation& f : formulations()) {
    for (std::size_t level = 0; level < levels(p, f, quick); ++level) {
      out.push_back(cell_of(p, f, level, "mesh"));
      // Small, and converging to one answer: a one-field Tet10 needs hundreds of iterations here.
      // Locking Hex8 wander through wrong inertias, with rounding deciding how many.
      out.back().guarded =
          level == 0 && (p.name == "cantilever" || p.name == "cook") && f.name != "tet10" && f.name != "hex8";
    }
  }
}

// The same problems with fewer steps and a looser Newton tolerance: what one would choose who wants a percent
// and no more. On every mesh of the plain Tet4, which are compared with, and the coarser ones of the others.
constexpr double kFrugalTolerance = 1e-3;

void add_frugal(std::vector<Cell>& out, const Problem& p, bool quick) {
  for (const char* name : {"tet4", "tet4_node_plain", "tet4_node", "edge_node", "tet10_element", "tet10_node",
                           "hex8_element", "hex8_node"}) {
    const Formulation& f = formulation(name);
    std::size_t count = levels(p, f, quick);
    if (f.element != Element::tet4) count = std::min<std::size_t>(count, 3);
    for (std::size_t level = 0; level < count; ++level) {
      Cell c = cell_of(p, f, level, "frugal");
      c.id += "/frugal";
      c.knobs["tolerance"] = kFrugalTolerance;
      c.knobs["steps"] = p.few_steps;
      c.scene.analysis.options.force_tolerance = kFrugalTolerance;
      c.scene.analysis.options.row_tolerance = 0.1 * kFrugalTolerance;
      c.scene.analysis.steps = p.few_steps;
      out.push_back(std::move(c));
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
      c.scene.analysis.options.solver = solver;
      out.push_back(std::move(c));
    }
    for (const double tolerance : {1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-9}) {
      if (quick && (tolerance == 1e-3 || tolerance == 1e-6)) continue;
      Cell c = cell_of(p, f, level, "tolerance");
      c.id += "/tolerance_" + text(tolerance, 1);
      c.knobs["tolerance"] = tolerance;
      c.scene.analysis.options.force_tolerance = tolerance;
      c.scene.analysis.options.row_tolerance = 0.1 * tolerance;
      out.push_back(std::move(c));
    }
  }
}

// The time step and the scheme of a motion, on two meshes of one and on one of the other.
void add_steps(std::vector<Cell>& out, bool quick) {
  const Problem& p = problem("swing");
  constexpr std::pair<SchemeWord, const char*> schemes[] = {{SchemeWord::implicit_euler, "implicit Euler"},
                                                            {SchemeWord::bdf2, "BDF2"}};
  for (const char* name : {"edge_node", "tet10_node"}) {
    const Formulation& f = formulation(name);
    for (const auto& [scheme, word] : schemes) {
      for (int steps = 8; steps <= (quick ? 32 : 128); steps *= 2) {
        Cell c = cell_of(p, f, 1, "step");
        c.id += std::string("/") + word + "/" + std::to_string(steps);
        c.labels["scheme"] = word;
        c.knobs["step"] = c.scene.analysis.duration / steps;
        c.scene.analysis.scheme = scheme;
        c.scene.analysis.steps = steps;
        out.push_back(std::move(c));
      }
    }
  }
}

std::vector<Cell> cells(bool quick) {
  std::vector<Cell> out;
  for (const Problem& p : problems()) {
    add_meshes(out, p, quick);
    add_frugal(out, p, quick);
  }
  add_steps(out, quick);
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
  Diagram d{title, "", time ? "processor time [s]" : "unknowns", "relative error"};
  d.log_x = d.log_y = true;
  const auto x = [&](const Measured& m) { return time ? m.cpu_seconds : m.unknowns(); };
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
      "Error against time",
      "Down and to the left is better; points of a line are meshes. The broad band joins the settings that "
      "no other beats in both. Time is processor time on one thread, from reading the mesh to the last step, "
      "without outputs: the wall time of an idle machine. Errors below the uncertainty of a reference are "
      "drawn at it."};
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

// Of each setting those whose finer meshes stay below the error too.
Cells lasting_of_settings(std::span<const Measured> all, const std::string& problem, double error) {
  Cells out;
  for (const char* sweep : {"mesh", "frugal"}) {
    const Cells cells = lasting(where(where(all, "sweep", sweep), "problem", problem), error);
    out.insert(out.end(), cells.begin(), cells.end());
  }
  return out;
}

std::string setting(const Measured& m) {
  if (m.label("sweep") != "frugal") return "the scene's own";
  return text(m.knob("steps"), 3) + (m.knob("steps") == 1 ? " step" : " steps") + ", tolerance " +
         text(m.knob("tolerance"), 1);
}

// "1 % costs 0.8 s with ...".
Section cost_section(std::span<const Measured> all) {
  Section s{
      "What accuracy costs",
      "The cheapest setting measured that reaches the error, and its processor time on one thread. It counts "
      "only where every finer mesh of the formulation stays below the error too: coarse meshes can be "
      "right by luck. Settings: those of the scene (a Newton tolerance that leaves no trace in the answer, "
      "many steps), or few steps and a looser tolerance."};
  Table t{"", {"problem", "error", "costs [s]", "with", "mesh", "unknowns", "steps and tolerance"}, {}};
  for (const auto& p : label_values(all, "problem")) {
    for (const double error : {0.1, 0.03, 0.01, 0.003, 0.001}) {
      const Measured* best = cheapest(lasting_of_settings(all, p, error), error, processor_seconds);
      if (best)
        t.rows.push_back({p, percent(error), text(best->cpu_seconds, 2), best->label("formulation"),
                          best->label("mesh"), text(best->unknowns(), 6), setting(*best)});
      else
        t.rows.push_back({p, percent(error), "not reached", "", "", "", ""});
    }
  }
  s.tables.push_back(std::move(t));
  return s;
}

// Lines drawn on for decades say no more than that.
std::string guessed(double ratio) {
  return ratio > 1000 ? "beyond 1000 x" : "about " + text(ratio, 2) + " x";
}

// How many times as long as `seconds` these cells take to the error.
std::string times_as_long(const Cells& of, double error, double seconds) {
  if (const auto reached = seconds_at(lasting(of, error), error, processor_seconds))
    return text(*reached / seconds, 2) + " x";
  const Measured* finest = nullptr;
  for (const Measured* m : of) {
    if (m->error && (!finest || m->unknowns() > finest->unknowns())) finest = m;
  }
  if (!finest) return "no answer";
  const auto guess = extrapolated_seconds(of, error, processor_seconds);
  return "more than " + text(finest->cpu_seconds / seconds, 2) + " x, at " + percent(*finest->error) +
         " still" + (guess ? " (" + guessed(*guess / seconds) + ")" : "");
}

// Against what one would take without this engine.
Section gain_section(std::span<const Measured> all) {
  constexpr double error = 0.01;
  Section s{
      "One percent, against plain linear tetrahedra",
      "Processor time at 1 % error of the cheapest setting, and how many times as long one-field Tet4 and "
      "Tet4 with nodal pressure, without and with stabilization, take: with the steps and tolerance of the "
      "scene, and below it with the few steps and the tolerance of the frugal setting. Between two meshes: "
      "read off the line through them in the diagram above. \"more than\": not reached on the finest mesh "
      "measured, which took that much longer; in parentheses when the line through its two finest meshes "
      "would reach it, which is a guess. Where the problem asks for nu = 0.5, one-field bodies run at 0.499 "
      "and nodal pressure without stabilization at 0.4999, where its matrix is not singular."};
  Table t{"", {"problem", "nu", "best [s]", "with", "compared with"}, {}};
  constexpr const char* others[] = {"tet4", "tet4_node_plain", "tet4_node"};
  for (const char* name : others) t.head.emplace_back(formulation(name).label);
  for (const auto& p : label_values(all, "problem")) {
    const Measured* best = cheapest(lasting_of_settings(all, p, error), error, processor_seconds);
    if (!best) continue;
    for (const bool frugal : {false, true}) {
      std::vector<std::string> row{
          p, text(best->knob("nu"), 4), text(best->cpu_seconds, 2),
          best->label("formulation") + ", mesh " + best->label("mesh") + ", " + setting(*best),
          frugal ? "few steps, tolerance " + text(kFrugalTolerance, 1) : "the scene's own settings"};
      if (frugal) row[0] = row[1] = row[2] = row[3] = "";
      const Cells of_problem = where(where(all, "sweep", frugal ? "frugal" : "mesh"), "problem", p);
      for (const char* name : others)
        row.push_back(times_as_long(where(of_problem, "formulation", std::string(formulation(name).label)),
                                    error, best->cpu_seconds));
      t.rows.push_back(std::move(row));
    }
  }
  s.tables.push_back(std::move(t));
  return s;
}

Section profile_section(std::span<const Measured> meshes) {
  Section s{
      "Performance profiles",
      "Over all problems, at 3 % and at 1 % error: the share of problems that a formulation solves within a "
      "factor of the processor time of the best one there (Dolan and Moré 2002). High and left is better; a "
      "line that "
      "ends below 1 does not reach the error on the rest."};
  const auto names = label_values(meshes, "problem");
  for (const double error : {0.03, 0.01}) {
    std::vector<std::vector<double>> costs;
    for (const Formulation& f : formulations()) {
      costs.emplace_back();
      for (const auto& p : names) {
        const auto seconds = seconds_at(
            lasting(where(where(meshes, "problem", p), "formulation", std::string(f.label)), error), error,
            processor_seconds);
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

// The time step alone, and beside it what the mesh leaves.
Section step_section(std::span<const Measured> all) {
  Section s{
      "Which knob buys what: the time step",
      "The swing, one mesh a formulation. Deviation: from the smallest step of BDF2 on the same mesh, so "
      "what the step alone adds; the error also holds that of the mesh, and stops shrinking there."};
  Diagram d{"Deviation against time step", "", "time step [s]", "relative deviation"};
  d.log_x = d.log_y = true;
  Table t{
      "", {"formulation", "scheme", "step [s]", "seconds", "iterations", "deviation", "order", "error"}, {}};
  const Cells sweep = where(all, "sweep", "step");
  for (const auto& f : label_values(all, "formulation")) {
    const Cells of = where(sweep, "formulation", f);
    const Measured* finest = nullptr;
    for (const Measured* m : of) {
      if (m->good() && m->value && m->label("scheme") == "BDF2" &&
          (!finest || m->knob("step") < finest->knob("step")))
        finest = m;
    }
    for (const auto& scheme : label_values(all, "scheme")) {
      Line line{f + ", " + scheme, {}, {}};
      double last = 0;
      for (const Measured* m : where(of, "scheme", scheme)) {
        if (!m->good() || !m->value || !finest) {
          t.failed.push_back(t.rows.size());
          t.rows.push_back({f, scheme, text(m->knob("step")), m->status, "", "", "", ""});
          continue;
        }
        const double deviation = std::abs(*m->value / *finest->value - 1);
        if (m != finest) {
          line.x.push_back(m->knob("step"));
          line.y.push_back(std::max(deviation, 1e-16));
        }
        t.rows.push_back({f, scheme, text(m->knob("step")), text(m->cpu_seconds, 2),
                          std::to_string(m->iterations), m == finest ? "" : percent(deviation),
                          last > 0 && m != finest ? text(std::log2(last / deviation), 2) : "",
                          m->error ? percent(*m->error) : ""});
        last = deviation;
      }
      if (!line.x.empty()) d.lines.push_back(std::move(line));
    }
  }
  s.diagrams.push_back(std::move(d));
  s.tables.push_back(std::move(t));
  return s;
}

Section knobs_section(std::span<const Measured> all) {
  Section s{
      "Which knob buys what: solver and tolerance",
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
    solvers.rows.push_back({m.label("problem"), m.label("formulation"), m.label("solver"),
                            text(m.cpu_seconds, 2), text(m.stages.factor, 2),
                            m.error ? percent(*m.error) : m.reason});
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
        tolerances.rows.push_back({p, f, text(m->knob("tolerance"), 1), text(m->cpu_seconds, 2),
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
  return {cost_section(all),       gain_section(all),  time_section(meshes), unknowns_section(meshes),
          profile_section(meshes), knobs_section(all), step_section(all),    all_cells(all)};
}

}  // namespace

Study accuracy_study() {
  return {"accuracy",
          "What accuracy costs",
          "Relative error against references for processor time: which element, mesh and setting buys the "
          "most accuracy a second.",
          cells,
          present,
          1};
}

}  // namespace isochor::studies
