// What a run needs to go on where it was: the state of its world, its records, and the frames of its page.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scenes/run/run.h"

namespace isochor {

struct PageFrame;

struct RunCheckpoint {
  std::string scene;    // to_json() of it
  std::string program;  // version and build
  int step = 0;         // the last one that is complete
  bool ended = false;   // converged: all that follows is empty
  std::string state;    // World::save()
  std::vector<StepRecord> records;
  std::vector<std::string> warnings;
  SolveCounters work;
  double wall_s = 0;
  StageSeconds stages;
  std::uint64_t page_bytes = 0;  // of the frames kept for the page
};

// The file appears whole or not at all.
Result<void> write_checkpoint(const std::string& path, const RunCheckpoint& checkpoint);
Result<RunCheckpoint> read_checkpoint(const std::string& path);

// Frames of a page, one behind another in a file that grows.
class PageJournal {
 public:
  explicit PageJournal(std::string path) : path_(std::move(path)) {}
  Result<void> append(const PageFrame& frame);
  // The frames in the first `bytes` bytes; the file is cut off there.
  Result<std::vector<PageFrame>> restart(std::uint64_t bytes);
  std::uint64_t bytes() const { return bytes_; }

 private:
  std::string path_;
  std::uint64_t bytes_ = 0;
};

}  // namespace isochor
