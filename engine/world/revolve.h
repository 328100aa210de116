// Which states of a way are kept while it is gone through backward: binomial checkpointing (Griewank &
// Walther 2000), which makes as few steps again as so many states allow.
#pragma once

#include "engine/base/base.h"

namespace isochor {

// The way begins with a state that is kept, `steps` of whose successors are wanted from the last to the
// first, itself the last of all; `free` more states may be kept. How many steps ahead the first of them is
// to be, 1 to steps - 1.
Index steps_to_keep(Index steps, Index free);

}  // namespace isochor
