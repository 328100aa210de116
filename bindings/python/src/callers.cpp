#include "callers.h"

namespace isochor::python {

Turn::Turn(Callers& callers, const char* call) : callers_(callers) {
  bool idle = false;
  if (callers.busy_.compare_exchange_strong(idle, true)) {
    callers.user_ = std::this_thread::get_id();
    callers.running_ = call;
    return;
  }
  const char* running = callers.running_;
  const std::string other = std::string(running ? running : "another call") + "()";
  if (callers.user_.load() == std::this_thread::get_id()) {
    throw Refused(std::string(call) + ": called in a callback of " + other +
                  " of the same world, which has not returned; of all calls only cancel() may be made there");
  }
  throw Refused(
      std::string(call) + ": another thread is in " + other +
      " of this world; one thread at a time uses a world: wait for it, or give each thread its own");
}

}  // namespace isochor::python
