// Runs the scene of a seed and judges how it ends.
#pragma once

#include <string>
#include <vector>

#include "studies/chaos/scene.h"

namespace isochor::studies {

enum class ChaosVerdict {
  solved,   // every step converged, and every state is admissible
  told,     // converged to admissible states, about which a warning says something: inverted cells, a far end
  refused,  // the scene is not taken, and a message says why
  stopped,  // a step was rejected, cancelled or out of its budget, with a reason; the state is the last good
            // one
  broken,   // wrong, and called right; or a crash, a hang, a state that a rejected step changed
};
const char* to_string(ChaosVerdict verdict);

struct ChaosOutcome {
  std::uint64_t seed = 0;
  ChaosVerdict verdict = ChaosVerdict::broken;
  std::string kind;     // of what is broken, one or two words
  std::string reason;   // the engine's, or the judge's
  std::string warning;  // of the first step that converged with one
  int steps = 0, asked = 0, iterations = 0;
  double seconds = 0;
  // Beyond a budget in seconds, of wall time, and what of it was work of its own.
  double overshoot = 0, own_overshoot = 0;
  double min_J = 1;
  long inverted = 0;
};

struct ChaosRunOptions {
  std::string folder;  // where scene.json and its files are written
  // An overshoot of more than a second is broken. False: budgets count iterations in place of seconds.
  bool judge_time = true;
};

ChaosOutcome run_chaos_scene(const ChaosScene& chaos, const ChaosRunOptions& options);

}  // namespace isochor::studies
