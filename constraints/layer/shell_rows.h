// The bending of a sheet of flat triangles: hinges on its edges, and rows that make them a plate.
#pragma once

#include <memory>
#include <set>
#include <string>
#include <vector>

#include "constraints/layer/hinge_pool.h"

namespace isochor {

// What bends: triangles of scene nodes, and how.
struct BentSheet {
  std::vector<Index> triangles;  // three nodes each
  double bending = 0;            // of a plate [N m]
  double poisson = 0;
  std::set<Index> clamped;  // nodes between which edges at the rim are clamped
  bool flat = false;        // free of bending when flat
};

// One row an edge that bends. Moments are those of Hellan, Herrmann and Johnson: constant in each triangle,
// the part that bends an edge is the same on both sides of it and is what the multipliers stand for.
class ShellRows final : public RowPool {
 public:
  explicit ShellRows(std::string name) : name_(std::move(name)) {}
  std::string_view name() const override { return name_; }

 private:
  std::string name_;
};

struct Bending {
  std::shared_ptr<const HingePool> hinges;
  std::shared_ptr<ShellRows> rows;  // without their stencil pool; no rows: nothing bends
  Index clamped_edges = 0;
  std::vector<std::array<Index, 3>> row_of;  // by triangle and edge, -1: none
};

// The moment of a triangle that bends one of its edges alone, by the moment of that edge: scale times the
// symmetric part of t t', at rest.
struct EdgeMoment {
  Vec3 t, u;
  double scale = 0;
};
std::array<EdgeMoment, 3> edge_moments(const Index* triangle, std::span<const Vec3> rest);

// Moments m of the edges [N], from the multipliers of their rows.
std::vector<double> moments_of(const Bending& bending, std::span<const Vec3> x,
                               std::span<const double> lambda);

// Refused: edges that more than two triangles share. The message is the end of a sentence about the sheet.
Result<Bending> make_bending(const std::string& name, const BentSheet& sheet, std::span<const Vec3> rest);

}  // namespace isochor
