// What contact adds to the Newton iteration of a time step.
//
//   isochor_bench_contact [--quick] [--pairs N] [--threads N]
//
// A slab of 11,532 Tet4 (1,944 with --quick) with nodal rows lies on a floor under its weight, in time steps
// of 10 ms: with all nodes of its underside in contact, hard or soft, without friction and with it, lagged
// and coupled, and, in turns with each, the same slab without floor and weight, whose positions are as many
// unknowns. The ratio is the median over the pairs.
#include <isochor/contact.h>
#include <isochor/effects.h>
#include <isochor/generate.h>
#include <isochor/schemes.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <vector>

namespace {

using namespace isochor;

template <class T>
T must(Result<T> result) {
  if (!result) {
    std::fprintf(stderr, "%s\n", result.error().c_str());
    std::exit(2);
  }
  return std::move(result).value();
}

double cpu_milliseconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

struct Kind {
  const char* what;
  bool contact;
  double compliance = 0, friction = 0;
  FrictionCoupling coupling = FrictionCoupling::lagged;
};

struct Outcome {
  double step = 0, iteration = 0;  // processor time [ms]
  int iterations = 0, corrections = 0;
  std::size_t active = 0;
  WorldSize size;
};

Outcome run(const Kind& kind, bool quick, int threads) {
  BoxMeshDef box;
  box.upper = {0.31, 0.31, 0.02};
  box.divisions = quick ? std::array<int, 3>{18, 18, 1} : std::array<int, 3>{31, 31, 2};
  WorldOptions options;
  options.scheme = implicit_euler();
  if (kind.contact) options.gravity = {0, 0, -9.81};
  options.threads = threads;
  World world = must(World::create(options));
  BodyDef def;
  def.mesh = must(box_mesh(box));
  def.materials = {{"", must(neo_hookean({.young = 100e3, .poisson = 0.5})), 1000}};
  const BodyId body = must(world.add_body(def));
  VolumeDef rows;
  rows.body = body;
  must(world.add(volume(rows)));
  // The upper side is pushed about, so that every step has something to solve.
  DirichletDef top;
  top.name = "top";
  top.where.body = body;
  top.where.surfaces = {"z1"};
  top.directions = {{1, 0, 0}};
  top.displacement = {0.02, 0, 0};
  top.amount = Curve::ramp(1, 0.3);
  must(world.add(dirichlet(top)));
  if (kind.contact) {
    ContactDef floor;
    floor.body = body;
    floor.surfaces = {"z0"};
    floor.compliance = kind.compliance;
    floor.friction = kind.friction;
    floor.coupling = kind.coupling;
    must(world.add(contact(floor)));
  }
  constexpr int steps = 8;
  Outcome out;
  double before = 0;
  int factorizations = 0;
  for (int k = 0; k < steps + 3; ++k) {
    if (k == 3) before = cpu_milliseconds();  // analysis and the first touch are over
    const StepReport r = world.step(0.01);
    if (r.status != StepStatus::converged) {
      std::fprintf(stderr, "%s: %s\n", kind.what, r.reason.c_str());
      std::exit(3);
    }
    if (k < 3) continue;
    out.iterations += r.iterations;
    out.corrections += r.corrections;
    factorizations += r.factorizations;
  }
  const double spent = cpu_milliseconds() - before;
  out.step = spent / steps;
  out.iteration = spent / std::max(1, factorizations);
  out.size = world.size();
  for (const Vec3& x : world.positions(body)) out.active += x.z < 1e-6;
  return out;
}

double median(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  return 0.5 * (v[(v.size() - 1) / 2] + v[v.size() / 2]);
}

}  // namespace

int main(int argc, char** argv) {
  bool quick = false;
  int pairs = 3, threads = 0;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--quick") == 0) {
      quick = true;
    } else if (std::strcmp(argv[i], "--pairs") == 0 && i + 1 < argc) {
      pairs = std::max(1, std::atoi(argv[++i]));
    } else if (std::strcmp(argv[i], "--threads") == 0 && i + 1 < argc) {
      threads = std::atoi(argv[++i]);
    } else {
      std::fprintf(
          stderr,
          "isochor_bench_contact: \"%s\" is no option; there are --quick, --pairs N and --threads N\n",
          argv[i]);
      return 2;
    }
  }
  constexpr Kind kFree{"free", false};
  constexpr Kind kKinds[] = {{"hard", true},
                             {"soft, 1e-8 m/Pa", true, 1e-8},
                             {"hard, friction 0.3", true, 0, 0.3},
                             {"soft, friction 0.3", true, 1e-8, 0.3},
                             {"hard, 0.3, coupled", true, 0, 0.3, FrictionCoupling::coupled},
                             {"soft, 0.3, coupled", true, 1e-8, 0.3, FrictionCoupling::coupled}};
  for (const Kind& kind : kKinds) {
    std::vector<double> step, iteration, free_step, touching;
    Outcome a, b;
    for (int k = 0; k <= pairs; ++k) {  // the first pair warms up
      a = run(kFree, quick, threads);
      b = run(kind, quick, threads);
      if (k == 0) continue;
      free_step.push_back(a.step);
      touching.push_back(b.step);
      step.push_back(b.step / a.step);
      iteration.push_back(b.iteration / a.iteration);
    }
    std::printf(
        "%-20s %4zu nodes touch; a step %.0f ms, free %.0f ms: %+.1f %% (pairs %+.1f to %+.1f); a "
        "factorization's worth "
        "%+.1f %%; iterations %d and %d corrections, free %d and %d\n",
        kind.what, b.active, median(touching), median(free_step), 100 * (median(step) - 1),
        100 * (*std::min_element(step.begin(), step.end()) - 1),
        100 * (*std::max_element(step.begin(), step.end()) - 1), 100 * (median(iteration) - 1), b.iterations,
        b.corrections, a.iterations, a.corrections);
    std::fflush(stdout);
  }
}
