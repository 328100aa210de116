// What a step costs and where the time goes: a large static Newton iteration and robots in dynamics at nu =
// 0.5.
//
//   isochor_bench_step [--meshes scenes/meshes] [--threads N] [--quick]
//
// Prints machine-independent counts beside seconds, and the state hash: a faster run with another hash is
// another run.
#include <isochor/effects.h>
#include <isochor/generate.h>
#include <isochor/mesh_io.h>
#include <isochor/schemes.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "must.h"
#include "options.h"

namespace {

using namespace isochor;
using bench::must;

const char* name(Element e) {
  return e == Element::tet4 ? "tet4" : (e == Element::tet10 ? "tet10" : "tet4_edge_smoothed");
}

struct Built {
  World world;
  BodyId body;
};

Built build(Mesh mesh, Element element, WorldOptions options, const char* clamped) {
  World world = must(World::create(std::move(options)));
  BodyDef body;
  body.mesh = std::move(mesh);
  body.element = element;
  body.materials = {{"", must(neo_hookean({.young = 100e3, .poisson = 0.5})), 1070}};
  const BodyId id = must(world.add_body(std::move(body)));
  VolumeDef rows;
  rows.body = id;
  must(world.add(volume(rows)));
  DirichletDef fixed;
  fixed.where.body = id;
  fixed.where.surfaces = {clamped};
  must(world.add(dirichlet(fixed)));
  return {std::move(world), id};
}

struct Totals {
  int steps = 0, iterations = 0, factorizations = 0, corrections = 0;
  StageSeconds s;
  std::vector<double> step_seconds;

  void add(const StepReport& r) {
    ++steps;
    iterations += r.iterations;
    factorizations += r.factorizations;
    corrections += r.corrections;
    s.analyze += r.seconds.analyze;
    s.evaluate += r.seconds.evaluate;
    s.gather += r.seconds.gather;
    s.factor += r.seconds.factor;
    s.solve += r.seconds.solve;
    s.line_search += r.seconds.line_search;
    s.total += r.seconds.total;
    step_seconds.push_back(r.seconds.total);
  }
};

void print_stages(const Totals& t) {
  const double it = t.iterations > 0 ? 1e3 / t.iterations : 0;
  const double newton = t.s.total - t.s.analyze;
  std::printf(
      "    per iteration [ms]: evaluate %.1f, gather %.1f, factor %.1f, solve %.1f, line search %.1f; "
      "outside factor and solve %.1f %%\n",
      it * t.s.evaluate, it * t.s.gather, it * t.s.factor, it * t.s.solve, it * t.s.line_search,
      100 * (newton - t.s.factor - t.s.solve) / newton);
}

// Full Newton iterations on a box of about 40,000 tets hanging under its own weight.
void bench_static(Element element, int threads, bool quick) {
  const std::array<int, 3> divisions = quick ? std::array{20, 4, 4} : std::array{66, 10, 10};
  Mesh mesh = must(box_mesh({{0, 0, 0}, {1, 0.1, 0.1}, divisions}));
  const Index cells = mesh.cell_count(), nodes = mesh.node_count();
  WorldOptions options;
  options.scheme = statics();
  options.threads = threads;
  options.gravity = {0, -9.8, 0};
  Built b = build(std::move(mesh), element, options, "x0");
  Totals t;
  const StepReport r = b.world.advance(1);
  t.add(r);
  const WorldSize size = b.world.size();
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  std::printf("static, %s: %d tets, %d nodes, %d + %d unknowns, %s\n", name(element), cells, nodes,
              size.displacement_unknowns, size.multipliers,
              r.status == StepStatus::converged ? "converged" : r.reason.c_str());
  std::printf(
      "    %d iterations, %d factorizations, analysis %.2f s (once), total %.2f s, peak memory %.2f GiB, "
      "hash %016llx\n",
      r.iterations, r.factorizations, t.s.analyze, t.s.total,
      static_cast<double>(usage.ru_maxrss) / (1024 * 1024),
      static_cast<unsigned long long>(b.world.state_hash()));
  print_stages(t);
}

// A robot inflated to 10 kPa within 0.3 s at 60 steps a second.
void bench_robot(const std::string& file, Element element, int threads, int steps) {
  Mesh mesh = must(read_mesh(file));
  const Index cells = mesh.cell_count();
  WorldOptions options;
  options.scheme = implicit_euler();
  options.threads = threads;
  Built b = build(std::move(mesh), element, options, "clamped");
  CavityDef chamber;
  chamber.body = b.body;
  chamber.surfaces = {"chamber"};
  chamber.amount = Curve::ramp(10e3, 0.3);
  must(b.world.add(cavity(chamber)));
  if (auto r = b.world.compile(); !r) {
    std::fprintf(stderr, "%s\n", r.error().c_str());
    std::exit(2);
  }
  Totals t;
  for (int k = 0; k <= steps; ++k) {
    const StepReport r = b.world.step(1.0 / 60);
    if (r.status != StepStatus::converged) {
      std::printf("    step %d: %s\n", k, r.reason.c_str());
      break;
    }
    if (k > 0) t.add(r);  // the first one holds the analysis
  }
  std::sort(t.step_seconds.begin(), t.step_seconds.end());
  const double median = t.step_seconds.empty() ? 0 : t.step_seconds[t.step_seconds.size() / 2];
  const auto slash = file.find_last_of('/');
  std::printf("dynamic, %s, %s: %d tets, h = 1/60 s, nu = 0.5\n", file.substr(slash + 1).c_str(),
              name(element), cells);
  std::printf(
      "    %.1f steps/s (median step %.1f ms, worst %.1f times that), %d iterations and %d corrections in %d "
      "steps, hash %016llx\n",
      t.steps / t.s.total, 1e3 * median, median > 0 ? t.step_seconds.back() / median : 0, t.iterations,
      t.corrections, t.steps, static_cast<unsigned long long>(b.world.state_hash()));
  print_stages(t);
}

}  // namespace

int main(int argc, char** argv) {
  isochor::bench::check_options(argc, argv, {"--quick"}, {"--meshes", "--threads"});
  std::string meshes = "scenes/meshes";
  int threads = 0;
  bool quick = false;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--quick") == 0) quick = true;
    if (std::strcmp(argv[i], "--meshes") == 0 && i + 1 < argc) meshes = argv[++i];
    if (std::strcmp(argv[i], "--threads") == 0 && i + 1 < argc) threads = std::atoi(argv[++i]);
  }
  for (const Element e : {Element::tet4, Element::tet4_edge_smoothed}) bench_static(e, threads, quick);
  for (const Element e : {Element::tet4, Element::tet4_edge_smoothed}) {
    bench_robot(meshes + "/finger_small.msh", e, threads, quick ? 10 : 60);
    if (!quick) bench_robot(meshes + "/finger_large.msh", e, threads, 60);
  }
  return 0;
}
