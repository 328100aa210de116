// What stops long work for Python: Ctrl-C, or an exception in a callback.
#pragma once

#include <atomic>
#include <chrono>
#include <optional>
#include <thread>

#include "interop.h"

namespace isochor::python {

class Interruption {
 public:
  // By the thread that is about to work, with the interpreter lock.
  void begin();
  // Whether to stop; asked often, by any thread, without the lock. Looks for Ctrl-C at times.
  bool asked();
  // Calls back with the lock; what is raised there stops the work.
  template <class F>
  void call(const F& callback) {
    if (stopped_) return;
    const py::gil_scoped_acquire locked;
    try {
      callback();
    } catch (py::error_already_set& error) {
      keep(error);
    }
  }
  // By the thread of begin() when the work is over: raises again what was raised meanwhile.
  void end();

 private:
  void keep(const py::error_already_set& error) {
    error_.emplace(error);
    stopped_ = true;
  }

  std::atomic<bool> stopped_{false};
  std::atomic<std::thread::id> worker_{};
  std::atomic<bool> looks_{false};  // the worker is the thread that Python gives signals to
  std::chrono::steady_clock::time_point next_look_;
  std::optional<py::error_already_set> error_;
};

}  // namespace isochor::python
