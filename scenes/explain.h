// What a scene is made of and what it costs: every effect that is on, why, and its share.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "scenes/scene.h"

namespace isochor {

class EffectInstance;
class System;

// The system that a scene compiles to, with everything inside at hand.
struct CompiledScene {
  std::shared_ptr<const System> system;
  std::vector<std::shared_ptr<EffectInstance>> instances;  // what the system's curves live in
};
Result<CompiledScene> compile_parts(const SceneParts& parts, bool statics);

struct EffectNote {
  std::string effect, why;
};

// All stencils of one kind, with the rows over them.
struct PoolShare {
  std::string name, rows_name;
  Index stencils = 0;
  Index multipliers = 0;    // rows that are unknowns
  Index prescribed = 0;     // rows whose multiplier is given
  std::int64_t blocks = 0;  // 3 x 3 blocks that it adds to, before those at one place are summed
  std::size_t bytes = 0;    // of its slots
  double seconds = 0;       // of one evaluation with Hessian, at rest on one thread
};

struct Explanation {
  std::vector<EffectNote> effects;
  std::vector<PoolShare> pools;
  Index nodes = 0, displacements = 0, multipliers = 0,
        held = 0;  // held: displacements that supports take away
  std::int64_t nonzeros = 0;
  std::size_t loads = 0;
};

Result<Explanation> explain(const SceneDef& scene);

}  // namespace isochor
