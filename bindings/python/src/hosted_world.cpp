#include "hosted_world.h"

namespace isochor::python {

void LogLines::pass_on() {
  std::vector<std::string> lines;
  {
    const std::lock_guard locked(lines_->lock);
    if (lines_->waiting.empty()) return;
    lines.swap(lines_->waiting);
  }
  try {
    const py::object logger = py::module_::import("logging").attr("getLogger")("isochor");
    for (const std::string& line : lines) logger.attr("warning")("%s", line);
  } catch (py::error_already_set& error) {
    error.discard_as_unraisable("log of an isochor.World");
  }
}

HostedWorld::HostedWorld(WorldOptions options, KeyMeaning meaning) : meaning_(std::move(meaning)) {
  options.log = common_.log.writer();
  own_.emplace(need(World::create(std::move(options))));
  world_ = &*own_;
  listen();
}

HostedWorld::HostedWorld(World& world, KeyMeaning meaning, Common common, std::shared_ptr<void> owner)
    : owner_(std::move(owner)), world_(&world), meaning_(std::move(meaning)), common_(std::move(common)) {}

HostedWorld::HostedWorld(World&& world, KeyMeaning meaning, const LogLines& log)
    : own_(std::move(world)), world_(&*own_), meaning_(std::move(meaning)) {
  common_.log = log;
  listen();
}

void HostedWorld::listen() {
  world_->stop_when([stop = common_.interruption] { return stop->asked(); });
}

std::shared_ptr<HostedWorld> HostedWorld::clone(int threads) {
  Result<World> made = work("clone", [threads](World& w) { return w.clone(threads); });
  // A clone writes to the log of the world that it is a clone of.
  return std::make_shared<HostedWorld>(need(std::move(made)), meaning_, common_.log);
}

void HostedWorld::set_progress(const py::object& callback) {
  const Turn turn(*common_.callers, "progress");
  progress_ = callback;
  if (callback.is_none()) {
    world_->on_progress({});
    return;
  }
  world_->on_progress([this](const ProgressInfo& info) {
    common_.interruption->call(
        [&] { progress_(info.time, info.target, info.iteration, info.force_residual, info.row_residual); });
  });
}

StepReport HostedWorld::step(const char* call, const std::function<StepReport(World&)>& f) {
  StepReport report;
  {
    const Turn turn(*common_.callers, call);
    const PassOn log{common_.log};
    common_.interruption->begin();
    const py::gil_scoped_release free;
    report = f(*world_);
  }
  common_.interruption->end();
  return report;
}

}  // namespace isochor::python
