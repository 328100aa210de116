// The results page of a run.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "results_page.h"
#include "scenes/run/outputs.h"
#include "scenes/run/page_shape.h"

namespace isochor {

class RunPage {
 public:
  // Null when this build has no results page.
  static std::unique_ptr<RunPage> start(const RunView& view);
  // The frame, for whoever keeps it.
  PageFrame append(const RunView& view, const std::vector<BodyFields>& fields);
  // One that was kept, by a run that may have been asked for other fields.
  void append(PageFrame frame);
  Result<void> write(const RunView& view, const std::string& path);
  // Why frames cannot be shown; empty: they can.
  const std::string& failure() const { return failure_; }

 private:
  RunPage(ResultsRecorder recorder, PageShape shape)
      : recorder_(std::move(recorder)), shape_(std::move(shape)) {}

  ResultsRecorder recorder_;
  PageShape shape_;
  std::optional<PageSection> section_;  // of the last frame
  std::string failure_;
};

}  // namespace isochor
