// What contact adds to the Newton iteration of a time step.
//
//   isochor_bench_contact [--quick] [--surfaces] [--only WORD] [--pairs N] [--threads N]
//
// A slab of 11,532 Tet4 (1,944 with --quick) with nodal rows lies on a floor under its weight, in time steps
// of 10 ms: with all nodes of its underside in contact, hard or soft, without friction and with it, lagged
// and coupled, and, in turns with each, the same slab without floor and weight, whose positions are as many
// unknowns. The ratio is the median over the pairs. --only takes the cases whose name has the word in it.
#include <isochor/contact.h>
#include <isochor/effects.h>
#include <isochor/generate.h>
#include <isochor/schemes.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <iterator>
#include <string>
#include <vector>

#include "must.h"

namespace {

using namespace isochor;
using bench::must;

double cpu_milliseconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

enum class On : std::uint8_t { nothing, floor, slab, far_slab };
struct Kind {
  const char* what;
  On on;
  double compliance = 0, friction = 0;
  FrictionCoupling coupling = FrictionCoupling::lagged;
};

struct Outcome {
  double step = 0, iteration = 0;  // processor time [ms]
  int iterations = 0, corrections = 0, factorizations = 0;
  std::size_t active = 0;
  StageSeconds seconds;
};

constexpr double kCell = 0.01;  // of the blocks on each other [m]

BodyId add_block(World& world, const char* name, const Vec3& lower, const Vec3& upper,
                 std::array<int, 3> cells) {
  BoxMeshDef box;
  box.lower = lower;
  box.upper = upper;
  box.divisions = cells;
  BodyDef def;
  def.name = name;
  def.mesh = must(box_mesh(box));
  def.materials = {{"", must(neo_hookean({.young = 100e3, .poisson = 0.5})), 1000}};
  const BodyId body = must(world.add_body(def));
  VolumeDef rows;
  rows.name = std::string("volume of ") + name;
  rows.body = body;
  must(world.add(volume(rows)));
  return body;
}

// What lies on the floor or on a slab, or flies free.
BodyId add_upper(World& world, const Kind& kind, bool quick) {
  if (kind.on == On::nothing || kind.on == On::floor)
    return add_block(world, "slab", {}, {0.31, 0.31, 0.02},
                     quick ? std::array<int, 3>{18, 18, 1} : std::array<int, 3>{31, 31, 2});
  const double up = kind.on == On::far_slab ? 0.02 : 0;
  const int wide = quick ? 6 : 9, deep = quick ? 9 : 11, under = quick ? 10 : 14, thick = quick ? 2 : 4;
  const double side = kCell * wide, at = kCell * (0.23 + 0.5 * (under - wide));
  const BodyId body =
      add_block(world, "block", {at, at, up}, {at + side, at + side, up + 0.05}, {wide, wide, deep});
  const BodyId slab =
      add_block(world, "lower slab", {0, 0, -0.03}, {kCell * under, kCell * under, 0}, {under, under, thick});
  DirichletDef bottom;
  bottom.name = "bottom";
  bottom.where.body = slab;
  bottom.where.surfaces = {"z0"};
  must(world.add(dirichlet(bottom)));
  SurfaceContactDef pair;
  pair.body = body;
  pair.against = slab;
  must(world.add(surface_contact(pair)));
  return body;
}

std::size_t count_active(const World& world, const Kind& kind, BodyId body) {
  std::size_t active = 0;
  if (kind.on == On::floor) {
    for (const Vec3& x : world.positions(body)) active += x.z < 1e-6;
    return active;
  }
  // Twelve points a cell of both sides.
  for (const Gauge& g : world.gauges()) {
    if (g.kind == "contact" && g.quantity == "contact_area")
      active = static_cast<std::size_t>(std::lround(12 * g.value / (kCell * kCell)));
  }
  return active;
}

Outcome run(const Kind& kind, bool quick, int threads) {
  WorldOptions options;
  options.scheme = implicit_euler();
  if (kind.on == On::floor || kind.on == On::slab) options.gravity = {0, 0, -9.81};
  options.threads = threads;
  World world = must(World::create(options));
  const BodyId body = add_upper(world, kind, quick);
  // The upper side is pushed about, so that every step has something to solve.
  DirichletDef top;
  top.name = "top";
  top.where.body = body;
  top.where.surfaces = {"z1"};
  top.directions = {{1, 0, 0}};
  top.displacement = {0.02, 0, 0};
  top.amount = Curve::ramp(1, 0.3);
  must(world.add(dirichlet(top)));
  if (kind.on == On::floor) {
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
    out.factorizations += r.factorizations;
    out.seconds.analyze += r.seconds.analyze;
    out.seconds.evaluate += r.seconds.evaluate + r.seconds.gather + r.seconds.line_search;
    out.seconds.factor += r.seconds.factor;
    out.seconds.solve += r.seconds.solve;
    out.seconds.total += r.seconds.total;
  }
  const double spent = cpu_milliseconds() - before;
  out.step = spent / steps;
  out.iteration = spent / std::max(1, out.factorizations);
  out.active = count_active(world, kind, body);
  return out;
}

double median(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  return 0.5 * (v[(v.size() - 1) / 2] + v[v.size() / 2]);
}

struct Case {
  Kind touching, apart;
};

void compare(const Case& c, int pairs, bool quick, int threads) {
  std::vector<double> step, iteration, free_step, touching;
  Outcome a, b;
  for (int k = 0; k <= pairs; ++k) {  // the first pair warms up
    a = run(c.apart, quick, threads);
    b = run(c.touching, quick, threads);
    if (k == 0) continue;
    free_step.push_back(a.step);
    touching.push_back(b.step);
    step.push_back(b.step / a.step);
    iteration.push_back(b.iteration / a.iteration);
  }
  std::printf(
      "%-20s %4zu points touch; a step %.0f ms, free %.0f ms: %+.1f %% (pairs %+.1f to %+.1f); a "
      "factorization's worth "
      "%+.1f %%; %d iterations, %d factorizations, %d corrections, free %d, %d, %d\n",
      c.touching.what, b.active, median(touching), median(free_step), 100 * (median(step) - 1),
      100 * (*std::min_element(step.begin(), step.end()) - 1),
      100 * (*std::max_element(step.begin(), step.end()) - 1), 100 * (median(iteration) - 1), b.iterations,
      b.factorizations, b.corrections, a.iterations, a.factorizations, a.corrections);
  const auto stages = [](const char* what, const Outcome& o) {
    const auto& t = o.seconds;
    std::printf(
        "    wall time of the %s: analysis %.0f ms, evaluation %.0f, factorizations %.0f, solves %.0f, rest "
        "%.0f\n",
        what, 1e3 * t.analyze, 1e3 * t.evaluate, 1e3 * t.factor, 1e3 * t.solve,
        1e3 * (t.total - t.analyze - t.evaluate - t.factor - t.solve));
  };
  stages("last run that touches", b);
  stages("last free run", a);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  bool quick = false, surfaces_only = false;
  const char* only = "";
  int pairs = 3, threads = 0;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--quick") == 0) {
      quick = true;
    } else if (std::strcmp(argv[i], "--surfaces") == 0) {
      surfaces_only = true;
    } else if (std::strcmp(argv[i], "--only") == 0 && i + 1 < argc) {
      only = argv[++i];
    } else if (std::strcmp(argv[i], "--pairs") == 0 && i + 1 < argc) {
      pairs = std::max(1, std::atoi(argv[++i]));
    } else if (std::strcmp(argv[i], "--threads") == 0 && i + 1 < argc) {
      threads = std::atoi(argv[++i]);
    } else {
      std::fprintf(stderr,
                   "isochor_bench_contact: \"%s\" is no option; there are --quick, --surfaces, --only WORD, "
                   "--pairs N and --threads N\n",
                   argv[i]);
      return 2;
    }
  }
  constexpr Kind kFree{"free", On::nothing};
  constexpr Case kFloors[] = {
      {{"hard", On::floor}, kFree},
      {{"soft, 1e-8 m/Pa", On::floor, 1e-8}, kFree},
      {{"hard, friction 0.3", On::floor, 0, 0.3}, kFree},
      {{"soft, friction 0.3", On::floor, 1e-8, 0.3}, kFree},
      {{"hard, 0.3, coupled", On::floor, 0, 0.3, FrictionCoupling::coupled}, kFree},
      {{"soft, 0.3, coupled", On::floor, 1e-8, 0.3, FrictionCoupling::coupled}, kFree}};
  constexpr Case kSurfaces{{"soft on soft", On::slab}, {"apart", On::far_slab}};
  std::vector<Case> cases;
  if (!surfaces_only) cases.assign(std::begin(kFloors), std::end(kFloors));
  cases.push_back(kSurfaces);
  std::string names;
  int measured = 0;
  for (const Case& c : cases) {
    names += std::string("\n  ") + c.touching.what;
    if (!std::strstr(c.touching.what, only)) continue;
    compare(c, pairs, quick, threads);
    ++measured;
  }
  if (measured > 0) return 0;
  std::fprintf(stderr, "isochor_bench_contact: --only \"%s\" is in the name of no case; there are%s\n", only,
               names.c_str());
  return 2;
}
