#include "interruption.h"

#include <algorithm>

namespace isochor::python {

namespace {

using Clock = std::chrono::steady_clock;

// How often the interpreter lock is taken to look for Ctrl-C. Where other threads hold the lock for long,
// looking takes at most a tenth of the time.
constexpr std::chrono::milliseconds kBetweenLooks{20};

// Python gives signals to its main thread only.
bool in_main_thread() {
  const py::module_ threading = py::module_::import("threading");
  return threading.attr("current_thread")().is(threading.attr("main_thread")());
}

}  // namespace

void Interruption::begin() {
  stopped_ = false;
  error_.reset();
  worker_ = std::this_thread::get_id();
  next_look_ = Clock::now() + kBetweenLooks;
  looks_ = in_main_thread();
}

bool Interruption::asked() {
  if (stopped_) return true;
  if (!looks_ || worker_.load() != std::this_thread::get_id()) return false;
  const auto now = Clock::now();
  if (now < next_look_) return false;
  const py::gil_scoped_acquire locked;
  if (PyErr_CheckSignals() != 0) keep(py::error_already_set());
  const auto then = Clock::now();
  next_look_ = then + std::max<Clock::duration>(kBetweenLooks, 10 * (then - now));
  return stopped_;
}

void Interruption::end() {
  looks_ = false;
  stopped_ = false;
  if (!error_) return;
  const py::error_already_set error = *error_;
  error_.reset();
  throw error;
}

}  // namespace isochor::python
