// What each method costs on the same scenes: seconds of the whole solve and of a Newton iteration.
//
//   isochor_bench_methods [--quick] [--method WORD]
//
// A block of 39,600 Tet4 (1,920 with --quick) that bends under its weight, nodal pressure, and the same with
// its one-field energy (what a displacement-only code pays); then the robots of scenes/.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include "isochor/effects.h"
#include "isochor/generate.h"
#include "isochor/schemes.h"
#include "must.h"
#include "options.h"
#include "scenes/library.h"
#include "scenes/run/run.h"

namespace {

using namespace isochor;
using bench::must;

struct Way {
  const char* name;
  Method method;
  Solver solver = Solver::automatic;
};
constexpr Way kWays[] = {{"automatic", Method::automatic},
                         {"saddle_point", Method::saddle_point},
                         {"iterative", Method::saddle_point, Solver::iterative},
                         {"condensation", Method::condensation},
                         {"dual_gradients", Method::dual_gradients},
                         {"augmented_gradients", Method::augmented_gradients},
                         {"augmented_ascent", Method::augmented_ascent},
                         {"dual_ascent", Method::dual_ascent}};

void print(const char* scene, const char* way, const StepReport& r, const WorldSize& size) {
  const double n = std::max(1, r.iterations);
  std::printf(
      "%-24s %-20s %7.2f s, %3d iterations, %7.1f ms each, %4d dual steps, %5lld gradient iterations, "
      "%9lld non-zeros of factors%s\n",
      scene, way, r.seconds.total, r.iterations, 1e3 * r.seconds.total / n, r.dual.steps,
      static_cast<long long>(r.dual.iterations), static_cast<long long>(size.factor_nonzeros),
      r.status == StepStatus::converged ? "" : (" NOT CONVERGED: " + r.reason).c_str());
  std::fflush(stdout);
}

void block(const Way& way, bool quick, bool one_field, double poisson) {
  BoxMeshDef box;
  box.upper = {0.5, 0.1, 0.1};
  box.divisions = quick ? std::array<int, 3>{20, 4, 4} : std::array<int, 3>{66, 10, 10};
  WorldOptions options;
  options.scheme = statics();
  options.method = way.method;
  options.solver = way.solver;
  options.gravity = {0, 0, -9.81};
  World world = must(World::create(options));
  BodyDef def;
  def.mesh = must(box_mesh(box));
  def.element = Element::tet4;
  def.materials = {{"", must(neo_hookean({.young = 300e3, .poisson = poisson})), 1070}};
  const BodyId body = must(world.add_body(def));
  if (!one_field) {
    VolumeDef rows;
    rows.body = body;
    must(world.add(volume(rows)));
  }
  DirichletDef fixed;
  fixed.where.body = body;
  fixed.where.surfaces = {"x0"};
  must(world.add(dirichlet(fixed)));
  const StepReport r = world.advance(1);
  const std::string name = "block, nu " + std::to_string(poisson).substr(0, 6);
  print(name.c_str(), one_field ? "one field" : way.name, r, world.size());
}

void robot(const Way& way, const char* name) {
  const LibraryScene* scene = find_scene(name);
  SceneDef def = scene->make({});
  def.analysis.options.method = way.method;
  def.analysis.options.solver = way.solver;
  def.analysis.steps = 1;
  auto built = must(build(def));
  const StepReport r = built.world.advance(1);
  print(name, way.name, r, built.world.size());
}

}  // namespace

int main(int argc, char** argv) {
  isochor::bench::check_options(argc, argv, {"--quick"}, {"--method"});
  bool quick = false;
  std::string only;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--quick") == 0) {
      quick = true;
    } else if (std::strcmp(argv[i], "--method") == 0 && i + 1 < argc) {
      only = argv[++i];
    } else {
      std::fprintf(stderr, "usage: isochor_bench_methods [--quick] [--method WORD]\n");
      return 2;
    }
  }
  if (only.empty()) {
    block(kWays[0], quick, true, 0.4999);
    block(kWays[0], quick, true, 0.45);
  }
  for (const Way& way : kWays) {
    if (!only.empty() && only != way.name) continue;
    if (way.method == Method::dual_ascent) continue;  // thousands of steps: see the bubble
    block(way, quick, false, 0.4999);
    block(way, quick, false, 0.5);
  }
  for (const char* name : {"bubble", "cushion", "tube", "finger"}) {
    for (const Way& way : kWays) {
      if (!only.empty() && only != way.name) continue;
      if (quick || way.method == Method::dual_ascent) continue;
      robot(way, name);
    }
  }
  return 0;
}
