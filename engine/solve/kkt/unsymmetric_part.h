// What makes a saddle-point matrix unsymmetric: derivatives of forces in what pools hold on to within an
// iteration (StencilLag). They fall on places that the symmetric matrix has as well, so the pattern stays.
#pragma once

#include "engine/system/assembly.h"

namespace isochor {

class UnsymmetricPart {
 public:
  // Of the pools with a lag; those that do not give its derivatives add zeros. All memory is taken here.
  UnsymmetricPart(std::shared_ptr<const System> system, const Parallel& parallel);

  // Asks the pools, at the positions of the assembly's last evaluation (Want::gradient or more), where its
  // lag was renewed.
  void evaluate(const Assembly& assembly, std::span<const Vec3> x);
  bool vanishes() const;  // nothing makes the matrix unsymmetric
  bool empty() const { return pools_.empty(); }
  std::span<const Index> rows() const { return rows_; }  // whose multipliers matter

  // Adds L and l of [K + L, G^T + l; G, -C] in free directions to the lower triangle and to the transposed
  // upper one, both in kkt() order. Unknowns are scaled, rows held at a bound left out (none: empty).
  void add_to(std::span<const double> scale, std::span<const std::uint8_t> held, std::span<double> lower,
              std::span<double> upper) const;
  // y += L dx + l dlambda over all nodes, given ones included.
  void add_times(std::span<const Vec3> dx, std::span<const double> dlambda, std::span<Vec3> y) const;

  std::size_t memory_bytes() const { return block_.size() * sizeof(Mat3) + column_.size() * sizeof(Vec3); }

 private:
  struct PoolSlots {
    Index pool = 0;
    std::size_t first_block = 0, first_column = 0;
    std::vector<std::int64_t> block_offset;
  };
  // Contributions to a block of Gathers::block_ends, and to its mirror image; `block` is beyond their end
  // where another rank has it.
  struct BlockSource {
    std::size_t block = 0, lower = 0, upper = 0;
    Index row = 0, col = 0;  // its nodes
  };
  // Contributions to an entry of Gathers::jacobian_ends.
  struct ColumnSource {
    std::size_t end = 0, slot = 0;
    double weight = 1;
  };
  void place_blocks();
  void place_columns();
  Vec3 column_of(std::size_t first, std::size_t last) const;

  std::shared_ptr<const System> system_;
  const Parallel& parallel_;
  std::vector<PoolSlots> pools_;
  std::vector<Mat3> block_;
  std::vector<Vec3> column_;
  // Sorted by destination; runs of one destination are added up in this order.
  std::vector<BlockSource> block_source_;
  std::vector<ColumnSource> column_source_;
  std::vector<Index> rows_;
  std::vector<std::size_t> block_run_, column_run_;  // where runs begin, and the end
};

}  // namespace isochor
