// In the place of scenes/run/outputs.cpp: a page has no folder to record into, and does without the writers
// of tables, frames and pages.
#include "scenes/run/outputs.h"

namespace isochor {

class RunPage {};

namespace {

Error refusal() {
  return Error{"pages without a server keep no outputs; use `isochor live`, or `isochor run`"};
}

}  // namespace

RunOutputs::RunOutputs(RunOutputs&&) noexcept = default;
RunOutputs& RunOutputs::operator=(RunOutputs&&) noexcept = default;
RunOutputs::~RunOutputs() = default;

Result<RunOutputs> RunOutputs::open(const std::string&, const SceneDef&) {
  return refusal();
}
Result<void> RunOutputs::record(const RunView&, bool) {
  return refusal();
}
Result<void> RunOutputs::finish(const RunView&) {
  return refusal();
}

// What the rest of a run would ask for: all of it has to be here, or the linker takes what was left out.
RunOutputs::RunOutputs(std::string folder, const SceneDef& scene)
    : folder_(std::move(folder)), name_(scene.name), journal_("") {}
RunOutputs RunOutputs::silent(const SceneDef& scene) {
  return RunOutputs({}, scene);
}
Result<std::optional<RunCheckpoint>> RunOutputs::checkpoint_in(const std::string&) {
  return refusal();
}
Result<RunOutputs> RunOutputs::reopen(const std::string&, const RunView&, const RunCheckpoint&) {
  return refusal();
}
Result<void> RunOutputs::keep(const RunCheckpoint&) {
  return refusal();
}
void RunOutputs::tell_failure(const RunView&) {}
Result<void> write_text(const std::string&, const std::string&) {
  return refusal();
}

}  // namespace isochor
