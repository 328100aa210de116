// What a Newton iteration of the mixed form costs against that of the displacement-only form on the same
// mesh: processor time, analysis excluded, for every linear solver that takes the form.
//
//   isochor_bench_mixed [--tets 1500,10000,40000] [--repeats 3] [--smoothed] [--threads 1]
//
// A slender block bends under its weight in statics. Half of the load warms up (and analyzes); the rest comes
// in three increments that are timed. The cases take turns, so that a machine that changes its pace changes
// it for all; the fastest repeat of each counts. Threads other than 1 make processor time a poor measure:
// BLAS threads that wait count as work.
#include <isochor/effects.h>
#include <isochor/generate.h>
#include <isochor/schemes.h>
#include <isochor/threads.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <string>
#include <vector>

#include "must.h"

namespace {

using namespace isochor;
using bench::must;

struct Case {
  const char* solver_name;
  Solver solver;
  bool mixed;
  double poisson;
  bool condensed = false;  // one pressure an element, condensed, instead of one a node
};
constexpr Case kCases[] = {{"multifrontal", Solver::multifrontal, false, 0.4999},
                           {"mumps", Solver::mumps, false, 0.4999},
                           {"cholmod_supernodal", Solver::cholmod_supernodal, false, 0.4999},
                           {"multifrontal", Solver::multifrontal, false, 0.45},
                           {"cholmod_supernodal", Solver::cholmod_supernodal, false, 0.45},
                           {"multifrontal", Solver::multifrontal, true, 0.4999},
                           {"multifrontal", Solver::multifrontal, true, 0.5},
                           {"mumps", Solver::mumps, true, 0.5},
                           {"iterative", Solver::iterative, true, 0.5},
                           {"multifrontal", Solver::multifrontal, true, 0.4999, true},
                           {"cholmod_supernodal", Solver::cholmod_supernodal, true, 0.4999, true}};

struct Cost {
  bool there = false, good = true;
  Index unknowns = 0;
  double iteration = HUGE_VAL, step = HUGE_VAL;  // [s]
  int factorizations = 0, corrections = 0;
  std::int64_t linear_iterations = 0;
};

double processor_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

BoxMeshDef box_of(double tets) {
  // Five times as long as it is wide: 6 n n 5n tets.
  const int n = std::max(2, static_cast<int>(std::lround(std::cbrt(tets / 30))));
  BoxMeshDef box;
  box.upper = {0.5, 0.1, 0.1};
  box.divisions = {std::max(2, static_cast<int>(std::lround(tets / (6.0 * n * n)))), n, n};
  return box;
}

void measure(const Case& c, const BoxMeshDef& box, Element element, int threads, Cost& cost) {
  WorldOptions options;
  options.scheme = statics();
  options.gravity = {0, 0, -9.81};
  options.gravity_curve = Curve::ramp(1);
  options.solver = c.solver;
  options.method = c.condensed ? Method::condensation : Method::saddle_point;
  options.threads = threads;
  Result<World> made = World::create(options);
  if (!made) return;  // not part of this build
  World world = std::move(made).value();
  BodyDef def;
  def.mesh = must(box_mesh(box));
  def.element = element;
  def.materials = {{"", must(neo_hookean({.young = 300e3, .poisson = c.poisson})), 1070}};
  const BodyId body = must(world.add_body(def));
  if (c.mixed) {
    VolumeDef rows;
    rows.body = body;
    if (c.condensed) rows.space = VolumeSpace::element;
    must(world.add(volume(rows)));
  }
  DirichletDef fixed;
  fixed.where.body = body;
  fixed.where.surfaces = {"x0"};
  must(world.add(dirichlet(fixed)));
  cost.there = true;
  cost.good = cost.good && world.advance(0.5).status == StepStatus::converged;
  cost.factorizations = cost.corrections = 0;
  cost.linear_iterations = 0;
  const double start = processor_seconds();
  for (int k = 0; k < 3; ++k) {
    const StepReport r = world.advance(0.5 / 3);
    cost.good = cost.good && r.status == StepStatus::converged;
    cost.factorizations += r.factorizations;
    cost.corrections += r.corrections;
    cost.linear_iterations += r.krylov.iterations;
  }
  const double seconds = processor_seconds() - start;
  cost.iteration = std::min(cost.iteration, seconds / std::max(1, cost.factorizations));
  cost.step = std::min(cost.step, seconds / 3);
  cost.unknowns = world.size().displacement_unknowns + (c.mixed ? world.size().multipliers : 0);
}

void compare(double tets, Element element, int repeats, int threads) {
  const BoxMeshDef box = box_of(tets);
  std::vector<Cost> costs(std::size(kCases));
  for (int r = 0; r < repeats; ++r) {
    for (std::size_t k = 0; k < costs.size(); ++k) measure(kCases[k], box, element, threads, costs[k]);
  }
  double displacement_only = HUGE_VAL;
  for (std::size_t k = 0; k < costs.size(); ++k) {
    if (!kCases[k].mixed && costs[k].there)
      displacement_only = std::min(displacement_only, costs[k].iteration);
  }
  const auto& d = box.divisions;
  std::printf("%d tets\n", 6 * d[0] * d[1] * d[2]);
  for (std::size_t k = 0; k < costs.size(); ++k) {
    const Case& c = kCases[k];
    const Cost& cost = costs[k];
    if (!cost.there) continue;
    std::printf(
        "  %-18s nu %.4f  %-20s %7d unknowns, %8.2f ms an iteration, %8.2f ms an increment, %2d iterations, "
        "%2d "
        "corrections, %4lld linear, %.2f of the best displacement-only iteration%s\n",
        c.condensed ? "mixed, by element"
        : c.mixed   ? "mixed"
                    : "one field",
        c.poisson, c.solver_name, cost.unknowns, 1e3 * cost.iteration, 1e3 * cost.step, cost.factorizations,
        cost.corrections, static_cast<long long>(cost.linear_iterations), cost.iteration / displacement_only,
        cost.good ? "" : "  NOT CONVERGED");
  }
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<double> sizes{1500, 10000, 40000};
  int repeats = 3, threads = 1;
  Element element = Element::tet4;
  for (int i = 1; i < argc; ++i) {
    const bool more = i + 1 < argc;
    if (more && std::strcmp(argv[i], "--tets") == 0) {
      sizes.clear();
      for (const char* p = argv[++i]; *p != '\0';) {
        char* end = nullptr;
        sizes.push_back(std::strtod(p, &end));
        if (end == p) break;
        p = *end == ',' ? end + 1 : end;
      }
    } else if (more && std::strcmp(argv[i], "--repeats") == 0) {
      repeats = std::max(1, std::atoi(argv[++i]));
    } else if (more && std::strcmp(argv[i], "--threads") == 0) {
      threads = std::max(1, std::atoi(argv[++i]));
    } else if (std::strcmp(argv[i], "--smoothed") == 0) {
      element = Element::tet4_edge_smoothed;
    } else {
      std::fprintf(stderr,
                   "usage: isochor_bench_mixed [--tets LIST] [--repeats N] [--smoothed] [--threads N]\n");
      return 2;
    }
  }
  set_blas_threads(threads);
  for (const double tets : sizes) compare(tets, element, repeats, threads);
  return 0;
}
