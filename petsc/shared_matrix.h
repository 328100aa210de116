// A symmetric matrix whose entries lie on several ranks, and its vectors, as PETSc has them.
#pragma once

#include <petscmat.h>

#include <array>
#include <string>
#include <vector>

#include "engine/base/base.h"
#include "engine/solvers/linear_solver.h"
#include "isochor/ranks.h"

namespace isochor {

class SharedMatrix {
 public:
  explicit SharedMatrix(const Ranks& ranks) : ranks_(ranks) {}
  ~SharedMatrix() { clear(); }
  SharedMatrix(const SharedMatrix&) = delete;
  SharedMatrix& operator=(const SharedMatrix&) = delete;

  // PETSc numbers unknowns by rank: on each the displacements of its nodes, then its multipliers. `padded`:
  // three displacements a node, those that a node has not with a one on the diagonal. `symmetric`: in its
  // values too.
  void analyze(const SymmetricPattern& pattern, std::span<const UnknownGeometry> geometry, bool padded,
               bool symmetric = true);
  // The same call on all ranks; false where one of them has a value that is not finite. The lower
  // triangle, and behind it the transposed upper one where the matrix is unsymmetric.
  bool set_values(std::span<const double> values);

  Mat matrix() const { return matrix_; }
  double norm() const { return norm_; }  // largest sum of magnitudes of a row
  Vec right() const { return right_; }
  Vec solution() const { return solution_; }
  Vec work() const { return work_; }

  // Between vectors that every rank has whole, in the order of the pattern, and PETSc's. The second one is a
  // gather.
  void to_petsc(std::span<const double> from, Vec to) const;
  void from_petsc(Vec from, std::span<double> to);

  Index unknowns() const { return static_cast<Index>(place_.size()); }
  PetscInt displacements_here() const { return displacements_[at(rank())]; }
  PetscInt rows_here() const;
  PetscInt first_here() const { return static_cast<PetscInt>(begin_[at(rank())]); }
  PetscInt displacements() const { return all_displacements_; }
  PetscInt rows() const { return size() - all_displacements_; }
  PetscInt size() const { return static_cast<PetscInt>(begin_.back()); }
  // Where unknowns are; those of this rank, ascending.
  PetscInt place(Index unknown) const { return place_[at(unknown)]; }
  std::span<const Index> own() const { return own_; }
  // Multipliers whose rows have more displacements than that, as PETSc numbers them: at most `most`.
  std::vector<PetscInt> wide_rows(Index displacements, std::size_t most) const;

 private:
  Index rank() const { return static_cast<Index>(ranks_.rank()); }
  void clear();
  void number(const SymmetricPattern& pattern, std::span<const UnknownGeometry> geometry, bool padded);
  void preallocate(const SymmetricPattern& pattern, bool symmetric);

  const Ranks& ranks_;
  const SymmetricPattern* pattern_ = nullptr;
  std::vector<PetscInt> place_, displacements_;  // displacements: by rank
  std::vector<PetscInt> padding_;                // of this rank
  std::vector<Index> own_;
  std::vector<std::int64_t> begin_;  // by rank, and the end
  PetscInt all_displacements_ = 0;
  std::vector<double> value_, gathered_, row_length_;
  Mat matrix_ = nullptr;
  Vec right_ = nullptr, solution_ = nullptr, work_ = nullptr;
  double norm_ = 0;
};

}  // namespace isochor
