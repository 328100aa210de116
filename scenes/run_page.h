// The results page of a run.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "results_page.h"
#include "scenes/outputs.h"
#include "scenes/run_overlays.h"

namespace isochor {

// What bodies of a scene are colored by; the contact pressure where anything may touch.
bool has_contact(const SceneDef& scene);
std::vector<PageField> page_fields(const SceneDef& scene);

class RunPage {
 public:
  // Null when this build has no results page.
  static std::unique_ptr<RunPage> start(const RunView& view);
  // The frame, for whoever keeps it.
  PageFrame append(const RunView& view, const std::vector<BodyFields>& fields);
  // One that was kept.
  void append(const PageFrame& frame);
  Result<void> write(const RunView& view, const std::string& path);
  // Why frames cannot be shown; empty: they can.
  const std::string& failure() const { return failure_; }

 private:
  // The node of each vertex; for the surface in a lattice its points instead.
  struct Vertices {
    std::vector<Index> nodes;
    std::vector<EmbeddedPoint> points;
  };
  RunPage(ResultsRecorder recorder, std::vector<Vertices> vertices, RunOverlays overlays,
          std::vector<Index> to_cut)
      : recorder_(std::move(recorder)),
        vertices_(std::move(vertices)),
        overlays_(std::move(overlays)),
        to_cut_(std::move(to_cut)) {}

  ResultsRecorder recorder_;
  std::vector<Vertices> vertices_;  // by body
  RunOverlays overlays_;
  std::vector<Index> to_cut_;           // triangles that cuts are to show the inside of
  std::optional<PageSection> section_;  // of the last frame
  std::string failure_;
};

}  // namespace isochor
