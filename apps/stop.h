// Ctrl-C and SIGTERM: the first one ends a command in good order, the second at once.
#pragma once

namespace isochor::app {

// From here on signals are counted.
void stop_on_signals();
bool stop_wanted();

}  // namespace isochor::app
