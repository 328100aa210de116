// One caller at a time: what comes from another thread, or from a callback of the call that runs, is refused.
#pragma once

#include <atomic>
#include <thread>

#include "interop.h"

namespace isochor::python {

class Callers {
 private:
  friend class Turn;
  std::atomic<bool> busy_{false};
  std::atomic<std::thread::id> user_{};
  std::atomic<const char*> running_{nullptr};
};

// The turn of a call, as long as it lives.
class Turn {
 public:
  Turn(Callers& callers, const char* call);
  ~Turn() { callers_.busy_ = false; }
  Turn(const Turn&) = delete;
  Turn& operator=(const Turn&) = delete;

 private:
  Callers& callers_;
};

}  // namespace isochor::python
