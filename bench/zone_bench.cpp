// What one global zone adds to the Newton iteration.
//
//   isochor_bench_zone [--quick] [--pairs N] [--threads N]
//
// A block of 39,600 Tet4 (1,920 with --quick) bends under its weight in statics, without and with one hard
// row over its whole volume. Both are run in turns, so that what else the machine does hits both: the ratio
// is the median over the pairs. Counts of non-zeros and solves beside it do not depend on the machine.
#include <isochor/effects.h>
#include <isochor/generate.h>
#include <isochor/schemes.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <vector>

#include "must.h"
#include "options.h"

namespace {

using namespace isochor;
using bench::must;

struct Base {
  const char* what;
  Element element;
  bool rows;  // nodal; otherwise the complete one-field energy
};

double cpu_milliseconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

struct Outcome {
  double iteration = 0;  // processor time [ms]
  int iterations = 0;
  WorldSize size;
};

Outcome run(const Base& base, bool zone, bool quick, int threads) {
  BoxMeshDef box;
  box.upper = {0.5, 0.1, 0.1};
  box.divisions = quick ? std::array<int, 3>{20, 4, 4} : std::array<int, 3>{66, 10, 10};
  WorldOptions options;
  options.scheme = statics();
  options.gravity = {0, 0, -9.81};
  options.gravity_curve = Curve::ramp(1);
  options.threads = threads;
  World world = must(World::create(options));
  BodyDef def;
  def.mesh = must(box_mesh(box));
  def.element = base.element;
  def.materials = {{"", must(neo_hookean({.young = 300e3, .poisson = 0.45})), 1070}};
  const BodyId body = must(world.add_body(def));
  VolumeDef rows;
  rows.body = body;
  if (base.rows) must(world.add(volume(rows)));
  if (zone) {
    rows.name = "whole";
    rows.space = VolumeSpace::body;
    rows.hard = true;
    rows.carries_bulk = false;
    must(world.add(volume(rows)));
  }
  DirichletDef fixed;
  fixed.where.body = body;
  fixed.where.surfaces = {"x0"};
  must(world.add(dirichlet(fixed)));
  StepReport r = world.advance(0.5);
  const double before = cpu_milliseconds();
  if (r.status == StepStatus::converged) r = world.advance(0.5);
  const double spent = cpu_milliseconds() - before;
  if (r.status != StepStatus::converged) {
    std::fprintf(stderr, "%s: %s\n", base.what, r.reason.c_str());
    std::exit(3);
  }
  return {spent / r.factorizations, r.iterations, world.size()};
}

double median(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  return 0.5 * (v[(v.size() - 1) / 2] + v[v.size() / 2]);
}

}  // namespace

int main(int argc, char** argv) {
  isochor::bench::check_options(argc, argv, {"--quick"}, {"--pairs", "--threads"});
  bool quick = false;
  int pairs = 3, threads = 0;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--quick") == 0) quick = true;
    if (std::strcmp(argv[i], "--pairs") == 0 && i + 1 < argc) pairs = std::max(1, std::atoi(argv[++i]));
    if (std::strcmp(argv[i], "--threads") == 0 && i + 1 < argc) threads = std::atoi(argv[++i]);
  }
  constexpr Base kBases[] = {{"one field, nu 0.45", Element::tet4, false},
                             {"nodal rows, nu 0.45", Element::tet4, true},
                             {"edge-smoothed, nodal rows, nu 0.45", Element::tet4_edge_smoothed, true}};
  for (const Base& base : kBases) {
    std::vector<double> ratio, plain, zoned;
    Outcome a, b;
    for (int k = 0; k <= pairs; ++k) {  // the first pair warms up
      a = run(base, false, quick, threads);
      b = run(base, true, quick, threads);
      if (k == 0) continue;
      plain.push_back(a.iteration);
      zoned.push_back(b.iteration);
      ratio.push_back(b.iteration / a.iteration);
    }
    std::printf(
        "%-36s %.0f ms an iteration, with the zone %.0f ms: %+.1f %% (pairs %+.1f to %+.1f); iterations %d "
        "and %d; non-zeros %lld and %lld, of the factor %lld and %lld\n",
        base.what, median(plain), median(zoned), 100 * (median(ratio) - 1),
        100 * (*std::min_element(ratio.begin(), ratio.end()) - 1),
        100 * (*std::max_element(ratio.begin(), ratio.end()) - 1), a.iterations, b.iterations,
        static_cast<long long>(a.size.matrix_nonzeros), static_cast<long long>(b.size.matrix_nonzeros),
        static_cast<long long>(a.size.factor_nonzeros), static_cast<long long>(b.size.factor_nonzeros));
    std::fflush(stdout);
  }
  return 0;
}
