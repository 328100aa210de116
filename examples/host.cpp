// A program that embeds Isochor: a soft cushion with an air chamber is inflated in real time steps, and every
// frame its surface is handed to a renderer without copying.
//
//   host scenes/meshes/cushion.msh
#include <isochor/effects.h>
#include <isochor/mesh_io.h>
#include <isochor/schemes.h>
#include <isochor/world.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

namespace {

// Nothing in Isochor throws: what can be refused comes as a Result with one sentence that says why.
template <class T>
T checked(isochor::Result<T> result) {
  if (result) return std::move(result).value();
  std::fprintf(stderr, "%s\n", result.error().c_str());
  std::exit(1);
}

// Stands for a renderer: any code that takes contiguous (x, y, z) doubles.
double highest_point(const double* xyz, std::size_t points) {
  double top = xyz[1];
  for (std::size_t i = 0; i < points; ++i) top = std::max(top, xyz[3 * i + 1]);
  return top;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: host MESH, for example scenes/meshes/cushion.msh\n");
    return 1;
  }
  isochor::WorldOptions options;
  options.scheme = isochor::implicit_euler();
  options.gravity = {0, -9.8, 0};
  isochor::World world = checked(isochor::World::create(options));

  // A rubber of 90 kPa that keeps its volume exactly.
  isochor::ElasticConstants rubber;
  rubber.young = 90e3;
  rubber.poisson = 0.5;
  isochor::BodyDef body;
  body.name = "cushion";
  body.mesh = checked(isochor::read_mesh(argv[1]));
  body.materials = {{"", checked(isochor::neo_hookean(rubber)), 1000}};
  const isochor::BodyId cushion = checked(world.add_body(body));

  isochor::VolumeDef incompressible;
  incompressible.body = cushion;
  checked(world.add(isochor::volume(incompressible)));

  isochor::DirichletDef glued;
  glued.where.body = cushion;
  glued.where.surfaces = {"clamped"};
  checked(world.add(isochor::dirichlet(glued)));

  isochor::CavityDef air;
  air.body = cushion;
  air.surfaces = {"chamber"};
  const isochor::EffectId chamber = checked(world.add(isochor::cavity(air)));

  const double frame = 1.0 / 60;  // [s]
  for (int i = 1; i <= 30; ++i) {
    const double pressure = std::min(4000.0, 200.0 * i);  // [Pa]
    if (const auto set = world.set_amount(chamber, pressure); !set) {
      std::fprintf(stderr, "%s\n", set.error().c_str());
      return 1;
    }
    const isochor::StepReport report = world.step(frame);
    if (report.status != isochor::StepStatus::converged) {
      std::fprintf(stderr, "frame %d: %s\n", i, report.reason.c_str());
      return 1;
    }
    // A view of the state's own memory, valid until the next step.
    const auto positions = world.positions(cushion);
    const double top = highest_point(&positions[0].x, positions.size());
    if (i % 10 == 0) std::printf("%.3f s  %4.0f Pa  top at %.2f mm\n", world.time(), pressure, 1e3 * top);
  }
  std::printf("volume changed by %+.1e\n", world.measures(cushion).volume_change());
  return 0;
}
