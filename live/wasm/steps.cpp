// How fast a soft finger is inflated, with which bits: the same program for this machine and, under node, for
// WebAssembly.
//
//   isochor_steps MESH [es|tet4] [STEPS]
#include <isochor/effects.h>
#include <isochor/mesh_io.h>
#include <isochor/schemes.h>
#include <isochor/world.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>

using namespace isochor;

namespace {

template <class T>
T need(Result<T> result) {
  if (result) return std::move(result).value();
  std::fprintf(stderr, "%s\n", result.error().c_str());
  std::exit(2);
}

World finger(const char* mesh, Element element, EffectId& chamber) {
  WorldOptions options;
  options.scheme = implicit_euler();
  options.threads = 1;
  World world = need(World::create(options));
  ElasticConstants silicone;
  silicone.young = 100e3;  // Pa
  silicone.poisson = 0.5;
  BodyDef body;
  body.mesh = need(read_mesh(mesh));
  body.element = element;
  body.materials = {{"", need(neo_hookean(silicone)), 1070}};
  const BodyId id = need(world.add_body(std::move(body)));
  VolumeDef rows;
  rows.body = id;
  need(world.add(volume(rows)));
  DirichletDef clamp;
  clamp.where.body = id;
  clamp.where.surfaces = {"clamped"};
  need(world.add(dirichlet(clamp)));
  CavityDef air;
  air.body = id;
  air.surfaces = {"chamber"};
  chamber = need(world.add(cavity(air)));
  std::printf("%d tetrahedra, %s\n", world.mesh(id).cell_count(),
              element == Element::tet4 ? "Tet4" : "edge-smoothed");
  return world;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: isochor_steps MESH [es|tet4] [STEPS]\n");
    return 2;
  }
  const bool plain = argc > 2 && std::strcmp(argv[2], "tet4") == 0;
  const int steps = argc > 3 ? std::max(1, std::atoi(argv[3])) : 60;
  EffectId chamber{};
  World world = finger(argv[1], plain ? Element::tet4 : Element::tet4_edge_smoothed, chamber);
  // Processor time: what other work the machine has is not counted.
  double spent = 0, first = 0;
  for (int step = 1; step <= steps; ++step) {
    if (const auto set = world.set_amount(chamber, std::min(6000.0, 100.0 * step)); !set) {
      std::fprintf(stderr, "%s\n", set.error().c_str());
      return 2;
    }
    const std::clock_t before = std::clock();
    const StepReport report = world.advance(1.0 / 60);
    const double took = static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
    (step == 1 ? first : spent) += took;
    if (report.status != StepStatus::converged) {
      std::fprintf(stderr, "step %d: %s\n", step, report.reason.c_str());
      return 3;
    }
    if (step == 1 || step == 10 || step == steps)
      std::printf("step %d: state %016llx\n", step, static_cast<unsigned long long>(world.state_hash()));
  }
  std::printf("first step %.0f ms, then %.1f ms a step: %.1f a second\n", 1e3 * first,
              1e3 * spent / std::max(1, steps - 1), std::max(1, steps - 1) / std::max(spent, 1e-9));
  return 0;
}
