// Cases of Francu et al. 2021.
#include <algorithm>

#include "studies/formulations.h"
#include "studies/paper_cases.h"
#include "studies/problems.h"

namespace isochor::studies {

namespace {

constexpr const char* kPercent = "%";

// Figure 12: a cube of 0.2 m of 10,368 tets under a pressure on its top, which is held from sliding.
SceneDef cube(bool quick, double poisson, double pressure) {
  const int n = quick ? 4 : 12;
  SceneDef s = paper_block("cube", {0.2, 0.2, 0.2}, {n, n, n}, 66e3, poisson);
  s.dirichlet = {paper_hold("table", "z0"), paper_hold("plate", "z1", {{1, 0, 0}, {0, 1, 0}})};
  TractionDef load;
  load.name = "load";
  load.surface = "z1";
  load.traction = {0, 0, -pressure};
  load.amount = Curve::ramp(1);
  s.tractions = {load};
  s.analysis.steps = 10;
  s.probes = {{"top", {}, {0.1, 0.1, 0.2}}};
  MetricDef top;
  top.name = "top";
  top.of = "top";
  top.component = Component::z;
  s.metrics = {top};
  watch_volume(s);
  return s;
}

void add_cubes(std::vector<PaperCase>& out, bool quick) {
  const ShownNumber top{"top sinks by", "top", -1e3, "mm", ""},
      lost{"change of volume", "volume", 100, kPercent, ""},
      iterations{"iterations", "iterations", 1, "", ""};
  for (const double kilopascal : {15.0, 50.0}) {
    const std::string name = "cube under " + text(kilopascal) + " kPa", id = "cube/" + text(kilopascal) + "/";
    const char* figure = kilopascal < 20 ? "12 a, b" : "12 c, d";
    const SceneDef scene = cube(quick, 0.4999, 1e3 * kilopascal);
    for (const char* f : {"tet4", "tet4_node_plain", "tet4_node", "edge_node"}) {
      PaperCase c = paper_case(id + f, figure, name, f, scene, {top, lost, iterations});
      if (std::string_view(f) == "tet4")
        c.shown[2].stated = kilopascal < 20 ? "solved" : "no stable simulation above 15 kPa";
      out.push_back(std::move(c));
    }
    SceneDef coarse = scene;
    std::get<BoxMeshDef>(coarse.bodies[0].mesh).divisions = {quick ? 2 : 6, quick ? 2 : 6, quick ? 2 : 6};
    set_poisson(coarse, 0.5);
    out.push_back(paper_case(id + "tet10_node", figure, name + ", nu = 0.5", "tet10_node", coarse,
                             {top, lost, iterations}));
  }
  for (const bool logarithmic : {true, false}) {
    PaperCase c =
        paper_case(std::string("cube/rows/") + (logarithmic ? "log" : "linear"), "section 9",
                   std::string("cube under 50 kPa, nu = 0.4, rows of ") + (logarithmic ? "log J" : "J - 1"),
                   "tet4_node_plain", cube(quick, 0.4, 50e3), {lost, iterations});
    c.cell.scene.volumes->front().def.strain = logarithmic ? VolumeStrain::logarithmic : VolumeStrain::linear;
    c.shown[0].stated = logarithmic ? "-13 %" : "-14.5 %";
    out.push_back(std::move(c));
  }
}

// Figure 13: a cylinder drawn to twice its length, both ends held; a square bar of 7,680 tets here.
void add_bars(std::vector<PaperCase>& out, bool quick) {
  const int n = quick ? 3 : 8;
  SceneDef s = paper_block("bar", {0.2, 0.08, 0.08}, {5 * n / 2, n, n}, 66e3, 0.4999);
  DirichletDef end = paper_hold("end", "x1");
  end.displacement = {0.2, 0, 0};
  end.amount = Curve::ramp(1);
  s.dirichlet = {paper_hold("wall", "x0"), end};
  s.analysis.steps = 20;
  watch_volume(s);
  const auto add = [&](const char* f, double poisson, const char* stated) {
    SceneDef scene = s;
    set_poisson(scene, poisson);
    out.push_back(paper_case(
        "bar/" + std::string(f) + "/" + text(poisson, 4), "13",
        "bar drawn to twice its length, nu = " + text(poisson, 4), f, scene,
        {{"change of volume", "volume", 100, kPercent, stated}, {"iterations", "iterations", 1, "", ""}}));
  };
  add("tet4", 0.49, "1.8 %");
  add("tet4_node_plain", 0.4999, "0.015 %");
  add("edge_node", 0.4999, "");
  add("edge_node", 0.5, "");
  add("tet10_node", 0.5, "");
}

// Figure 14: a cube of 15 cells a side whose top turns by a quarter and by half a turn, nu = 0.45.
void add_twists(std::vector<PaperCase>& out, bool quick) {
  const int n = quick ? 4 : 15;
  for (const int degrees : {90, 180}) {
    SceneDef s = paper_block("twist", {1, 1, 1}, {n, n, n}, 66e3, 0.45);
    DirichletDef top = paper_hold("top", "z1");
    top.axis_point = {0.5, 0.5, 0};
    top.axis = {0, 0, 1};
    top.angle = degrees * 3.14159265358979323846 / 180;
    top.amount = Curve::ramp(1);
    s.dirichlet = {paper_hold("base", "z0"), top};
    s.analysis.steps = 10;
    watch_volume(s);
    MetricDef law;
    law.name = "left by rows";
    law.quantity = Quantity::volume_row_residual;
    s.metrics.push_back(law);
    for (const char* f : {"tet4", "tet4_node_plain", "edge_node"}) {
      // On 15 cells the last fifth of half a turn takes edge-smoothed bodies minutes.
      const int most = std::string_view(f) == "edge_node" ? 8 : n, cells = std::min(n, most);
      std::get<BoxMeshDef>(s.bodies[0].mesh).divisions = {cells, cells, cells};
      out.push_back(paper_case("twist/" + std::to_string(degrees) + "/" + f, "14",
                               "cube of " + std::to_string(cells) + " cells a side turned by " +
                                   std::to_string(degrees) + " degrees",
                               f, s,
                               {{"left by the volume law", "left by rows", 1, "", "some 1e-8"},
                                {"change of volume", "volume", 100, kPercent, ""},
                                {"iterations", "iterations", 1, "", "at most 50"}}));
      if (std::string_view(f) == "tet4") out.back().shown.erase(out.back().shown.begin());
    }
  }
}

// Table 2 and figure 9: the arm.
void add_arms(std::vector<PaperCase>& out, bool quick) {
  struct Row {
    double nu;
    const char *mixed, *standard;
  };
  for (const Row& row : {Row{0.49, "14.6 cm", "11.2 cm"}, Row{0.499, "14 cm", "6.3 cm"},
                         Row{0.4999, "13.8 cm", "2.4 cm"}, Row{0.49999, "13.8 cm", "0.8 cm"}}) {
    SceneDef s = spine({.mesh = quick ? "spine_1" : "", .element = {}});
    set_poisson(s, row.nu);
    s.analysis.steps = 10;
    watch_volume(s);
    for (const char* f : {"tet4", "tet4_node_plain", "edge_node", "tet10_node"}) {
      const bool standard = std::string_view(f) == "tet4", plain = std::string_view(f) == "tet4_node_plain";
      out.push_back(paper_case("arm/" + text(row.nu, 5) + "/" + f, "table 2",
                               "arm under gravity, nu = " + text(row.nu, 5), f, s,
                               {{"end sinks by", "tip down", -100, "cm",
                                 standard ? row.standard
                                 : plain  ? row.mixed
                                          : ""},
                                {"iterations", "iterations", 1, "", ""}}));
    }
  }
  for (const char* f : {"tet4", "tet4_node_plain", "edge_node"}) {
    SceneDef s = spine({.mesh = quick ? "spine_1" : "", .element = {}});
    set_poisson(s, 0.49);
    s.analysis.type = AnalysisType::dynamics;
    s.analysis.scheme = SchemeWord::implicit_euler;
    s.analysis.steps = quick ? 20 : 125;
    s.analysis.duration = 0.016 * s.analysis.steps;
    s.analysis.options.gravity = {0, -1.5, 0};
    s.analysis.options.gravity_curve = Curve::constant(1);
    out.push_back(paper_case("energy/" + std::string(f), "9", "arm let go, 16 ms a step, 2 s", f, s,
                             {{"deflection of least potential energy", "deflection", 100, "cm", ""},
                              {"largest deflection", "deflection most", 100, "cm", ""},
                              {"energy from nothing", "largest rise", 100, kPercent, ""}}));
    out.back().cell.probe = motion;
  }
}

// Figures 1 and 11: the tube; 7 and 8: the bubble.
void add_robots(std::vector<PaperCase>& out) {
  for (const double nu : {0.45, 0.49, 0.499, 0.4999}) {
    SceneDef s = tube();
    set_poisson(s, nu);
    watch_volume(s);
    for (const char* f : {"tet4", "tet4_node_plain", "edge_node"}) {
      out.push_back(paper_case("tube/" + text(nu, 4) + "/" + f, "1, 11",
                               "tube at 10 kPa, nu = " + text(nu, 4), f, s,
                               {{"widening", "widening outside", 1e3, "mm", ""}}));
    }
  }
  SceneDef s = bubble();
  watch_volume(s);
  for (const char* f : {"tet4", "tet4_node_plain"}) {
    out.push_back(paper_case("bubble/newton/" + std::string(f), "7", "bubble at 4 kPa, nu = 0.499, Newton", f,
                             s,
                             {{"rise of the top", "rise of the top", 1e3, "mm", ""},
                              {"iterations of ten steps", "iterations", 1, "", ""}}));
  }
  out.back().shown[1].stated = "fewer than one field";
  const auto ascend = [&](const char* id, const char* what, Method method, bool one_field) {
    SceneDef scene = s;
    set_poisson(scene, 0.5);
    PaperCase c = paper_case("bubble/" + std::string(id), "8", std::string("bubble, incompressible, ") + what,
                             "tet4_node", scene, {{"rise of the top", "rise of the top", 1e3, "mm", ""}});
    c.cell.scene.analysis.options.method = method;
    if (one_field) {
      set_poisson(c.cell.scene, 0.4);
      c.cell.scene.volumes->front().def.hard = true;
      c.cell.scene.volumes->front().def.carries_bulk = false;
      c.setting += ", on top of the complete energy of nu = 0.4";
    }
    out.push_back(std::move(c));
  };
  ascend("saddle", "Newton", Method::saddle_point, false);
  ascend("ascent", "dual ascent", Method::dual_ascent, false);
  ascend("augmented", "augmented Lagrangian", Method::augmented_ascent, false);
  ascend("own", "augmented as in the paper, Newton", Method::saddle_point, true);
  ascend("own_ascent", "augmented as in the paper, dual ascent", Method::dual_ascent, true);
}

}  // namespace

PaperPart locking_proof_tetrahedra(bool quick) {
  PaperPart part{
      "Locking-Proof Tetrahedra (2021)",
      "The robots are our own designs: the shapes were not published. The cube's top is held from "
      "sliding, since a free one sways. 'Standard' is one field on Tet4, 'ours' of the paper nodal "
      "pressure without stabilization. A square bar of 20 x 8 x 8 cm stands for the cylinder. Ten load "
      "steps (the bar 20).",
      {}};
  add_cubes(part.cases, quick);
  add_bars(part.cases, quick);
  add_twists(part.cases, quick);
  add_arms(part.cases, quick);
  add_robots(part.cases);
  return part;
}

}  // namespace isochor::studies
