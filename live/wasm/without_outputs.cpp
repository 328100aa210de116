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

}  // namespace isochor
