// A scene as pages show it: the surface of its bodies with obstacles and cables, and the frame that a world
// is at.
#pragma once

#include <vector>

#include "results_page.h"
#include "scenes/run/outputs.h"
#include "scenes/run/run_overlays.h"

namespace isochor {

// What bodies of a scene are colored by; the contact pressure where anything may touch.
bool has_contact(const SceneDef& scene);
std::vector<PageField> page_fields(const SceneDef& scene, bool origins = false);
// Gravity tells which way is up; without it the y axis of these scenes is.
char up_axis(const SceneDef& scene);

class PageShape {
 public:
  explicit PageShape(const RunView& view);
  // Bodies come first, in the order of the scene, then what they touch.
  const PageScene& scene() const { return scene_; }
  // The frame of the last record. Without fields it has positions alone, and maps that do not change.
  PageFrame frame(const RunView& view, const std::vector<BodyFields>& fields) const;
  // Triangles that cuts are to show the inside of; all where no chamber is.
  const std::vector<Index>& to_cut() const { return to_cut_; }
  bool has_fibers() const { return overlays_.has_fibers(); }

 private:
  // The node of each vertex; for the surface in a lattice its points instead.
  struct Vertices {
    std::vector<Index> nodes;
    std::vector<EmbeddedPoint> points;
  };
  void add_positions(const RunView& view, PageFrame& frame) const;
  void add_fields(const RunView& view, const std::vector<BodyFields>& fields, PageFrame& frame) const;
  void add_origins(const RunView& view, PageFrame& frame) const;

  PageScene scene_;
  std::vector<Vertices> vertices_;  // by body
  RunOverlays overlays_;
  std::vector<Index> to_cut_;
};

}  // namespace isochor
