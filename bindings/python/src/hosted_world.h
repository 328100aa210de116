// A world with what Python asks of it: one caller at a time, Ctrl-C, a callback for progress, log lines.
#pragma once

#include <functional>
#include <mutex>
#include <optional>

#include "callers.h"
#include "interruption.h"
#include "isochor/world.h"
#include "parts.h"

namespace isochor::python {

// Lines of a log from any thread, handed to Python's logger "isochor" by the caller of a call when it ends.
class LogLines {
 public:
  std::function<void(const std::string&)> writer() {
    return [lines = lines_](const std::string& line) {
      const std::lock_guard locked(lines->lock);
      lines->waiting.push_back(line);
    };
  }
  // With the interpreter lock. Raises nothing: what a handler raises is told as unraisable.
  void pass_on();

 private:
  struct Lines {
    std::mutex lock;
    std::vector<std::string> waiting;
  };
  std::shared_ptr<Lines> lines_ = std::make_shared<Lines>();
};

// What worlds of a batch have in common.
struct Common {
  std::shared_ptr<Callers> callers = std::make_shared<Callers>();
  std::shared_ptr<Interruption> interruption = std::make_shared<Interruption>();
  LogLines log;
};

class HostedWorld {
 public:
  HostedWorld(WorldOptions options, KeyMeaning meaning);
  // One that is there already, and writes to `log`.
  HostedWorld(World&& world, KeyMeaning meaning, const LogLines& log);
  // One of a batch, which `owner` keeps alive and whose calls are those of `common`.
  HostedWorld(World& world, KeyMeaning meaning, Common common, std::shared_ptr<void> owner);
  HostedWorld(const HostedWorld&) = delete;
  HostedWorld& operator=(const HostedWorld&) = delete;

  std::shared_ptr<HostedWorld> clone(int threads);

  // Calls f(world) as the only caller and without the interpreter lock; passes on then what the world logged.
  template <class F>
  auto work(const char* call, const F& f) {
    const Turn turn(*common_.callers, call);
    const PassOn log{common_.log};
    const py::gil_scoped_release free;
    return f(*world_);
  }
  // The same with the lock, for what takes no time.
  template <class F>
  auto glance(const char* call, const F& f) {
    const Turn turn(*common_.callers, call);
    return f(*world_);
  }
  // Like work(), of a step: Ctrl-C cancels it, and what was raised in it is raised again.
  StepReport step(const char* call, const std::function<StepReport(World&)>& f);
  // From any thread, at any time.
  void cancel() { world_->cancel(); }

  // What keys of effects that are added mean.
  KeyMeaning& meaning() { return meaning_; }
  const LogLines& log() const { return common_.log; }

  // None: no callback.
  void set_progress(const py::object& callback);

 private:
  struct PassOn {
    LogLines& lines;
    ~PassOn() { lines.pass_on(); }
  };
  void listen();

  std::optional<World> own_;
  std::shared_ptr<void> owner_;  // where the world is not its own
  World* world_;
  KeyMeaning meaning_;
  Common common_;
  py::object progress_;
};

}  // namespace isochor::python
