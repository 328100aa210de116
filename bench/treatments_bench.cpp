// What the treatment of rows costs: kept in the saddle point, condensed into the stiffness, bordered.
//
//   isochor_bench_treatments [--quick]
//
// A block of 39,600 Tet4 (1,920 with --quick) bends under its weight; the static Newton iteration is timed.
#include <isochor/effects.h>
#include <isochor/generate.h>
#include <isochor/schemes.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "must.h"
#include "options.h"

namespace {

using namespace isochor;
using bench::must;

struct Case {
  const char* what;
  VolumeSpace space;
  double poisson;
  RowTreatment local;
  bool lumped, zone;
  RowTreatment global;
};

void run(const Case& c, bool quick) {
  BoxMeshDef box;
  box.upper = {0.5, 0.1, 0.1};
  box.divisions = quick ? std::array<int, 3>{20, 4, 4} : std::array<int, 3>{66, 10, 10};
  WorldOptions options;
  options.scheme = statics();
  options.gravity = {0, 0, -9.81};
  World world = must(World::create(options));
  BodyDef def;
  def.mesh = must(box_mesh(box));
  def.element = Element::tet4;
  def.materials = {{"", must(neo_hookean({.young = 300e3, .poisson = c.poisson})), 1070}};
  const BodyId body = must(world.add_body(def));
  VolumeDef rows;
  rows.body = body;
  rows.space = c.space;
  rows.treatment = c.local;
  rows.lumped_compliance = c.lumped;
  must(world.add(volume(rows)));
  if (c.zone) {
    VolumeDef whole;
    whole.name = "whole";
    whole.body = body;
    whole.space = VolumeSpace::body;
    whole.hard = true;
    whole.carries_bulk = false;
    whole.treatment = c.global;
    must(world.add(volume(whole)));
  }
  DirichletDef fixed;
  fixed.where.body = body;
  fixed.where.surfaces = {"x0"};
  must(world.add(dirichlet(fixed)));
  const StepReport r = world.advance(1);
  const WorldSize size = world.size();
  const double n = r.factorizations;
  std::printf(
      "%-58s %8d unknowns in the matrix, %9lld non-zeros, %2d iterations, per factorization [ms]: factor "
      "%.0f, "
      "solve %.0f, gather %.0f%s\n",
      c.what, size.matrix_size, static_cast<long long>(size.matrix_nonzeros), r.iterations,
      1e3 * r.seconds.factor / n, 1e3 * r.seconds.solve / n, 1e3 * r.seconds.gather / n,
      r.status == StepStatus::converged ? "" : (" NOT CONVERGED: " + r.reason).c_str());
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  isochor::bench::check_options(argc, argv, {"--quick"}, {});
  const bool quick = argc > 1 && std::strcmp(argv[1], "--quick") == 0;
  using T = RowTreatment;
  const Case cases[] = {
      {"element rows, nu 0.45, kept", VolumeSpace::element, 0.45, T::saddle, false, false, T::automatic},
      {"element rows, nu 0.45, condensed", VolumeSpace::element, 0.45, T::condensed, false, false,
       T::automatic},
      {"nodal rows, nu 0.45, consistent, kept", VolumeSpace::node, 0.45, T::saddle, false, false,
       T::automatic},
      {"nodal rows, nu 0.45, lumped, kept", VolumeSpace::node, 0.45, T::saddle, true, false, T::automatic},
      {"nodal rows, nu 0.45, lumped, condensed", VolumeSpace::node, 0.45, T::condensed, true, false,
       T::automatic},
      {"element rows condensed + hard row over all, kept", VolumeSpace::element, 0.45, T::condensed, false,
       true, T::saddle},
      {"element rows condensed + hard row over all, bordered", VolumeSpace::element, 0.45, T::condensed,
       false, true, T::bordered},
  };
  for (const Case& c : cases) run(c, quick);
  return 0;
}
