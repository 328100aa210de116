// Inflates a soft finger in frames of 1/60 s.   finger scenes/meshes/finger_small.msh
#include <isochor/effects.h>
#include <isochor/mesh_io.h>
#include <isochor/schemes.h>
#include <isochor/world.h>

#include <cstdio>
#include <cstdlib>

using namespace isochor;

// Nothing throws. What is refused says in one sentence what, where and the remedy.
void check(const Result<void>& done) {
  if (done) return;
  std::fprintf(stderr, "%s\n", done.error().c_str());
  std::exit(2);
}
template <class T>
T need(Result<T> result) {
  if (!result) check(Error{result.error()});
  return std::move(result).value();
}

int main(int argc, char** argv) {
  WorldOptions options;
  options.scheme = implicit_euler();
  World world = need(World::create(options));

  ElasticConstants silicone;
  silicone.young = 100e3;  // Pa
  silicone.poisson = 0.5;  // incompressible: an ordinary input
  BodyDef body;
  body.mesh = need(read_mesh(argc > 1 ? argv[1] : "scenes/meshes/finger_small.msh"));
  body.materials = {{"", need(neo_hookean(silicone)), 1070}};
  const BodyId finger = need(world.add_body(std::move(body)));

  VolumeDef rows;  // pressures at the nodes
  rows.body = finger;
  need(world.add(volume(rows)));
  DirichletDef clamp;
  clamp.where.body = finger;
  clamp.where.surfaces = {"clamped"};
  need(world.add(dirichlet(clamp)));
  CavityDef air;
  air.body = finger;
  air.surfaces = {"chamber"};
  const EffectId chamber = need(world.add(cavity(air)));

  for (int frame = 1; frame <= 60; ++frame) {
    check(world.set_amount(chamber, 100.0 * frame));  // Pa
    const StepReport report = world.advance(1.0 / 60);
    if (report.status != StepStatus::converged) {
      std::fprintf(stderr, "%s\n", report.reason.c_str());
      return 3;
    }
    const Vec3 tip = world.positions(finger).back();  // a view of the state, no copy
    if (frame % 10 == 0)
      std::printf("%.2f s  the last node is at (%.1f, %.1f, %.1f) mm\n", world.time(), 1e3 * tip.x,
                  1e3 * tip.y, 1e3 * tip.z);
  }
}
