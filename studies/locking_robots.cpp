#include "studies/locking_robots.h"

#include <algorithm>
#include <array>

#include "scenes/library.h"
#include "studies/analysis.h"
#include "studies/formulations.h"

namespace isochor::studies {

namespace {

// What the paper reports for a spine of its own design with 1,778 tets [cm].
struct Reported {
  double nu, mixed, standard;
};
constexpr std::array<Reported, 4> kReported{
    {{0.49, 14.6, 11.2}, {0.499, 14.0, 6.3}, {0.4999, 13.8, 2.4}, {0.49999, 13.8, 0.8}}};
constexpr std::array kSpineMeshes{"spine_1", "spine", "spine_3"};
constexpr double kSpineMeshPoisson = 0.4999;

Cell spine_cell(const Formulation& f, const char* mesh, double nu) {
  SceneVariant variant;
  variant.mesh = mesh;
  variant.element = f.element;
  Cell c;
  c.id = "spine/" + std::string(f.name) + "/" + mesh + "/" + text(nu, 5);
  c.labels = {{"part", "spine"}, {"formulation", std::string(f.label)}, {"mesh", mesh}};
  c.knobs["nu"] = nu;
  c.scene = spine(variant);
  apply(f, c.scene);
  set_poisson(c.scene, nu);
  c.metric = "tip down";
  return c;
}

Cell tube_cell(const Formulation& f, double nu) {
  SceneVariant variant;
  if (f.hexahedra()) variant.mesh = "tube_hex";
  variant.element = f.element;
  Cell c;
  c.id = "tube/" + std::string(f.name) + "/" + text(nu, 5);
  c.labels = {{"part", "tube"}, {"formulation", std::string(f.label)}};
  c.knobs["nu"] = nu;
  c.scene = tube(variant);
  apply(f, c.scene);
  set_poisson(c.scene, nu);
  c.metric = "widening inside";
  return c;
}

bool main_one(const Formulation& f) {
  return f.name == "tet4" || f.name == "tet4_node" || f.name == "edge_node" || f.name == "tet10_node";
}

std::string deflection(const Cells& cells, const Formulation& f, double nu, double scale) {
  for (const Measured* m : where(cells, "formulation", std::string(f.label))) {
    if (m->knob("nu") == nu) return m->good() && m->value ? text(scale * *m->value) : m->status;
  }
  return "";
}

}  // namespace

void add_robot_locking(std::vector<Cell>& out, bool quick) {
  for (const Formulation& f : formulations()) {
    if (f.hexahedra() || (quick && !main_one(f))) continue;
    for (const Reported& r : kReported) {
      if (quick && r.nu != 0.49 && r.nu != kSpineMeshPoisson) continue;
      out.push_back(spine_cell(f, quick ? kSpineMeshes.front() : "spine", r.nu));
    }
    if (quick) continue;
    for (const char* mesh : kSpineMeshes) {
      // A one-field Tet10 takes hundreds of iterations on the finest; the middle one is above.
      if (std::string_view(mesh) == "spine" || (f.name == "tet10" && mesh == kSpineMeshes.back())) continue;
      out.push_back(spine_cell(f, mesh, kSpineMeshPoisson));
    }
  }
  for (const Formulation& f : formulations()) {
    if (quick && !main_one(f)) continue;
    for (const double nu : {0.3, 0.45, 0.49, 0.499, 0.4999, 0.5}) {
      if (quick && nu != 0.3 && nu != 0.4999) continue;
      if (f.one_field && nu == 0.5) continue;
      out.push_back(tube_cell(f, nu));
    }
  }
}

Section spine_section(std::span<const Measured> all) {
  Section s{"A spine arm under its weight",
            "Table 2 and figures 2 and 10 of Francu et al. 2021 on a spine arm of our own design (theirs is "
            "not published; E = 266 kPa, 1,070 kg/m^3): the tip goes down by centimeters that a body which "
            "locks does not show. Hexahedra are not there, the arm has no mesh of them."};
  const Cells part = where(all, "part", "spine");
  Table t{"Tip down [cm], by Poisson's ratio", {"formulation"}, {}};
  for (const Reported& r : kReported) t.head.push_back("nu = " + text(r.nu, 5));
  const bool full = !where(part, "mesh", "spine").empty();
  const std::string mesh = full ? "spine" : kSpineMeshes.front();
  const Cells by_ratio = where(part, "mesh", mesh);
  for (const Formulation& f : formulations()) {
    std::vector<std::string> row{std::string(f.label)};
    bool any = false;
    for (const Reported& r : kReported) {
      row.push_back(deflection(by_ratio, f, r.nu, -100));
      any = any || !row.back().empty();
    }
    if (any) t.rows.push_back(std::move(row));
  }
  for (const bool mixed : {true, false}) {
    t.rows.push_back({mixed ? "reported: mixed (their arm)" : "reported: standard (their arm)"});
    for (const Reported& r : kReported) t.rows.back().push_back(text(mixed ? r.mixed : r.standard));
  }
  Diagram d{"Tip against unknowns, nu = 0.4999", "", "unknowns", "tip down [cm]"};
  d.log_x = true;
  for (const Formulation& f : formulations()) {
    Line line{std::string(f.label), {}, {}};
    for (const char* level : kSpineMeshes) {
      for (const Measured* m : where(where(part, "formulation", line.name), "mesh", level)) {
        if (m->knob("nu") != kSpineMeshPoisson || !m->good() || !m->value) continue;
        line.x.push_back(m->unknowns());
        line.y.push_back(-100 * *m->value);
        line.hints.push_back(level);
      }
    }
    if (!line.x.empty()) d.lines.push_back(std::move(line));
  }
  s.diagrams.push_back(std::move(d));
  s.tables.push_back(std::move(t));
  return s;
}

Section tube_section(std::span<const Measured> all) {
  Section s{
      "An inflated tube",
      "Figure 11 of Francu et al. 2021: how much wider the inside of a tube becomes at 10 kPa "
      "(E = 90 kPa, kappa = K), against Poisson's ratio. Linear meshes are polyhedra inside and outside "
      "of the round tube; Tet10 is raised from the same mesh."};
  const Cells part = where(all, "part", "tube");
  Diagram d{"Widening of the inside, half-way along", "The point at 50,000 stands for nu = 0.5.",
            "1 / (1 - 2 nu)", "widening [mm]"};
  d.log_x = true;
  std::vector<double> ratios;
  for (const Measured* m : part) {
    if (std::find(ratios.begin(), ratios.end(), m->knob("nu")) == ratios.end())
      ratios.push_back(m->knob("nu"));
  }
  std::sort(ratios.begin(), ratios.end());
  Table t{"Widening [mm]", {"formulation"}, {}};
  for (const double nu : ratios) t.head.push_back("nu = " + text(nu, 4));
  for (const Formulation& f : formulations()) {
    Line line{std::string(f.label), {}, {}};
    for (const Measured* m : where(part, "formulation", line.name)) {
      if (!m->good() || !m->value) continue;
      line.x.push_back(m->knob("nu") >= 0.5 ? 5e4 : 1 / (1 - 2 * m->knob("nu")));
      line.y.push_back(1e3 * *m->value);
    }
    std::vector<std::string> row{std::string(f.label)};
    bool any = false;
    for (const double nu : ratios) {
      row.push_back(deflection(part, f, nu, 1e3));
      any = any || !row.back().empty();
    }
    if (any) t.rows.push_back(std::move(row));
    if (!line.x.empty()) d.lines.push_back(std::move(line));
  }
  s.diagrams.push_back(std::move(d));
  s.tables.push_back(std::move(t));
  return s;
}

}  // namespace isochor::studies
