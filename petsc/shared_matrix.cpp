#include "petsc/shared_matrix.h"

#include <algorithm>
#include <cmath>

#include "petsc/calls.h"

namespace isochor {

void SharedMatrix::clear() {
  if (matrix_) MatDestroy(&matrix_);
  for (Vec* v : {&right_, &solution_, &work_}) {
    if (*v) VecDestroy(v);
  }
}

PetscInt SharedMatrix::rows_here() const {
  return static_cast<PetscInt>(begin_[at(rank()) + 1] - begin_[at(rank())]) - displacements_here();
}

void SharedMatrix::analyze(const SymmetricPattern& pattern, std::span<const UnknownGeometry> geometry,
                           bool padded, bool symmetric) {
  clear();
  pattern_ = &pattern;
  number(pattern, geometry, padded);
  preallocate(pattern, symmetric);
}

void SharedMatrix::number(const SymmetricPattern& pattern, std::span<const UnknownGeometry> geometry,
                          bool padded) {
  const auto ranks = static_cast<std::size_t>(ranks_.size());
  const auto owner = [&](std::size_t u) { return pattern.owner.empty() ? Index{0} : pattern.owner[u]; };
  std::vector<std::int64_t> displacements(ranks, 0), rows(ranks, 0);
  std::vector<std::int64_t> place(at(pattern.size));
  padding_.clear();
  own_.clear();
  const std::size_t first_row = geometry.size();
  for (std::size_t u = 0; u < place.size(); ++u) {
    const std::size_t r = at(owner(u));
    if (owner(u) == rank()) own_.push_back(static_cast<Index>(u));
    if (u >= first_row) {
      place[u] = rows[r]++;
      continue;
    }
    place[u] = displacements[r]++;
    const bool last = u + 1 == first_row || geometry[u + 1].node != geometry[u].node;
    while (padded && last && displacements[r] % 3 != 0) {
      if (owner(u) == rank()) padding_.push_back(static_cast<PetscInt>(displacements[r]));
      ++displacements[r];
    }
  }
  begin_.assign(1, 0);
  for (std::size_t r = 0; r < ranks; ++r) begin_.push_back(begin_.back() + displacements[r] + rows[r]);
  petsc_count(begin_.back(), "unknowns");
  place_.resize(place.size());
  for (std::size_t u = 0; u < place.size(); ++u) {
    const std::size_t r = at(owner(u));
    place_[u] = static_cast<PetscInt>(begin_[r] + (u < first_row ? 0 : displacements[r]) + place[u]);
  }
  for (PetscInt& p : padding_) p += first_here();
  displacements_.assign(displacements.begin(), displacements.end());
  all_displacements_ = 0;
  for (const PetscInt d : displacements_) all_displacements_ += d;
  gathered_.resize(static_cast<std::size_t>(begin_.back()));
}

void SharedMatrix::preallocate(const SymmetricPattern& pattern, bool symmetric) {
  const auto here = static_cast<PetscInt>(begin_[at(rank()) + 1] - begin_[at(rank())]);
  const MPI_Comm comm = PETSC_COMM_WORLD;
  check(MatCreate(comm, &matrix_), "making a matrix");
  check(MatSetSizes(matrix_, here, here, size(), size()), "making a matrix");
  check(MatSetType(matrix_, MATAIJ), "making a matrix");
  if (symmetric) {
    check(MatSetOption(matrix_, MAT_SYMMETRIC, PETSC_TRUE), "making a matrix");
    check(MatSetOption(matrix_, MAT_SYMMETRY_ETERNAL, PETSC_TRUE), "making a matrix");
  }
  // Both triangles of what this rank has; PETSc sends what belongs to the lines of others.
  std::vector<PetscInt> row, column;
  const auto entries = 2 * static_cast<std::size_t>(pattern.nonzeros()) + padding_.size();
  row.reserve(entries);
  column.reserve(entries);
  row_length_.assign(static_cast<std::size_t>(rows()), 0);
  const auto row_number = [&](Index u) { return static_cast<std::size_t>(u - (pattern.size - rows())); };
  for (Index c = 0; c < pattern.size; ++c) {
    for (auto k = pattern.column_start[at(c)]; k < pattern.column_start[at(c) + 1]; ++k) {
      const Index r = pattern.row[static_cast<std::size_t>(k)];
      row.push_back(place_[at(r)]);
      column.push_back(place_[at(c)]);
      if (r == c) continue;
      row.push_back(place_[at(c)]);
      column.push_back(place_[at(r)]);
      if (r >= pattern.size - rows() && c < pattern.size - rows()) ++row_length_[row_number(r)];
    }
  }
  for (const PetscInt p : padding_) {
    row.push_back(p);
    column.push_back(p);
  }
  ranks_.sum(row_length_);
  value_.assign(row.size(), 0);
  check(MatSetPreallocationCOO(matrix_, static_cast<PetscCount>(row.size()), row.data(), column.data()),
        "laying out a matrix");
  check(MatCreateVecs(matrix_, &solution_, &right_), "making vectors");
  check(VecDuplicate(right_, &work_), "making vectors");
}

bool SharedMatrix::set_values(std::span<const double> values) {
  std::size_t to = 0;
  double strange = 0;
  const auto entries = static_cast<std::size_t>(pattern_->nonzeros());
  const auto mirrored = values.size() > entries ? values.subspan(entries) : values;
  for (Index c = 0; c < pattern_->size; ++c) {
    for (auto k = pattern_->column_start[at(c)]; k < pattern_->column_start[at(c) + 1]; ++k) {
      const double v = values[static_cast<std::size_t>(k)], w = mirrored[static_cast<std::size_t>(k)];
      if (!std::isfinite(v) || !std::isfinite(w)) strange = 1;
      value_[to++] = v;
      if (pattern_->row[static_cast<std::size_t>(k)] != c) value_[to++] = w;
    }
  }
  std::fill(value_.begin() + static_cast<std::ptrdiff_t>(to), value_.end(), 1.0);
  ranks_.sum({&strange, 1});
  if (strange > 0) return false;
  check(MatSetValuesCOO(matrix_, value_.data(), INSERT_VALUES), "filling a matrix");
  PetscReal norm = 0;
  check(MatNorm(matrix_, NORM_INFINITY, &norm), "a norm");
  norm_ = norm;
  return std::isfinite(norm);
}

void SharedMatrix::to_petsc(std::span<const double> from, Vec to) const {
  double* part = nullptr;
  check(VecSet(to, 0), "a vector");
  check(VecGetArray(to, &part), "a vector");
  for (const Index u : own_) part[place_[at(u)] - first_here()] = from[at(u)];
  check(VecRestoreArray(to, &part), "a vector");
}

void SharedMatrix::from_petsc(Vec from, std::span<double> to) {
  const double* part = nullptr;
  check(VecGetArrayRead(from, &part), "a vector");
  std::copy_n(part, begin_[at(rank()) + 1] - begin_[at(rank())], gathered_.begin() + begin_[at(rank())]);
  check(VecRestoreArrayRead(from, &part), "a vector");
  ranks_.gather(gathered_, begin_);
  for (std::size_t u = 0; u < to.size(); ++u) to[u] = gathered_[static_cast<std::size_t>(place_[u])];
}

std::vector<PetscInt> SharedMatrix::wide_rows(Index displacements, std::size_t most) const {
  std::vector<PetscInt> wide;
  const auto first = place_.size() - row_length_.size();
  for (std::size_t r = 0; r < row_length_.size() && wide.size() < most; ++r) {
    if (row_length_[r] > displacements) wide.push_back(place_[first + r]);
  }
  return wide;
}

}  // namespace isochor
