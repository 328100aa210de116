// How much load a single step takes, and the torture suite.
#include <algorithm>
#include <numeric>

#include "scenes/library.h"
#include "studies/agreement.h"
#include "studies/analysis.h"
#include "studies/modes.h"
#include "studies/problems.h"
#include "studies/torture.h"

namespace isochor::studies {

namespace {

void add_loads(bool quick, std::vector<Cell>& out) {
  const Problem& p = problem("cantilever");
  for (const char* name : {"tet4_node", "edge_node", "tet10_node"}) {
    const Formulation& f = formulation(name);
    for (const double load : {0.1, 1.0, 5.0, 20.0, 50.0}) {
      Cell c = problem_cell(p, f, quick ? 0 : 1);
      c.id = "load/" + std::string(f.name) + "/" + text(load);
      c.knobs["load"] = load;
      c.scene.analysis.options.gravity = {0, -9.8 * load, 0};
      c.reference.reset();
      c.source.clear();
      c.guarded = quick && load <= 5;
      out.push_back(std::move(c));
    }
  }
}

struct Flavor {
  std::string_view name;
  Element element;
  bool one_field;
};
constexpr Flavor kFlavors[] = {{"tet4", Element::tet4, false},
                               {"edge", Element::tet4_edge_smoothed, false},
                               {"tet10", Element::tet10, false},
                               {"tet4 one-field", Element::tet4, true}};
struct Way {
  std::string_view name;
  Method method;
};
constexpr Way kWays[] = {{"saddle point", Method::saddle_point},
                         {"dual gradients", Method::dual_gradients},
                         {"augmented ascent", Method::augmented_ascent}};

void add_torture(const TortureCase& c, const Flavor& flavor, const Way& way, double poisson, double step,
                 double load, unsigned seeds, std::vector<Cell>& out) {
  if (step > 0 ? !c.dynamic || step > c.longest_step : !c.statics) return;
  if (flavor.one_field && poisson == 0.5) return;
  if (c.large && flavor.element == Element::tet10) return;
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    TortureSettings settings;
    settings.poisson = poisson;
    settings.step = step;
    settings.load = load;
    settings.element = flavor.element;
    settings.one_field = flavor.one_field;
    settings.method = way.method;
    settings.seed = seed;
    Cell cell;
    cell.id = "torture/" + std::string(c.name) + "/" + std::string(flavor.name) + "/" +
              std::string(way.name) + "/" + text(poisson, 4) + "/" + text(step) + "/" + text(load) + "/" +
              std::to_string(seed);
    cell.labels = {{"case", std::string(c.title)},
                   {"formulation", std::string(flavor.name)},
                   {"method", std::string(way.name)}};
    cell.knobs = {{"nu", poisson}, {"step", step}, {"load", load}, {"seed", seed}};
    cell.probe = [run = c.run, settings](const SceneDef&, int) -> Result<Numbers> {
      const TortureResult r = run(settings);
      if (r.verdict == TortureVerdict::broken) return Error{"broken: " + r.reason};
      return Numbers{{"verdict", static_cast<double>(r.verdict)},
                     {"newton", r.iterations},
                     {"cutbacks", r.cutbacks},
                     {"mended", r.shifted + r.projected},
                     {"rescues", r.rescues},
                     {"stand-ins", r.stand_ins},
                     {"volume row residual", r.volume_row_residual},
                     {"min J", r.min_J},
                     {"drift", r.drift},
                     {"reached", r.reached},
                     {"run seconds", r.seconds}};
    };
    out.push_back(std::move(cell));
  }
}

constexpr const char* kModal[] = {"tet10_node", "edge_node", "tet4_node"};
constexpr double kStretches[] = {0, 1.5, 0.85};

std::string modes_id(std::string_view name, double stretch) {
  return "modes/" + std::string(name) + "/" + text(stretch);
}

void add_modes(bool quick, std::vector<Cell>& out) {
  for (const char* name : kModal) {
    for (const double stretch : kStretches) {
      Cell cell;
      cell.id = modes_id(name, stretch);
      cell.labels = {{"formulation", std::string(formulation(name).label)}};
      cell.knobs = {{"stretch", stretch}};
      cell.probe = modes_probe(formulation(name), quick ? 4 : 6, stretch);
      out.push_back(std::move(cell));
    }
  }
}

void show_modes(std::span<const Measured> all, std::vector<Section>& out) {
  const auto find = [&](const std::string& id) -> const Measured* {
    for (const Measured& m : all) {
      if (m.id == id && m.good()) return &m;
    }
    return nullptr;
  };
  Section s{
      "Vibrations",
      "The 30 lowest natural frequencies of a bar, nearly incompressible, over those of Tet10 with linear "
      "pressure on the same nodes: free at rest (stretch 0), or stretched and compressed with its ends held. "
      "A spurious mode would be an extra zero, a ratio far below 1, or a shape that changes from node to "
      "node "
      "(roughness near 1)."};
  Table t{
      "", {"formulation", "stretch", "zero modes", "unstable", "least ratio", "largest", "roughness"}, {}};
  for (const char* name : kModal) {
    for (const double stretch : kStretches) {
      const Measured *m = find(modes_id(name, stretch)), *reference = find(modes_id(kModal[0], stretch));
      if (m == nullptr || reference == nullptr) continue;
      double least = 1e300, most = 0;
      for (int k = 1; k <= 30; ++k) {
        std::string f = std::to_string(k);
        f.insert(0, 1, 'f');
        const double ratio = m->number(f) / reference->number(f);
        least = std::min(least, ratio);
        most = std::max(most, ratio);
      }
      t.rows.push_back({m->label("formulation"), stretch > 0 ? text(stretch) : "free",
                        text(m->number("zero modes")), text(m->number("unstable")), text(least), text(most),
                        text(m->number("rough"))});
    }
  }
  if (t.rows.empty()) return;
  s.tables.push_back(std::move(t));
  out.push_back(std::move(s));
}

// What the library holds that is small enough, in every way that should end at the same place.
struct Common {
  std::string_view name;
  int steps = 0;  // the first ones of long scenes; 0: all
};
constexpr Common kCommon[] = {{"finger"},
                              {"tube"},
                              {"cushion"},
                              {"bubble"},
                              {"spine"},
                              {"cantilever"},
                              {"cook"},
                              {"cook_plane"},
                              {"thick_tube"},
                              {"thick_sphere_volume"},
                              {"torsion"},
                              {"cable_finger"},
                              {"gas_tube"},
                              {"two_chambers"},
                              {"puck"},
                              {"puck_skin"},
                              {"painted_arm"},
                              {"squeezed_block"},
                              {"incline"},
                              {"indented_puck"},
                              {"ball_drop", 32},  // it meets the floor in step 29
                              {"gripper", 24},    // the fingers close in step 20
                              {"colliding_balls", 30},
                              {"bellows", 4}};
constexpr SameEnd kSameEnds[] = {{"automatic", Method::automatic},
                                 {"condensation", Method::condensation},
                                 {"dual_gradients", Method::dual_gradients},
                                 {"augmented_gradients", Method::augmented_gradients},
                                 {"augmented_ascent", Method::augmented_ascent},
                                 {"iterative", Method::saddle_point, Solver::iterative}};

void add_agreement(bool quick, std::vector<Cell>& out) {
  for (const auto& [name, steps] : kCommon) {
    if (quick && name != "bubble" && name != "tube") continue;
    const LibraryScene* scene = find_scene(name);
    if (scene == nullptr) continue;
    std::vector<Probe> probes = agreement_probes(scene->make({}), kSameEnds, steps);
    for (std::size_t k = 0; k < probes.size(); ++k) {
      Cell cell;
      cell.id = "agreement/" + std::string(name) + "/" + std::string(kSameEnds[k].name);
      cell.labels = {{"scene", std::string(name)}, {"method", std::string(kSameEnds[k].name)}};
      if (steps > 0) cell.knobs["steps"] = steps;
      cell.probe = std::move(probes[k]);
      out.push_back(std::move(cell));
    }
  }
}

void show_agreement(std::span<const Measured> all, std::vector<Section>& out) {
  std::vector<Measured> cells;
  for (const Measured& m : all) {
    if (m.id.rfind("agreement/", 0) == 0) cells.push_back(m);
  }
  if (cells.empty()) return;
  Section s{
      "One solution, many ways",
      "Scenes of the library run to their end: the largest distance of a node from where saddle_point takes "
      "it, over the size of the body. A dash: the method does not take the scene and says why."};
  Table t{"", {"scene"}, {}};
  for (const SameEnd& way : kSameEnds) t.head.emplace_back(way.name);
  for (const auto& scene : label_values(cells, "scene")) {
    std::vector<std::string> row{scene};
    for (const Measured& m : cells) {
      if (m.label("scene") != scene || m.knobs.count("steps") == 0) continue;
      row[0] += ", first " + text(m.knob("steps")) + " steps";
      break;
    }
    for (const SameEnd& way : kSameEnds) {
      std::string entry;
      for (const Measured& m : cells) {
        if (m.label("scene") != scene || m.label("method") != way.name) continue;
        entry = !m.good() ? "not converged" : m.number("refused") > 0 ? "–" : text(m.number("distance"), 2);
      }
      row.push_back(entry);
    }
    t.rows.push_back(std::move(row));
  }
  s.tables.push_back(std::move(t));
  out.push_back(std::move(s));
}

// The whole matrix takes some hours; --quick a corner of it.
std::vector<Cell> cells(bool quick) {
  std::vector<Cell> out;
  add_loads(quick, out);
  add_modes(quick, out);
  std::vector<Cell> torture;
  for (const TortureCase& c : torture_cases()) {
    if (quick) {
      if (c.name == "bubble" || c.name == "cushion" || c.name == "spin") continue;
      for (const double step : {0.0, 0.033})
        add_torture(c, kFlavors[0], kWays[0], 0.5, step, c.name == "compression" ? 0.6 : 1, 1, torture);
      continue;
    }
    for (const Flavor& flavor : kFlavors) {
      for (const double poisson : {0.45, 0.49, 0.499, 0.4999, 0.5}) {
        for (const double step : {0.0, 1e-4, 1e-3, 8e-3, 33e-3, 0.1}) {
          for (const double load : {1.0, 3.0, c.further_load, 10.0}) {
            if (load == 0 || load > c.largest_load) continue;
            add_torture(c, flavor, kWays[0], poisson, step, load, 1, torture);
          }
        }
        // The other ways through the same cases, at one load and one step.
        if (flavor.one_field) continue;
        for (const Way& way : {kWays[1], kWays[2]}) {
          for (const double step : {0.0, 33e-3}) add_torture(c, flavor, way, poisson, step, 1, 1, torture);
        }
      }
    }
  }
  // Strides through the matrix, so that what has been done when a run is stopped is a fair sample.
  const std::size_t n = torture.size();
  std::size_t stride = 1597;
  while (std::gcd(stride, n) != 1) ++stride;
  for (std::size_t k = 0; k < n; ++k) out.push_back(std::move(torture[quick ? k : k * stride % n]));
  add_agreement(quick, out);
  return out;
}

void add_verdicts(std::span<const Measured> all, std::vector<Section>& out) {
  std::vector<Measured> torture;
  for (const Measured& m : all) {
    if (m.id.rfind("torture/", 0) == 0) torture.push_back(m);
  }
  if (torture.empty()) return;
  Section s{
      "The torture suite",
      "Hard cases over Poisson's ratio, time step (0: statics), load, formulation and method. Solved: "
      "balanced "
      "within the tolerances and right in every check of the case. Told: there is no equilibrium, or the "
      "settings are refused, and the engine says so. Stopped: an equilibrium should exist, and the engine "
      "reports that it found none. Broken would be a number that is not finite, a state called converged "
      "that "
      "is not, or a rejected step that left traces. Mended: matrices of wrong inertia; cutbacks: increments "
      "that were halved; stand-ins: increments that a dual method left to its augmented relative."};
  Table t{
      "",
      {"case", "formulation", "method", "runs", "solved", "told", "stopped", "broken", "Newton iterations",
       "cutbacks", "mended", "stand-ins", "rescues", "largest volume row residual", "seconds"},
      {}};
  for (const auto& name : label_values(torture, "case")) {
    for (const auto& formulation_name : label_values(torture, "formulation")) {
      for (const auto& way : label_values(torture, "method")) {
        int runs = 0, verdicts[3] = {0, 0, 0}, broken = 0;
        double newton = 0, cutbacks = 0, mended = 0, stand_ins = 0, rescues = 0, volume = 0, seconds = 0;
        for (const Measured& m : torture) {
          if (m.label("case") != name || m.label("formulation") != formulation_name ||
              m.label("method") != way)
            continue;
          ++runs;
          if (!m.good()) {
            ++broken;
            continue;
          }
          ++verdicts[std::clamp(static_cast<int>(m.number("verdict")), 0, 2)];
          newton += m.number("newton");
          cutbacks += m.number("cutbacks");
          mended += m.number("mended");
          stand_ins += m.number("stand-ins");
          rescues += m.number("rescues");
          volume = std::max(volume, m.number("volume row residual"));
          seconds += m.number("run seconds");
        }
        if (runs == 0) continue;
        if (broken > 0) t.failed.push_back(t.rows.size());
        t.rows.push_back({name, formulation_name, way, std::to_string(runs), std::to_string(verdicts[0]),
                          std::to_string(verdicts[1]), std::to_string(verdicts[2]), std::to_string(broken),
                          text(newton), text(cutbacks), text(mended), text(stand_ins), text(rescues),
                          text(volume, 2), text(seconds)});
      }
    }
  }
  s.tables.push_back(std::move(t));
  out.push_back(std::move(s));
}

std::vector<Section> present(std::span<const Measured> everything) {
  std::vector<Measured> all;
  for (const Measured& m : everything) {
    if (m.id.rfind("load/", 0) == 0) all.push_back(m);
  }
  Section s{"The whole load in one step",
            "The cantilever at nu = 0.5 under a multiple of gravity, asked for in one increment. "
            "Factorizations beyond the "
            "iterations are tries at increments that were cut or matrices that were mended; min J is the "
            "smallest volume "
            "ratio of a cell (below zero: turned over)."};
  Table t{"",
          {"formulation", "load / g", "status", "tip [m]", "iterations", "factorizations", "min J", "max J",
           "left by volume rows", "seconds"},
          {}};
  Diagram d{"Newton iterations", "", "load / g", "iterations"};
  d.log_x = true;
  for (const auto& f : label_values(all, "formulation")) {
    Line line{f, {}, {}};
    for (const Measured* m : where(all, "formulation", f)) {
      if (!m->good()) t.failed.push_back(t.rows.size());
      t.rows.push_back({f, text(m->knob("load")), m->status, m->good() && m->value ? text(*m->value, 4) : "",
                        std::to_string(m->iterations), std::to_string(m->factorizations),
                        text(m->number("min J")), text(m->number("max J")),
                        text(m->number("left by volume rows"), 2), text(m->seconds)});
      if (!m->good()) continue;
      line.x.push_back(m->knob("load"));
      line.y.push_back(m->iterations);
    }
    d.lines.push_back(std::move(line));
  }
  s.diagrams.push_back(std::move(d));
  s.tables.push_back(std::move(t));
  std::vector<Section> sections{s};
  add_verdicts(everything, sections);
  show_modes(everything, sections);
  show_agreement(everything, sections);
  sections.push_back(all_cells(everything));
  return sections;
}

}  // namespace

Study stability_study() {
  return {"stability", "Stability", "How much load one increment takes, and what hard cases end as.", cells,
          present};
}

}  // namespace isochor::studies
