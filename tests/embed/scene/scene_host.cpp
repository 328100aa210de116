// Runs a scene file as the command line does and prints its state hash:   scene_host FILE [CHANGE...]
#include <isochor/scene.h>

#include <cinttypes>
#include <cstdio>
#include <string>
#include <vector>

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  const auto scene = isochor::read_scene(argv[1], std::vector<std::string>(argv + 2, argv + argc));
  if (!scene) {
    std::fprintf(stderr, "%s\n", scene.error().c_str());
    return 2;
  }
  auto made = scene.value().world(1);
  if (!made) {
    std::fprintf(stderr, "%s\n", made.error().c_str());
    return 2;
  }
  isochor::SceneWorld& s = made.value();
  for (int k = 0; k < scene.value().steps(); ++k) {
    const auto report = s.world.advance(scene.value().step_length());
    if (report.status == isochor::StepStatus::converged) continue;
    std::fprintf(stderr, "%s\n", report.reason.c_str());
    return 3;
  }
  for (const auto& probe : s.probes) {
    const auto x = s.probe(probe.name);
    std::printf("%s: %.3f %.3f %.3f mm\n", probe.name.c_str(), 1e3 * x.value().x, 1e3 * x.value().y,
                1e3 * x.value().z);
  }
  std::printf("%016" PRIx64 "\n", s.world.state_hash());
  return s.body("no such body").ok() ? 1 : 0;
}
