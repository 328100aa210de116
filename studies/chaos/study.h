// Chaos: seeds in a row, each in a process of its own, and what became of them as tables.
//
// Folder: seeds.csv (a row a seed, renewed after each), tables.md, and the scene of every broken seed in
// seeds/N/scene.json, which `isochor run` takes.
#pragma once

#include <functional>

#include "studies/chaos/run.h"

namespace isochor::studies {

struct ChaosStudyOptions {
  std::uint64_t first = 1, last = 100;  // seeds, both included
  ChaosSize size;
  std::string folder;  // required
  double limit = 120;  // [s] of processor time that a seed may take before it counts as hanging
  int jobs = 1;        // seeds at a time
  bool keep = false;   // the scenes of all seeds, not only of broken ones
  bool judge_time = true;
  std::function<bool()> stop;
  std::function<void(const ChaosOutcome&, std::size_t done, std::size_t total)> on_seed;
};

struct ChaosStudyResult {
  std::vector<ChaosOutcome> outcomes;  // by seed
  std::size_t broken = 0;
  bool interrupted = false;
  std::string failure;  // of outputs that cannot be written
  double seconds = 0;
};

ChaosStudyResult run_chaos_study(const ChaosStudyOptions& options);

// Verdicts in all, by kind of what is broken, by method, and by part of the scene, as Markdown.
std::string chaos_tables(const std::vector<ChaosOutcome>& outcomes, const ChaosSize& size);

// "3-17" or "5".
Result<std::pair<std::uint64_t, std::uint64_t>> parse_seeds(const std::string& text);

}  // namespace isochor::studies
