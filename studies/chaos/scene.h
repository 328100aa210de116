// Random scenes over the whole shelf: one seed, one scene, the same on every machine.
#pragma once

#include <string>
#include <vector>

#include "scenes/scene.h"

namespace isochor::studies {

struct ChaosSize {
  int largest_cells = 150;  // of a body, before edges are raised to ten nodes
  int most_steps = 10;
  bool library_meshes = true;  // also the small meshes of the library
  // A fraction of a second for most seeds.
  static ChaosSize small() { return {24, 3, false}; }
};

// What a seed asks of a world beside its scene.
struct ChaosDrive {
  bool single_increments = false;  // step() in place of advance()
  int budget_iterations = 0;       // of the first half of the steps, each; 0: none
  double budget_seconds = 0;       // likewise
  double wall_seconds = 0;         // of the whole run, which is stopped then; 0: none
  bool cancels = false;            // by cancel() from a report of progress; else by stop_when()
  int cancel_after = 0;            // reports of progress: cancel() is called from the last of them; 0: not
  int reload_after = -1;           // steps, then the state is saved and loaded into a new world
};

struct ChaosFile {
  std::string name, text;
};

struct ChaosScene {
  std::uint64_t seed = 0;
  SceneDef scene;
  std::vector<ChaosFile> files;  // meshes, surfaces and poses that the scene names
  ChaosDrive drive;
};

ChaosScene chaos_scene(std::uint64_t seed, const ChaosSize& size = {});

// Effects, elements and other parts that tables count by.
std::vector<std::string> parts_of(const SceneDef& scene);

// Writes scene.json and its files into a folder; the scene as read back from there, which is what runs.
Result<SceneDef> write_chaos_scene(const ChaosScene& chaos, const std::string& folder);

}  // namespace isochor::studies
