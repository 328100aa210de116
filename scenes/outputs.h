// The files of a run. Each is whole at any moment: a run that is stopped leaves what it had.
#pragma once

#include <memory>
#include <string>

#include "isochor/mesh_io.h"
#include "scenes/run.h"

namespace isochor {

class RunPage;

// What the outputs look at.
struct RunView {
  const SceneDef& scene;
  const BuiltScene& built;
  RunResult& result;
};

class RunOutputs {
 public:
  // Makes the folder and removes what an earlier run of the scene left in it.
  static Result<RunOutputs> open(const std::string& folder, const SceneDef& scene);
  RunOutputs(RunOutputs&&) noexcept;
  RunOutputs& operator=(RunOutputs&&) noexcept;
  ~RunOutputs();

  // After a step (or the rest state): frame, table and summary so far. `last` forces a frame.
  Result<void> record(const RunView& view, bool last);
  Result<void> finish(const RunView& view);

 private:
  RunOutputs(std::string folder, const SceneDef& scene);
  Result<void> write_frame(const RunView& view, std::size_t body, const BodyFields& fields);
  Result<void> append_row(const RunView& view);

  std::string folder_, name_;
  std::vector<std::vector<PvdEntry>> frames_;  // by body
  std::string table_;
  int last_frame_ = -1;
  std::unique_ptr<RunPage> page_;
};

// Writes beside the target and renames.
Result<void> write_text(const std::string& path, const std::string& text);

}  // namespace isochor
