// What the results page of a run shows beside the bodies: obstacles and rigid bodies, cables, contact points
// with their forces, fibers, and maps of regions and zones.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "results_page.h"
#include "scenes/probes.h"
#include "scenes/run/outputs.h"

namespace isochor {

class RunOverlays {
 public:
  // After the bodies have been added: obstacles and lines follow them in `scene`. `triangle_cell`: by body,
  // the cell of each of its triangles; empty where the page shows a surface of its own in place of the mesh.
  void start(const RunView& view, PageScene& scene, const std::vector<std::vector<Index>>& triangle_cell);
  // After positions and fields of the bodies have been put in.
  void append(const RunView& view, PageFrame& frame) const;
  bool has_fibers() const { return !fibers_.empty(); }

 private:
  struct Shown {
    Obstacle shape;
    std::string rigid;                   // name of a free body; empty: it moves as its obstacle says
    std::vector<Vec3> points;            // in its own axes
    std::optional<std::size_t> contact;  // of which it is the obstacle
  };
  // A short line along a fiber, in the axes of its cell.
  struct Fiber {
    std::size_t body = 0;
    std::array<Index, 8> corners{};
    std::size_t count = 0;  // of them
    Vec3 middle{}, along{};
  };
  struct Path {
    std::size_t body = 0;
    std::vector<MaterialPoint> points;
    std::optional<Vec3> from, to;
  };

  void add_solid(const Obstacle& shape, const std::string& name, const std::string& rigid, PageScene& scene);
  void add_path(const RunView& view, BodyId body, const std::vector<Vec3>& points, PageScene& scene,
                const std::string& name, std::optional<Vec3> from, std::optional<Vec3> to);
  void add_fibers(const RunView& view, const PageScene& scene,
                  const std::vector<std::vector<Index>>& triangle_cell);
  void add_maps(const RunView& view, PageScene& scene, const std::vector<std::vector<Index>>& triangle_cell);

  void append_arrows(const RunView& view, PageFrame& frame) const;

  Vec3 middle_{};                     // of all bodies at rest
  double extent_ = 0;                 // diagonal of their box
  std::vector<Shown> solids_;         // of rigid bodies, then of contacts
  std::vector<std::size_t> touched_;  // by contact, the solid that it touches
  std::vector<Path> paths_;
  std::vector<Fiber> fibers_;
  std::vector<std::vector<double>> maps_;  // values of the per-triangle fields, which do not change
};

}  // namespace isochor
