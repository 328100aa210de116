// What it costs that a world changes: a step alone, behind a changed material, behind a support that comes
// and goes; a clone; and many worlds side by side against one after the other.
//
//   isochor_bench_living [--meshes scenes/meshes] [--worlds N] [--quick]
#include <isochor/batch.h>
#include <isochor/effects.h>
#include <isochor/mesh_io.h>
#include <isochor/schemes.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include "must.h"
#include "options.h"

namespace {

using namespace isochor;
using bench::must;

struct Finger {
  World world;
  BodyId body;
  EffectId air;
};

MaterialPtr silicone(double young) {
  return must(neo_hookean({.young = young, .poisson = 0.5}));
}

Finger build(const std::string& mesh, int threads) {
  WorldOptions options;
  options.scheme = implicit_euler();
  options.threads = threads;
  World world = must(World::create(options));
  BodyDef def;
  def.mesh = must(read_mesh(mesh));
  def.materials = {{"", silicone(100e3), 1070}};
  const BodyId body = must(world.add_body(std::move(def)));
  VolumeDef rows;
  rows.body = body;
  must(world.add(volume(rows)));
  DirichletDef clamp;
  clamp.where.body = body;
  clamp.where.surfaces = {"clamped"};
  must(world.add(dirichlet(clamp)));
  CavityDef chamber;
  chamber.body = body;
  chamber.surfaces = {"chamber"};
  const EffectId air = must(world.add(cavity(chamber)));
  must(world.compile());
  return {std::move(world), body, air};
}

double seconds(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void step(World& world) {
  const StepReport r = world.advance(1.0 / 60);
  if (r.status == StepStatus::converged) return;
  std::fprintf(stderr, "%s\n", r.reason.c_str());
  std::exit(3);
}

double median(std::vector<double> v) {
  std::nth_element(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2), v.end());
  return v[v.size() / 2];
}

// The same frames with a change before each; milliseconds a frame, and of them the compilation.
void frames(const char* what, const std::string& mesh, int count,
            const std::function<void(Finger&, int)>& change) {
  Finger f = build(mesh, 2);
  std::vector<double> all, compiling;
  for (int k = 1; k <= count; ++k) {
    must(f.world.set_amount(f.air, 100.0 * k));
    change(f, k);
    CompileReport compiled;
    all.push_back(1e3 * seconds([&] {
                    const StepReport r = f.world.advance(1.0 / 60);
                    compiled = r.compiled;
                    if (r.status != StepStatus::converged) {
                      std::fprintf(stderr, "%s\n", r.reason.c_str());
                      std::exit(3);
                    }
                  }));
    compiling.push_back(1e3 * compiled.seconds);
  }
  std::printf("%-34s %8.2f ms a frame, %8.2f of it compiling\n", what, median(all), median(compiling));
}

void changes(const std::string& mesh, int count) {
  frames("nothing changes", mesh, count, [](Finger&, int) {});
  frames("gravity", mesh, count, [](Finger& f, int k) { must(f.world.set_gravity({0, 0, -0.1 * k})); });
  frames("material", mesh, count,
         [](Finger& f, int k) { must(f.world.set_material(f.body, "", silicone(100e3 + 100 * k))); });
  EffectId spring{};
  frames("a spring comes and goes", mesh, count, [&spring](Finger& f, int k) {
    if (k % 2 == 0) return must(f.world.remove(spring));
    DirichletDef def;
    def.name = "grab";
    def.where.body = f.body;
    def.points = {f.world.rest_positions(f.body).back()};
    def.treatment = SupportTreatment::stiffness;
    def.stiffness = 1;
    spring = must(f.world.add(dirichlet(def)));
  });
  Finger f = build(mesh, 2);
  step(f.world);
  std::vector<double> cloning;
  for (int k = 0; k < 5; ++k) cloning.push_back(1e3 * seconds([&] { (void)must(f.world.clone()); }));
  std::printf("%-34s %8.2f ms\n", "a clone", median(cloning));
}

// Frames a second of all worlds together.
void batch(const std::string& mesh, Index worlds, int count) {
  Finger f = build(mesh, 1);
  step(f.world);
  const auto drive = [&](World& world, int k, Index w) {
    must(world.set_amount(f.air, 100.0 * k + 10.0 * static_cast<double>(w)));
  };
  std::vector<World> alone;
  for (Index w = 0; w < worlds; ++w) alone.push_back(must(f.world.clone(1)));
  const double one = seconds([&] {
    for (int k = 1; k <= count; ++k) {
      for (Index w = 0; w < worlds; ++w) {
        drive(alone[static_cast<std::size_t>(w)], k, w);
        step(alone[static_cast<std::size_t>(w)]);
      }
    }
  });
  WorldBatch all = must(WorldBatch::create(f.world, worlds));
  const double together = seconds([&] {
    for (int k = 1; k <= count; ++k) {
      for (Index w = 0; w < worlds; ++w) drive(all[w], k, w);
      for (const StepReport& r : all.advance(1.0 / 60)) {
        if (r.status != StepStatus::converged) std::exit(3);
      }
    }
  });
  bool same = true;
  for (Index w = 0; w < worlds; ++w)
    same = same && all[w].state_hash() == alone[static_cast<std::size_t>(w)].state_hash();
  const double frames_made = static_cast<double>(worlds) * count;
  const WorldBatch::Memory memory = all.memory();
  std::printf("%d worlds: %.1f frames/s one after the other on one thread, %.1f on %d: %.2f times; %s bits\n",
              static_cast<int>(worlds), frames_made / one, frames_made / together, all.threads(),
              one / together, same ? "the same" : "OTHER");
  std::printf("%.2f MB each, %.2f MB shared\n", 1e-6 * static_cast<double>(memory.each),
              1e-6 * static_cast<double>(memory.shared));
}

}  // namespace

int main(int argc, char** argv) {
  bench::check_options(argc, argv, {"--quick"}, {"--meshes", "--worlds"});
  std::string meshes = "scenes/meshes";
  Index worlds = 16;
  bool quick = false;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--quick") quick = true;
    if (word == "--meshes") meshes = argv[++i];
    if (word == "--worlds") worlds = std::max(1, std::atoi(argv[++i]));
  }
  const std::string small = meshes + "/finger_small.msh";
  changes(small, quick ? 6 : 40);
  batch(small, worlds, quick ? 2 : 20);
  return 0;
}
