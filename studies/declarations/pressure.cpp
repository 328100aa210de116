// Fields of pressure under gravity: a confined column with a closed form, and a cube that stands free.
#include <cmath>
#include <limits>

#include "scenes/library.h"
#include "studies/analysis.h"
#include "studies/formulations.h"
#include "studies/pressure_fields.h"
#include "studies/study.h"

namespace isochor::studies {

namespace {

constexpr double kShear = 10e3;

SceneDef block(const Vec3& upper, std::array<int, 3> divisions, MaterialLaw law = MaterialLaw::neo_hookean) {
  SceneDef s;
  s.name = "block";
  SceneBody b;
  BoxMeshDef box;
  box.upper = upper;
  box.divisions = divisions;
  b.mesh = box;
  MaterialDef m;
  m.law = law;
  m.constants.mu = kShear;
  m.constants.bulk = std::numeric_limits<double>::infinity();
  b.materials = {m};
  s.bodies = {b};
  s.analysis.options.gravity = {0, 0, -9.81};
  s.analysis.options.gravity_curve = Curve::ramp(1);
  s.analysis.steps = 1;
  return s;
}

DirichletDef hold(const char* surface, std::vector<Vec3> directions) {
  DirichletDef d;
  d.name = surface;
  d.where.surfaces = {surface};
  d.directions = std::move(directions);
  return d;
}

void add_columns(std::vector<Cell>& out, bool quick) {
  for (const char* name : {"tet4_node", "edge_node", "tet10_node"}) {
    for (const int n : {4, 8, 16}) {
      if (n == 16 && quick) continue;
      const Formulation& f = formulation(name);
      Cell c;
      c.id = "column/" + std::string(name) + "/" + std::to_string(n);
      c.labels = {{"part", "column"}, {"formulation", std::string(f.label)}};
      c.knobs["n"] = n;
      c.scene = block({0.25, 0.25, 1}, {n / 4, n / 4, n});
      apply(f, c.scene);
      c.scene.dirichlet = {hold("x0", {{1, 0, 0}}), hold("x1", {{1, 0, 0}}), hold("y0", {{0, 1, 0}}),
                           hold("y1", {{0, 1, 0}}), hold("z0", {{0, 0, 1}})};
      c.probe = column_pressure;
      out.push_back(std::move(c));
    }
  }
}

SceneDef cube(bool glued, const char* formulation_name, int n, MaterialLaw law = MaterialLaw::neo_hookean) {
  SceneDef s = block({1, 1, 1}, {n, n, n}, law);
  apply(formulation(formulation_name), s);
  s.dirichlet = {hold("z0", glued ? std::vector<Vec3>{} : std::vector<Vec3>{{0, 0, 1}})};
  if (glued) return s;
  // On a smooth ground: two nodes keep it from sliding off and from turning.
  DirichletDef middle, side;
  middle.name = "middle";
  middle.where.nearest = {{0.5, 0.5, 0}};
  middle.directions = {{1, 0, 0}, {0, 1, 0}};
  side.name = "turn";
  side.where.nearest = {{1, 0.5, 0}};
  side.directions = {{0, 1, 0}};
  s.dirichlet.push_back(middle);
  s.dirichlet.push_back(side);
  return s;
}

void add_cubes(std::vector<Cell>& out, bool quick, bool glued) {
  const int n = quick ? 4 : 8;
  const std::string part = glued ? "glued" : "smooth";
  const Probe against = pressure_against(cube(glued, "tet10_node", n));
  const auto add = [&](const char* name, SceneDef scene) {
    Cell c;
    c.id = part + "/" + name;
    c.labels = {{"part", part}, {"formulation", name}};
    c.knobs["n"] = n;
    c.scene = std::move(scene);
    c.probe = against;
    out.push_back(std::move(c));
  };
  add("Tet10, linear pressure (the reference)", cube(glued, "tet10_node", n));
  add("Tet4 edge-smoothed, nodal pressure", cube(glued, "edge_node", n));
  add("Tet4, nodal pressure", cube(glued, "tet4_node", n));
  // At nu = 0.5 its matrix is singular; close to it the checkerboard is there to be seen.
  SceneDef plain = cube(glued, "tet4_node_plain", n);
  set_poisson(plain, 0.4999);
  add("Tet4, nodal pressure, not stabilized, nu = 0.4999", plain);
  SceneDef element = cube(glued, "tet4_element", n);
  set_poisson(element, 0.4999);
  add("Tet4, pressure per element, nu = 0.4999", element);
  SceneDef one_field = cube(glued, "tet4", n);
  set_poisson(one_field, 0.495);
  add("Tet4, one field, nu = 0.495", one_field);
  for (const bool penalty : {false, true}) {
    SceneDef whole = cube(glued, "tet4", n, MaterialLaw::isochoric_extended);
    set_poisson(whole, 0.5);
    VolumeRows rows;
    rows.def.space = VolumeSpace::body;
    whole.volumes = {rows};
    // lambda of nu = 0.45, as in the paper.
    if (penalty) whole.bodies[0].materials[0].compression_penalty = {2 * kShear * 0.45 / (1 - 2 * 0.45), 9};
    add(penalty ? "Tet4, whole-body zone and penalty" : "Tet4, whole-body zone", whole);
  }
}

std::vector<Cell> cells(bool quick) {
  std::vector<Cell> out;
  add_columns(out, quick);
  add_cubes(out, quick, false);
  add_cubes(out, quick, true);
  return out;
}

Section column_section(std::span<const Measured> all) {
  Section s{
      "A confined column",
      "0.25 x 0.25 x 1 m, mu = 10 kPa, nu = 0.5, rho = 1000, sliding on its walls and its base: it cannot "
      "move, and tr(sigma)/3 = -rho g depth. Error of the mean stress of cells in L2, order between "
      "neighboring meshes, largest displacement over the height."};
  Table t{"Error of the pressure", {"formulation", "cells of depth", "error", "order", "sinking"}, {}};
  Diagram d{"Error of the pressure", "", "cells of depth", "relative L2 error"};
  d.log_x = d.log_y = true;
  const Cells part = where(all, "part", "column");
  for (const std::string& name : label_values(all, "formulation")) {
    Line line{name, {}, {}};
    const Measured* last = nullptr;
    for (const Measured* m : where(part, "formulation", name)) {
      if (!m->good()) {
        t.failed.push_back(t.rows.size());
        t.rows.push_back({name, text(m->knob("n")), m->reason, "", ""});
        continue;
      }
      const double e = m->number("pressure error");
      std::string order;
      if (last && e > 1e-9) {
        order = text(std::log(last->number("pressure error") / e) / std::log(m->knob("n") / last->knob("n")));
      }
      t.rows.push_back({name, text(m->knob("n")), text(e), order, text(m->number("sinking"))});
      line.x.push_back(m->knob("n"));
      line.y.push_back(std::max(e, 1e-12));
      last = m;
    }
    if (!line.x.empty()) d.lines.push_back(std::move(line));
  }
  s.diagrams = {std::move(d)};
  s.tables = {std::move(t)};
  return s;
}

Section cube_section(std::span<const Measured> all, bool glued) {
  Section s{
      glued ? "A cube that is glued to the ground" : "A cube that stands on smooth ground",
      "1 m, mu = 10 kPa, nu = 0.5 where not said otherwise, under its own weight. At the edges of a glued "
      "base the stress is singular. "
      "Distance of the mean stress of cells from that of Tet10 with linear pressure on the same cells (L2), "
      "and roughness: the jump of the mean stress across faces over its size."};
  Table t{"Mean stress",
          {"formulation", "error", "roughness", "least [Pa]", "largest [Pa]", "volume", "iterations"},
          {}};
  Bars bars{"Roughness", "", {}};
  for (const Measured* m : where(all, "part", glued ? "glued" : "smooth")) {
    const std::string name = m->label("formulation");
    if (!m->good()) {
      t.failed.push_back(t.rows.size());
      t.rows.push_back({name, m->reason});
      t.rows.back().resize(t.head.size());
      continue;
    }
    t.rows.push_back({name, percent(m->number("pressure error")), text(m->number("roughness")),
                      text(m->number("least"), 4), text(m->number("largest"), 4),
                      text(m->number("volume"), 2), text(m->number("iterations"), 4)});
    bars.bars.push_back({name, {{"jump", m->number("roughness")}}});
  }
  s.bars = {std::move(bars)};
  s.tables = {std::move(t)};
  return s;
}

std::vector<Section> present(std::span<const Measured> all) {
  return {column_section(all), cube_section(all, false), cube_section(all, true), all_cells(all)};
}

}  // namespace

Study pressure_study() {
  return {"pressure", "Fields of pressure",
          "How right and how smooth the pressure is that a body carries under its weight.", cells, present};
}

}  // namespace isochor::studies
