// A scene built up effect by effect: what each adds.
#include <algorithm>

#include "scenes/library.h"
#include "studies/analysis.h"
#include "studies/formulations.h"

namespace isochor::studies {

namespace {

constexpr double kDuration = 0.1;  // [s]

struct Stage {
  const char* name;
  void (*add)(SceneDef& scene);
};

CavityDef chamber() {
  CavityDef c;
  c.name = "chamber";
  c.surfaces = {"chamber"};
  return c;
}

ContactDef table(double friction) {
  ContactDef c;
  c.name = "table";
  c.surfaces = {"outer"};
  c.obstacle.shape = ObstacleShape::plane;
  c.obstacle.axis = {0, 1, 0};
  // A tenth of a millimeter below the limiting layer.
  c.obstacle.position = {0, -0.0051, 0};
  c.friction = friction;
  return c;
}

// Each stage keeps those before it.
constexpr Stage kStages[] = {
    {"body and support",
     [](SceneDef& s) {
       apply(formulation("tet4"), s);
       s.cavities.clear();
       s.analysis.duration = kDuration;
       s.analysis.options.gravity = {0, -9.81, 0};
       s.analysis.options.gravity_curve = Curve::constant(1);
       std::erase_if(s.metrics, [](const MetricDef& m) { return m.quantity == Quantity::cavity_volume; });
     }},
    {"dynamics", [](SceneDef& s) { s.analysis.type = AnalysisType::dynamics; }},
    {"nodal pressure", [](SceneDef& s) { apply(formulation("tet4_node"), s); }},
    {"edge smoothing",
     [](SceneDef& s) {
       apply(formulation("edge_node"), s);
       for (auto& b : s.bodies) b.guard_stiffness = 0;
     }},
    {"element guard",
     [](SceneDef& s) {
       for (auto& b : s.bodies) b.guard_stiffness = 1;
     }},
    {"zone: total volume",
     [](SceneDef& s) {
       VolumeRows rows;
       rows.def.name = "total";
       rows.def.space = VolumeSpace::body;
       rows.def.across_regions = true;
       rows.def.carries_bulk = false;
       rows.def.hard = true;
       s.volumes->push_back(rows);
     }},
    {"epidermis",
     [](SceneDef& s) {
       EpidermisDef e;
       e.name = "skin";
       e.surfaces = {"outer"};
       e.young = 200e3;
       e.poisson = 0.4;
       e.thickness = 2e-4;
       s.epidermis = {e};
     }},
    {"cavity, pressure given",
     [](SceneDef& s) {
       s.cavities = {chamber()};
       s.cavities[0].amount = Curve{{{0, 0}, {kDuration, 4e3}}};
     }},
    {"gas law in place of the pressure",
     [](SceneDef& s) {
       s.cavities[0].control = CavityControl::gas;
       s.cavities[0].amount = Curve{{{0, 1}, {kDuration, 1.1}}};
     }},
    {"damping",
     [](SceneDef& s) {
       DampingDef d;
       d.mass_rate = 1;
       s.damping = {d};
     }},
    {"cable",
     [](SceneDef& s) {
       CableDef c;
       // In the sole, through most of its length.
       for (int k = 0; k < 7; ++k) c.points.push_back({0.004 + 0.009 * k, -0.0015, 0});
       c.amount = Curve{{{0, 1}, {kDuration, 0.98}}};
       s.cables = {c};
     }},
    {"contact", [](SceneDef& s) { s.contacts = {table(0)}; }},
    {"friction", [](SceneDef& s) { s.contacts = {table(0.5)}; }},
    {"output of every step", [](SceneDef& s) { s.outputs.every = 1; }},
};

std::vector<Cell> cells(bool quick) {
  std::vector<Cell> out;
  SceneVariant variant;
  variant.mesh = quick ? "finger_small" : "finger";
  SceneDef scene = finger(variant);
  scene.probes.clear();
  std::erase_if(scene.metrics, [](const MetricDef& m) { return m.quantity == Quantity::displacement; });
  scene.analysis.steps = 6;
  int number = 0;
  for (const Stage& stage : kStages) {
    stage.add(scene);
    Cell c;
    ++number;
    c.id = (number < 10 ? "0" : "") + std::to_string(number) + " " + stage.name;
    c.labels = {{"effect", stage.name}};
    c.scene = scene;
    // Processor time on one thread is what repeats best, and differences are wanted.
    c.threads = 1;
    c.outputs = &stage == std::end(kStages) - 1;
    out.push_back(std::move(c));
  }
  return out;
}

double solving(const StageSeconds& t) {
  return t.evaluate + t.gather + t.factor + t.solve + t.line_search;
}

// Processor seconds of the solver without its analysis, which is done once. Stages are wall times: their
// share of the run's.
double solver_seconds(const Measured& m) {
  return m.cpu_seconds * std::min(1.0, solving(m.stages) / std::max(m.seconds, 1e-300));
}

double per_iteration(const Measured& m) {
  return 1e3 * solver_seconds(m) / std::max(1, m.iterations);
}

std::string plus(double now, double before, int digits = 3) {
  const double d = now - before;
  return (d >= 0 ? "+" : "") + text(d, digits);
}

std::vector<Section> present(std::span<const Measured> all) {
  Section s{
      "A scene built up effect by effect",
      "The finger under gravity, six steps of 1/60 s, each line with all that stands above it; the first is "
      "static. Processor time on one thread. Seconds of whole runs also count that a new effect changes how "
      "many iterations a step takes, so the time of one iteration stands beside them; the last line writes "
      "the files of every step and the results page, which is part of its run. Memory: the engine's own, and "
      "the factor's non-zeros in double precision."};
  Bars time{"One Newton iteration", "ms", {}}, whole{"Whole run", "s", {}}, memory{"Memory", "MB", {}};
  Table t{"What each adds",
          {"with", "iterations", "whole run [s]", "added", "one iteration [ms]", "added", "unknowns", "added",
           "non-zeros", "added", "engine [MB]", "added"},
          {}};
  const Measured* last = nullptr;
  constexpr double kMega = 1024 * 1024;
  for (const Measured& m : all) {
    if (!m.good()) {
      t.failed.push_back(t.rows.size());
      t.rows.push_back({m.label("effect"), m.status});
      t.rows.back().resize(t.head.size());
      continue;
    }
    const StageSeconds& st = m.stages;
    const double each = per_iteration(m) / std::max(solving(st), 1e-300);
    time.bars.push_back({m.label("effect"),
                         {{"evaluation", each * st.evaluate},
                          {"gathering", each * st.gather},
                          {"factorization", each * st.factor},
                          {"solving", each * st.solve},
                          {"line search", each * st.line_search}}});
    whole.bars.push_back(
        {m.label("effect"),
         {{"solver", solver_seconds(m)}, {"all else", std::max(0.0, m.cpu_seconds - solver_seconds(m))}}});
    const double engine = static_cast<double>(m.engine_bytes) / kMega;
    memory.bars.push_back(
        {m.label("effect"),
         {{"engine", engine}, {"factor", 8 * static_cast<double>(m.factor_nonzeros) / kMega}}});
    const auto added = [&](double now, double before) { return last ? plus(now, before) : std::string(); };
    t.rows.push_back(
        {m.label("effect"), std::to_string(m.iterations), text(m.cpu_seconds),
         added(m.cpu_seconds, last ? last->cpu_seconds : 0), text(per_iteration(m)),
         added(per_iteration(m), last ? per_iteration(*last) : 0), text(m.unknowns(), 8),
         last ? plus(m.unknowns(), last->unknowns(), 8) : "", std::to_string(m.nonzeros),
         last ? plus(static_cast<double>(m.nonzeros), static_cast<double>(last->nonzeros), 9) : "",
         text(engine), added(engine, last ? static_cast<double>(last->engine_bytes) / kMega : 0)});
    last = &m;
  }
  s.bars = {std::move(time), std::move(whole), std::move(memory)};
  s.tables.push_back(std::move(t));
  return {s, all_cells(all)};
}

}  // namespace

Study effects_study() {
  return {"effects", "What each effect costs", "Time, memory, unknowns and non-zeros that each effect adds.",
          cells, present};
}

}  // namespace isochor::studies
