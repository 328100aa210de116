// Which ends of an increment may become the state of a world: cells that have turned over where their law,
// their guard or their rows have no value, and how the others stand.
#pragma once

#include <string>
#include <vector>

#include "engine/scene/builder.h"

namespace isochor {

class Admission {
 public:
  Admission(const std::vector<BodyData>& bodies, const SystemParts& parts);

  // J of the cells (of a Tet10 or Hex8: its smallest over their points) at the end of an increment.
  struct Verdict {
    double min_J = 1;
    Index body = -1, cell = -1;  // that of min_J
    Index inverted = 0;          // cells with J <= 0
    Index crushed = 0;           // cells with 0 < J < crushed_below
    Index forbidden = 0;         // inverted cells that must not be, and the first of them
    Index forbidden_body = -1, forbidden_cell = -1;
    double forbidden_J = 0;
  };
  static constexpr double crushed_below = 0.01;

  // `before` are the positions from which the increment began: what a host set inverted may still be so.
  Verdict judge(std::span<const Vec3> before, std::span<const Vec3> x) const;

  // One sentence about cells that may not be as they are; empty where there are none.
  std::string refusal(const Verdict& verdict) const;
  // One sentence about inverted and crushed cells that may; empty where there are none.
  std::string warning(const Verdict& verdict) const;

 private:
  // The cells of a region, tets by their four nodes and one over the determinant of their edges at rest; the
  // others by the pool that holds their points.
  struct Region {
    Index body = 0;
    std::vector<Index> cells;
    std::vector<Index> tets;  // 4 a cell; empty: `points` holds them
    std::vector<double> inverse_rest;
    std::shared_ptr<const StencilPool> points;
    // Whether a cell that starts right side out must stay so: one entry a cell.
    std::vector<std::uint8_t> stays;
  };
  double determinant(const Region& region, std::size_t k, std::span<const Vec3> x) const;
  std::string cell_name(Index body, Index cell) const;

  std::vector<Region> regions_;
  std::vector<std::string> names_;  // of bodies
  std::vector<Vec3> rest_;
};

}  // namespace isochor
