// A scene built up effect by effect: what each adds.
#include <algorithm>

#include "scenes/library.h"
#include "studies/analysis.h"
#include "studies/formulations.h"

namespace isochor::studies {

namespace {

struct Stage {
  const char* name;
  void (*add)(SceneDef& scene);
};

// Each stage keeps those before it.
constexpr Stage kStages[] = {
    {"body and support",
     [](SceneDef& s) {
       apply(formulation("tet4"), s);
       s.cavities.clear();
       s.analysis.type = AnalysisType::dynamics;
       s.analysis.duration = 0.1;
       s.gravity = {0, -9.81, 0};
       s.gravity_amount = Curve::constant(1);
       std::erase_if(s.metrics, [](const MetricDef& m) { return m.quantity == Quantity::cavity_volume; });
     }},
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
    {"cavity, pressure given",
     [](SceneDef& s) {
       CavityDef c;
       c.name = "chamber";
       c.surfaces = {"chamber"};
       c.amount = Curve{{{0, 0}, {0.1, 4e3}}};
       s.cavities = {c};
     }},
    {"damping",
     [](SceneDef& s) {
       DampingDef d;
       d.mass_rate = 1;
       s.damping = {d};
     }},
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
    c.id = std::to_string(++number) + " " + stage.name;
    c.labels = {{"effect", stage.name}};
    c.scene = scene;
    out.push_back(std::move(c));
  }
  return out;
}

double per_iteration(const Measured& m) {
  return 1e3 * (m.stages.total - m.stages.analyze) / std::max(1, m.iterations);
}

std::string plus(double now, double before, int digits = 3) {
  const double d = now - before;
  return (d >= 0 ? "+" : "") + text(d, digits);
}

std::vector<Section> present(std::span<const Measured> all) {
  Section s{
      "A scene built up effect by effect",
      "The finger under gravity in dynamics, six steps of 1/60 s, each line with all that stands above it. "
      "Seconds of whole runs also count that a new effect changes how many iterations a step takes, so the "
      "time of "
      "one iteration stands beside them. Memory: the engine's own, and the factor's non-zeros in double "
      "precision."};
  Bars time{"One Newton iteration", "ms", {}}, memory{"Memory", "MB", {}};
  Table t{"What each adds",
          {"with", "iterations", "whole run [s]", "one iteration [ms]", "added", "unknowns", "added",
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
    const double each = 1e3 / std::max(1, m.iterations);
    const StageTimes& st = m.stages;
    time.bars.push_back({m.label("effect"),
                         {{"evaluation", each * st.evaluate},
                          {"gathering", each * st.gather},
                          {"factorization", each * st.factor},
                          {"solving", each * st.solve},
                          {"line search", each * st.line_search}}});
    const double engine = static_cast<double>(m.engine_bytes) / kMega;
    memory.bars.push_back(
        {m.label("effect"),
         {{"engine", engine}, {"factor", 8 * static_cast<double>(m.factor_nonzeros) / kMega}}});
    const auto added = [&](double now, double before) { return last ? plus(now, before) : std::string(); };
    t.rows.push_back(
        {m.label("effect"), std::to_string(m.iterations), text(m.seconds), text(per_iteration(m)),
         added(per_iteration(m), last ? per_iteration(*last) : 0), text(m.unknowns(), 8),
         last ? plus(m.unknowns(), last->unknowns(), 8) : "", std::to_string(m.nonzeros),
         last ? plus(static_cast<double>(m.nonzeros), static_cast<double>(last->nonzeros), 9) : "",
         text(engine), added(engine, last ? static_cast<double>(last->engine_bytes) / kMega : 0)});
    last = &m;
  }
  s.bars = {std::move(time), std::move(memory)};
  s.tables.push_back(std::move(t));
  return {s, all_cells(all)};
}

}  // namespace

Study effects_study() {
  return {"effects", "What each effect costs", "Time, memory, unknowns and non-zeros that each effect adds.",
          cells, present};
}

}  // namespace isochor::studies
