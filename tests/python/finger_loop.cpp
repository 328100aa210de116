// The loop of examples/finger.cpp with its bits and its time, which Python's are held against.
//   finger_loop mesh frames
// Prints "state <hash>" after each frame and "seconds <s>" for all steps but the first.
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "isochor/effects.h"
#include "isochor/mesh_io.h"
#include "isochor/schemes.h"
#include "isochor/world.h"

namespace {

using namespace isochor;

template <class T>
T need(Result<T> result) {
  if (!result) {
    std::fprintf(stderr, "%s\n", result.error().c_str());
    std::exit(2);
  }
  return std::move(result).value();
}

struct Finger {
  World world;
  EffectId air{};
};

Finger make_finger(const char* mesh) {
  WorldOptions options;
  options.scheme = implicit_euler();
  options.threads = std::getenv("ISOCHOR_THREADS") ? std::atoi(std::getenv("ISOCHOR_THREADS")) : 0;
  Finger finger{need(World::create(options))};
  ElasticConstants silicone;
  silicone.young = 100e3;
  silicone.poisson = 0.5;
  BodyDef body;
  body.mesh = need(read_mesh(mesh));
  body.materials = {{"", need(neo_hookean(silicone)), 1070}};
  const BodyId id = need(finger.world.add_body(std::move(body)));
  VolumeDef rows;
  rows.body = id;
  need(finger.world.add(volume(rows)));
  DirichletDef clamp;
  clamp.where.body = id;
  clamp.where.surfaces = {"clamped"};
  need(finger.world.add(dirichlet(clamp)));
  CavityDef air;
  air.body = id;
  air.surfaces = {"chamber"};
  finger.air = need(finger.world.add(cavity(air)));
  return finger;
}

}  // namespace

int main(int argc, char** argv) {
  using Clock = std::chrono::steady_clock;
  if (argc < 3) return 2;
  Finger finger = make_finger(argv[1]);
  double seconds = 0;
  for (int frame = 1; frame <= std::atoi(argv[2]); ++frame) {
    const auto start = Clock::now();
    if (!finger.world.set_amount(finger.air, 100.0 * frame)) return 2;
    const StepReport report = finger.world.advance(1.0 / 60);
    if (report.status != StepStatus::converged) return 3;
    if (frame > 1) seconds += std::chrono::duration<double>(Clock::now() - start).count();
    std::printf("state %016llx\n", static_cast<unsigned long long>(finger.world.state_hash()));
  }
  std::printf("seconds %.6f\n", seconds);
}
