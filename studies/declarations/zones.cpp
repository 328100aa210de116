// Zones from the whole body down to single elements: stiffness, iterations, time.
#include <cmath>
#include <limits>

#include "scenes/library.h"
#include "studies/analysis.h"
#include "studies/formulations.h"
#include "studies/study.h"

namespace isochor::studies {

namespace {

constexpr double kShear = 90e3, kPoisson = 0.4999;

// The beam of Sheen, Larionov & Pai (2021, figure 5): 16 x 4 x 4 nodes, held at the left, under gravity.
SceneDef beam() {
  SceneDef s;
  s.name = "zones";
  SceneBody b;
  BoxMeshDef box;
  box.upper = {1, 0.2, 0.2};
  box.divisions = {15, 3, 3};
  b.mesh = box;
  b.element = Element::tet4;
  MaterialDef m;
  m.law = MaterialLaw::isochoric_extended;
  m.constants.mu = kShear;
  m.constants.bulk = 2 * kShear * (1 + kPoisson) / (3 * (1 - 2 * kPoisson));
  m.density = 1000;
  b.materials = {m};
  s.bodies = {b};
  DirichletDef wall;
  wall.name = "wall";
  wall.where.surfaces = {"x0"};
  s.dirichlet = {wall};
  s.analysis.options.gravity = {0, 0, -9.81};
  s.analysis.options.gravity_curve = Curve::ramp(1);
  s.analysis.steps = 1;
  s.analysis.options.max_iterations = 200;
  s.probes = {{"tip", {}, {1, 0.1, 0.1}}};
  MetricDef tip;
  tip.name = "tip down";
  tip.of = "tip";
  tip.component = Component::z;
  tip.unit = "m";
  s.metrics = {tip};
  return s;
}

struct Variant {
  const char* name;
  VolumeSpace space;
  int rings;
  bool penalty;
};
constexpr Variant kVariants[] = {
    {"whole body", VolumeSpace::body, 1, false},
    {"4 rings", VolumeSpace::ring, 4, false},
    {"2 rings", VolumeSpace::ring, 2, false},
    {"1 ring", VolumeSpace::ring, 1, false},
    {"whole body and penalty", VolumeSpace::body, 1, true},
    {"per element", VolumeSpace::element, 1, false},
};

std::vector<Cell> cells(bool quick) {
  std::vector<Cell> out;
  for (const Variant& v : kVariants) {
    if (quick && v.rings == 4) continue;
    Cell c;
    c.id = v.name;
    c.labels = {{"zones", v.name}};
    c.scene = beam();
    VolumeRows rows;
    rows.def.space = v.space;
    rows.def.rings = v.rings;
    c.scene.volumes = {rows};
    if (v.penalty) {
      // lambda of nu = 0.45, as in the paper.
      c.scene.bodies[0].materials[0].compression_penalty = {2 * kShear * 0.45 / (1 - 2 * 0.45), 9};
    }
    c.metric = "tip down";
    out.push_back(std::move(c));
  }
  // What the beam does, on the same cells with a quadratic element.
  Cell reference;
  reference.id = "Tet10, linear pressure";
  reference.labels = {{"zones", "(Tet10, linear pressure)"}};
  reference.scene = beam();
  apply(formulation("tet10_node"), reference.scene);
  reference.metric = "tip down";
  out.push_back(std::move(reference));
  return out;
}

std::vector<Section> present(std::span<const Measured> all) {
  Section s{
      "Zones and stiffness",
      "A beam of 1 x 0.2 x 0.2 m, 15 x 3 x 3 boxes of Tet4, held at one end under its weight; extended "
      "isochoric energy, nu = 0.4999 (at 0.5 rings on this regular mesh depend on each other). The smaller "
      "the zones, the stiffer. The penalty has the modulus of nu = 0.45 and beta = 9. Seconds of all "
      "iterations, one load step."};
  Table t{"Tip, iterations, time",
          {"zones", "rows", "tip [m]", "iterations", "seconds", "CPU [s]", "matrix non-zeros",
           "factor non-zeros", "smallest J", "largest J"},
          {}};
  Bars bars{"Deflection of the tip", "m", {}};
  for (const Measured& m : all) {
    if (!m.good() || !m.value) {
      t.failed.push_back(t.rows.size());
      t.rows.push_back({m.label("zones"), m.status + " " + m.reason});
      t.rows.back().resize(t.head.size());
      continue;
    }
    t.rows.push_back({m.label("zones"), std::to_string(m.multipliers), text(*m.value, 4),
                      std::to_string(m.iterations), text(m.seconds), text(m.cpu_seconds),
                      std::to_string(m.nonzeros), std::to_string(m.factor_nonzeros), text(m.number("min J")),
                      text(m.number("max J"))});
    bars.bars.push_back({m.label("zones"), {{"tip", -*m.value}}});
  }
  s.bars = {std::move(bars)};
  s.tables = {std::move(t)};
  return {s, all_cells(all)};
}

}  // namespace

Study zones_study() {
  return {
      "zones", "Zones of volume",
      "How stiff a beam is with volume rows from the whole body down to single elements, and what they cost.",
      cells, present};
}

}  // namespace isochor::studies
