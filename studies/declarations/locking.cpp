// Locking: the tip of a beam against Poisson's ratio, the inf-sup test and the roughness of pressures.
#include <algorithm>
#include <cmath>

#include "studies/analysis.h"
#include "studies/locking_robots.h"
#include "studies/pressure_tests.h"
#include "studies/problems.h"
#include "studies/study.h"

namespace isochor::studies {

namespace {

constexpr const char* kSource = "Taylor-Hood (dolfinx 0.5.2), kappa = K; docs/reference.md";

struct BeamReference {
  double nu, tip, uncertainty;
};
// Tip of the cantilever under a tenth of gravity [m].
constexpr BeamReference kBeam[] = {{0.3, -0.4707, 1e-4}, {0.49, -0.4767, 1e-4}, {0.5, -0.4763, 1e-4}};

void add_tips(std::vector<Cell>& out, bool quick) {
  const Problem& p = problem("cantilever");
  for (const Formulation& f : formulations()) {
    // The mesh of 480 tets (quick) or 3,840; Tet10 one level coarser, at about the same unknowns.
    const std::size_t level = quick ? 1 : f.quadratic() ? 2 : 3;
    for (const double nu : {0.3, 0.4, 0.45, 0.49, 0.499, 0.4999, 0.5}) {
      if (quick && (nu == 0.4 || nu == 0.4999)) continue;
      // Refused by design: its energy is infinite there.
      if (f.one_field && nu == 0.5) continue;
      Cell c;
      c.id = "tip/" + std::string(f.name) + "/" + text(nu, 4);
      c.labels = {{"part", "tip"}, {"formulation", std::string(f.label)}};
      c.knobs["nu"] = nu;
      c.scene = make_scene(p, f, level);
      set_poisson(c.scene, nu);
      c.metric = std::string(p.metric);
      for (const BeamReference& r : kBeam) {
        if (r.nu != nu) continue;
        c.reference = r.tip;
        c.uncertainty = r.uncertainty / std::abs(r.tip);
        c.source = kSource;
      }
      c.guarded = quick && (nu == 0.3 || nu == 0.499) && f.name != "tet4_node_plain" && f.name != "tet10";
      out.push_back(std::move(c));
    }
  }
}

void add_inf_sup(std::vector<Cell>& out, bool quick) {
  for (const Formulation& f : formulations()) {
    // One row a body cannot be unstable.
    if (f.one_field || f.space == VolumeSpace::body) continue;
    for (const int n : {2, 3, 4, 6}) {
      if (n == 6 && (quick || f.quadratic())) continue;
      Cell c;
      c.id = "inf_sup/" + std::string(f.name) + "/" + std::to_string(n);
      c.labels = {{"part", "inf-sup"}, {"formulation", std::string(f.label)}};
      c.knobs["n"] = n;
      c.probe = inf_sup_probe(f, n);
      c.guarded = n == 2;
      out.push_back(std::move(c));
    }
  }
}

void add_roughness(std::vector<Cell>& out, bool quick) {
  for (const char* name : {"cantilever", "cook"}) {
    const Problem& p = problem(name);
    for (const Formulation& f : formulations()) {
      if (level_count(p, f) == 0) continue;
      Cell c;
      const std::size_t level = quick ? 0 : 1;
      c.id = "roughness/" + std::string(name) + "/" + std::string(f.name);
      c.labels = {
          {"part", "roughness"}, {"formulation", std::string(f.label)}, {"problem", std::string(p.title)}};
      c.scene = make_scene(p, f, level);
      c.probe = pressure_roughness;
      c.guarded = f.name == "edge_node" || f.name == "tet10_node";
      out.push_back(std::move(c));
    }
  }
}

std::vector<Cell> cells(bool quick) {
  std::vector<Cell> out;
  add_tips(out, quick);
  add_inf_sup(out, quick);
  add_roughness(out, quick);
  add_robot_locking(out, quick);
  return out;
}

std::string nu_text(double nu) {
  return text(nu, 4);
}

Section tip_section(std::span<const Measured> all) {
  Section s{
      "Tip against Poisson's ratio",
      "Cantilever of 0.1 x 0.1 x 1 m under a tenth of gravity, kappa = K as in the references. A formulation "
      "that locks stiffens as the ratio goes to 0.5; one that is merely stiff in bending is off by the same "
      "amount at every ratio."};
  const Cells tips = where(all, "part", "tip");
  Diagram d{"Tip displacement over the reference at 0.5", "", "1 / (1 - 2 nu)", "share of the reference"};
  d.log_x = true;
  std::vector<double> ratios;
  for (const Measured* m : tips) {
    if (std::find(ratios.begin(), ratios.end(), m->knob("nu")) == ratios.end())
      ratios.push_back(m->knob("nu"));
  }
  std::sort(ratios.begin(), ratios.end());
  Table t{"Vertical displacement of the tip [m]", {"formulation", "unknowns"}, {}};
  for (const double nu : ratios) t.head.push_back("nu = " + nu_text(nu));
  t.rows.push_back({"reference", ""});
  for (const double nu : ratios) {
    const auto r =
        std::find_if(std::begin(kBeam), std::end(kBeam), [&](const auto& b) { return b.nu == nu; });
    t.rows.back().push_back(r == std::end(kBeam) ? "" : text(r->tip, 4));
  }
  // 0.5 is at infinity: drawn a decade beyond the last.
  const auto place = [](double nu) { return nu >= 0.5 ? 5e4 : 1 / (1 - 2 * nu); };
  for (const Formulation& f : formulations()) {
    Line line{std::string(f.label), {}, {}};
    std::vector<std::string> row{std::string(f.label), ""};
    for (const double nu : ratios) {
      std::string entry = f.one_field && nu == 0.5 ? "not defined" : "";
      for (const Measured* m : where(tips, "formulation", std::string(f.label))) {
        if (m->knob("nu") != nu) continue;
        entry = m->good() && m->value ? text(*m->value, 4) : m->status;
        row[1] = std::to_string(m->displacements) + " + " + std::to_string(m->multipliers);
        if (!m->good() || !m->value) continue;
        line.x.push_back(place(nu));
        line.y.push_back(*m->value / kBeam[2].tip);
        line.hints.push_back("nu = " + nu_text(nu));
      }
      row.push_back(entry);
    }
    t.rows.push_back(std::move(row));
    if (!line.x.empty()) d.lines.push_back(std::move(line));
  }
  d.text = "The point at 50,000 stands for nu = 0.5.";
  s.diagrams.push_back(std::move(d));
  s.tables.push_back(std::move(t));
  return s;
}

Section inf_sup_section(std::span<const Measured> all) {
  Section s{
      "Numerical inf-sup test",
      "Smallest generalized singular value beta of the volume rows, at rest, on a unit cube of n^3 boxes "
      "held "
      "at one side: G K^-1 G^T + C p = beta^2 M_p / mu p, with the stabilization as C. A stable pair keeps "
      "beta away from zero as the mesh is refined; zero is a spurious pressure mode."};
  Diagram d{"beta against mesh", "", "boxes a side", "beta"};
  d.log_x = d.log_y = true;
  Table t{"beta, and the number of modes with beta < 1e-6", {"formulation"}, {}};
  const Cells part = where(all, "part", "inf-sup");
  std::vector<double> sizes;
  for (const Measured* m : part) {
    if (std::find(sizes.begin(), sizes.end(), m->knob("n")) == sizes.end()) sizes.push_back(m->knob("n"));
  }
  for (const double n : sizes) t.head.push_back("n = " + text(n));
  for (const Formulation& f : formulations()) {
    Line line{std::string(f.label), {}, {}};
    std::vector<std::string> row{std::string(f.label)};
    for (const double n : sizes) {
      std::string entry;
      for (const Measured* m : where(part, "formulation", std::string(f.label))) {
        if (m->knob("n") != n) continue;
        entry = m->good() ? text(m->number("beta")) + " (" + text(m->number("zero modes")) + ")" : "refused";
        if (!m->good()) continue;
        line.x.push_back(n);
        line.y.push_back(std::max(m->number("beta"), 1e-9));
      }
      row.push_back(entry);
    }
    if (line.x.empty()) continue;
    t.rows.push_back(std::move(row));
    d.lines.push_back(std::move(line));
  }
  s.diagrams.push_back(std::move(d));
  s.tables.push_back(std::move(t));
  return s;
}

Section roughness_section(std::span<const Measured> all) {
  Section s{
      "Roughness of the pressure",
      "Root mean square of the jump of tr(sigma)/3 between cells that share a face, over its root mean "
      "square: "
      "checkerboards show as values near or above 1. Coarse meshes jump for good reasons too, so compare "
      "formulations on the same problem."};
  const Cells part = where(all, "part", "roughness");
  Bars bars{"Jump over magnitude", "", {}};
  for (const Measured* m : part) {
    if (!m->good()) continue;
    bars.bars.push_back(
        {m->label("problem") + ": " + m->label("formulation"), {{"jump", m->number("roughness")}}});
  }
  s.bars.push_back(std::move(bars));
  return s;
}

std::vector<Section> present(std::span<const Measured> all) {
  return {tip_section(all),     spine_section(all),     tube_section(all),
          inf_sup_section(all), roughness_section(all), all_cells(all)};
}

}  // namespace

Study locking_study() {
  return {
      "locking",
      "Locking",
      "Which formulations stiffen as the material becomes incompressible, which pairs of displacement and "
      "pressure are stable, and how smooth their pressures are.",
      cells,
      present,
      0};
}

}  // namespace isochor::studies
