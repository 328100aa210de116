// A world with what Python asks of it: one caller at a time, Ctrl-C, a callback for progress, log lines.
#pragma once

#include <functional>
#include <mutex>

#include "interruption.h"
#include "isochor/world.h"
#include "parts.h"

namespace isochor::python {

class HostedWorld {
 public:
  explicit HostedWorld(WorldOptions options);
  HostedWorld(const HostedWorld&) = delete;
  HostedWorld& operator=(const HostedWorld&) = delete;

  // Calls f(world) as the only caller and without the interpreter lock; passes on then what the world logged.
  template <class F>
  auto work(const char* call, const F& f) {
    const Turn turn(*this, call);
    const Log log(*this);
    const py::gil_scoped_release free;
    return f(*world_);
  }
  // The same with the lock, for what takes no time.
  template <class F>
  auto glance(const char* call, const F& f) {
    const Turn turn(*this, call);
    return f(*world_);
  }
  // Like work(), of a step: Ctrl-C cancels it, and what was raised in it is raised again.
  StepReport step(const char* call, const std::function<StepReport(World&)>& f);
  // From any thread, at any time.
  void cancel() { world_->cancel(); }

  // What effects that are added may name.
  PartNames& names() { return names_; }

  // None: no callback.
  void set_progress(const py::object& callback);

 private:
  // One call at a time. What comes from another thread, or from a callback of the call that runs, is refused.
  class Turn {
   public:
    Turn(HostedWorld& world, const char* call);
    ~Turn() { world_.busy_.store(false); }
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;

   private:
    HostedWorld& world_;
  };
  // Passes on log lines at the end of a call, with the lock.
  struct Log {
    explicit Log(HostedWorld& w) : world(w) {}
    ~Log() { world.pass_on_log(); }
    Log(const Log&) = delete;
    Log& operator=(const Log&) = delete;
    HostedWorld& world;
  };
  void pass_on_log();

  std::optional<World> world_;
  PartNames names_;
  std::atomic<bool> busy_{false};
  std::atomic<std::thread::id> user_{};
  std::atomic<const char*> running_{nullptr};
  Interruption interruption_;
  py::object progress_;
  std::mutex log_lock_;
  std::vector<std::string> log_;
};

}  // namespace isochor::python
