#include "hosted_world.h"

namespace isochor::python {

HostedWorld::HostedWorld(WorldOptions options) {
  options.log = [this](const std::string& line) {
    const std::lock_guard lock(log_lock_);
    log_.push_back(line);
  };
  world_.emplace(need(World::create(std::move(options))));
  world_->stop_when([this] { return interruption_.asked(); });
}

HostedWorld::Turn::Turn(HostedWorld& world, const char* call) : world_(world) {
  bool idle = false;
  if (world.busy_.compare_exchange_strong(idle, true)) {
    world.user_ = std::this_thread::get_id();
    world.running_ = call;
    return;
  }
  const char* running = world.running_.load();
  const std::string other = std::string(running ? running : "another call") + "()";
  if (world.user_.load() == std::this_thread::get_id()) {
    throw Refused(std::string(call) + ": called in a callback of " + other +
                  " of the same world, which has not returned; of all calls only cancel() may be made there");
  }
  throw Refused(std::string(call) + ": another thread is in " + other +
                " of this world; one thread at a time uses a world: wait for it, or give each thread its own");
}

// A destructor calls this: a handler of Python's logging that raises is told of and goes no further.
void HostedWorld::pass_on_log() {
  std::vector<std::string> lines;
  {
    const std::lock_guard lock(log_lock_);
    if (log_.empty()) return;
    lines.swap(log_);
  }
  try {
    const py::object logger = py::module_::import("logging").attr("getLogger")("isochor");
    for (const std::string& line : lines) logger.attr("warning")("%s", line);
  } catch (py::error_already_set& error) {
    error.discard_as_unraisable("log of an isochor.World");
  }
}

void HostedWorld::set_progress(const py::object& callback) {
  const Turn turn(*this, "on_progress");
  progress_ = callback;
  if (callback.is_none()) {
    world_->on_progress({});
    return;
  }
  world_->on_progress([this](const ProgressInfo& info) {
    interruption_.call([&] {
      progress_(info.time, info.target, info.iteration, info.force_residual, info.row_residual);
    });
  });
}

StepReport HostedWorld::step(const char* call, const std::function<StepReport(World&)>& f) {
  StepReport report;
  {
    const Turn turn(*this, call);
    const Log log(*this);
    interruption_.begin();
    const py::gil_scoped_release free;
    report = f(*world_);
  }
  interruption_.end();
  return report;
}

}  // namespace isochor::python
