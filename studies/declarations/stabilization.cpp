// The strength tau of the pressure stabilization: what it does to displacements, pressures and dual solvers.
#include <algorithm>
#include <limits>

#include "studies/analysis.h"
#include "studies/pressure_fields.h"
#include "studies/pressure_tests.h"
#include "studies/problems.h"
#include "studies/study.h"

namespace isochor::studies {

namespace {

constexpr double kTau[] = {0, 0.01, 0.05, 0.25, 1, 4, 16};
constexpr const char* kPairs[] = {"tet4_node", "edge_node"};

void set_tau(SceneDef& scene, double tau) {
  for (VolumeRows& rows : *scene.volumes) rows.def.stabilization = tau;
}

Cell cell_of(const char* part, const Formulation& f, double tau) {
  Cell c;
  c.id = std::string(part) + "/" + std::string(f.name) + "/" + text(tau);
  c.labels = {{"part", part}, {"formulation", std::string(f.label)}};
  c.knobs["tau"] = tau;
  return c;
}

// A cube on the ground under its weight, at nu = 0.5.
SceneDef cube(const Formulation& f, int n) {
  SceneDef s;
  s.name = "cube";
  SceneBody b;
  BoxMeshDef box;
  box.divisions = {n, n, n};
  b.mesh = box;
  MaterialDef m;
  m.constants.mu = 10e3;
  m.constants.bulk = std::numeric_limits<double>::infinity();
  b.materials = {m};
  s.bodies = {b};
  apply(f, s);
  DirichletDef ground;
  ground.name = "ground";
  ground.where.surfaces = {"z0"};
  s.dirichlet = {ground};
  s.analysis.options.gravity = {0, 0, -9.81};
  s.analysis.options.gravity_curve = Curve::ramp(1);
  s.analysis.steps = 1;
  return s;
}

std::vector<Cell> cells(bool quick) {
  std::vector<Cell> out;
  const int n = quick ? 4 : 6;
  const Probe against = pressure_against(cube(formulation("tet10_node"), n));
  for (const double tau : kTau) {
    for (const char* name : kPairs) {
      // Without stabilization the matrix is singular at nu = 0.5.
      if (tau == 0) continue;
      const Formulation& f = formulation(name);
      const Problem& p = problem("cantilever");
      Cell tip = cell_of("tip", f, tau);
      tip.scene = make_scene(p, f, 1);
      set_tau(tip.scene, tau);
      tip.metric = std::string(p.metric);
      tip.reference = p.reference;
      tip.uncertainty = p.uncertainty;
      tip.source = std::string(p.source);
      out.push_back(std::move(tip));
      Cell field = cell_of("pressure", f, tau);
      field.scene = cube(f, n);
      set_tau(field.scene, tau);
      field.probe = against;
      out.push_back(std::move(field));
    }
    for (const int boxes : {2, 4, 6}) {
      if (quick && boxes == 6) continue;
      Cell dual = cell_of("dual", formulation("tet4_node"), tau);
      dual.id += "/" + std::to_string(boxes);
      dual.knobs["n"] = boxes;
      dual.probe = dual_probe(tau, boxes);
      out.push_back(std::move(dual));
    }
  }
  return out;
}

const Measured* find(const Cells& cells, double tau, double n = 0) {
  for (const Measured* m : cells) {
    if (m->knob("tau") == tau && m->knob("n") == n) return m->good() ? m : nullptr;
  }
  return nullptr;
}

Section answers(std::span<const Measured> all) {
  Section s{
      "Displacement and pressure",
      "Tip: the cantilever under a tenth of gravity, 20 x 2 x 2 boxes, against its reference. Pressure: a "
      "cube "
      "glued to the ground under its weight, 6 boxes a side, mean stress of cells against Tet10 with linear "
      "pressure on the same cells (L2), and the roughness of the field. nu = 0.5."};
  Table t{"Errors by tau", {"pair", "tau", "tip", "iterations", "pressure", "roughness"}, {}};
  Diagram d{"Errors by tau", "", "tau", "relative error"};
  d.log_x = d.log_y = true;
  for (const char* name : kPairs) {
    const std::string label(formulation(name).label);
    const Cells tips = where(where(all, "part", "tip"), "formulation", label);
    const Cells fields = where(where(all, "part", "pressure"), "formulation", label);
    Line tip{label + ": tip", {}, {}}, pressure{label + ": pressure", {}, {}};
    for (const double tau : kTau) {
      const Measured *a = find(tips, tau), *b = find(fields, tau);
      if (!a && !b) continue;
      t.rows.push_back({label, text(tau), a && a->error ? percent(*a->error) : "",
                        a ? std::to_string(a->iterations) : "", b ? percent(b->number("pressure error")) : "",
                        b ? text(b->number("roughness")) : ""});
      if (a && a->error) {
        tip.x.push_back(tau);
        tip.y.push_back(*a->error);
      }
      if (b) {
        pressure.x.push_back(tau);
        pressure.y.push_back(b->number("pressure error"));
      }
    }
    d.lines.push_back(std::move(tip));
    d.lines.push_back(std::move(pressure));
  }
  s.diagrams = {std::move(d)};
  s.tables = {std::move(t)};
  return s;
}

Section dual(std::span<const Measured> all) {
  Section s{"Dual convergence",
            "S = G K^-1 G^T + C of nodal rows on Tet4 at rest and nu = 0.5, on a cube of n^3 boxes held at "
            "one side, "
            "preconditioned with the diagonal of M_p / mu: its condition number, and iterations of conjugate "
            "gradients "
            "to 1e-9. What a dual solver feels; steepest ascent takes about the condition number times ten."};
  Table t{"Condition and iterations", {"tau"}, {}};
  const Cells part = where(all, "part", "dual");
  std::vector<double> sizes;
  for (const Measured* m : part) {
    if (std::find(sizes.begin(), sizes.end(), m->knob("n")) == sizes.end()) sizes.push_back(m->knob("n"));
  }
  for (const double n : sizes) {
    t.head.push_back("condition, n = " + text(n));
    t.head.push_back("iterations");
  }
  for (const double tau : kTau) {
    std::vector<std::string> row{text(tau)};
    for (const double n : sizes) {
      const Measured* m = find(part, tau, n);
      const bool finite = m && m->values.count("condition") > 0;
      row.push_back(!m ? "" : finite ? text(m->number("condition")) : "singular");
      row.push_back(!m                                ? ""
                    : m->number("iterations") >= 1000 ? "none in 1000"
                                                      : text(m->number("iterations"), 4));
    }
    t.rows.push_back(std::move(row));
  }
  s.tables = {std::move(t)};
  return s;
}

std::vector<Section> present(std::span<const Measured> all) {
  return {answers(all), dual(all), all_cells(all)};
}

}  // namespace

Study stabilization_study() {
  return {"stabilization", "Pressure stabilization",
          "What the strength tau of the stabilization does to displacements, to pressures and to solvers of "
          "the dual.",
          cells, present};
}

}  // namespace isochor::studies
