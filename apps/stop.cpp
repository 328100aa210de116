#include "apps/stop.h"

#include <unistd.h>

#include <atomic>
#include <csignal>

#include "apps/commands.h"

namespace isochor::app {

namespace {

std::atomic<int> g_signals{0};
static_assert(std::atomic<int>::is_always_lock_free, "a signal handler may touch it");

void on_signal(int) {
  if (g_signals.fetch_add(1) > 0) _exit(interrupted);
}

}  // namespace

void stop_on_signals() {
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
}

bool stop_wanted() {
  return g_signals.load() > 0;
}

}  // namespace isochor::app
