// The files of a run. Each is whole at any moment: a run that is stopped leaves what it had.
#pragma once

#include <memory>
#include <string>

#include "isochor/mesh_io.h"
#include "isochor/ranks.h"
#include "scenes/run/run_checkpoint.h"

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
  // Of a process that runs the scene with others and is not their root: it writes its pieces of frames alone.
  static RunOutputs silent(const std::string& folder, const SceneDef& scene);
  RunOutputs(RunOutputs&&) noexcept;
  RunOutputs& operator=(RunOutputs&&) noexcept;
  ~RunOutputs();

  // The checkpoint of an earlier run in the folder; none where it left no checkpoint.
  static Result<std::optional<RunCheckpoint>> checkpoint_in(const std::string& folder);
  // What an earlier run left in the folder up to its checkpoint, whose records the view has; what it wrote
  // behind that is removed.
  static Result<RunOutputs> reopen(const std::string& folder, const RunView& view,
                                   const RunCheckpoint& checkpoint);

  // Frames are in pieces from here on, one a rank; the same call on all of several ranks.
  void share(std::shared_ptr<const Ranks> ranks) { ranks_ = std::move(ranks); }

  // After a step (or the rest state): frame, table and summary so far. `last` forces a frame.
  Result<void> record(const RunView& view, bool last);
  Result<void> keep(const RunCheckpoint& checkpoint);
  std::uint64_t page_bytes() const { return journal_.bytes(); }
  // Checkpoints are done with where the run has converged.
  Result<void> finish(const RunView& view);
  // Where outputs could not be written the summary must not go on saying that the run has not ended.
  void tell_failure(const RunView& view);

 private:
  RunOutputs(std::string folder, const SceneDef& scene);
  bool keeps() const { return keeps_; }
  Result<void> write_summary(const RunView& view);
  Result<void> write_frame(const RunView& view, std::size_t body, const BodyFields& fields);
  Result<void> append_row(const RunView& view);

  std::string folder_, name_;
  std::vector<std::vector<PvdEntry>> frames_;  // by body
  std::string table_;
  std::size_t rows_ = 0;  // records in the table
  int last_frame_ = -1;
  bool keeps_ = false;  // checkpoints
  bool silent_ = false;
  std::shared_ptr<const Ranks> ranks_;  // null: frames are whole
  std::unique_ptr<RunPage> page_;
  PageJournal journal_;
};

// Writes beside the target and renames.
Result<void> write_text(const std::string& path, const std::string& text);

}  // namespace isochor
