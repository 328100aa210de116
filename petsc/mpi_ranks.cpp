#include "petsc/mpi_ranks.h"

#include <algorithm>
#include <vector>

#include "petsc/calls.h"
#include "petsc/petsc_solver.h"

namespace isochor {

namespace {

void add(void* in, void* inout, int* count, MPI_Datatype*) {
  const double* const from = static_cast<const double*>(in);
  double* const to = static_cast<double*>(inout);
  for (int i = 0; i < *count; ++i) to[i] = from[i] + to[i];
}

}  // namespace

MpiRanks::MpiRanks() {
  MPI_Comm_dup(MPI_COMM_WORLD, &comm_);
  MPI_Comm_rank(comm_, &rank_);
  MPI_Comm_size(comm_, &size_);
  // Said not to commute, so that MPI keeps the ranks in their order.
  MPI_Op_create(add, 0, &add_);
}

MpiRanks::~MpiRanks() {
  MPI_Op_free(&add_);
  MPI_Comm_free(&comm_);
}

// By the root, since sums that are made in several places may differ in their last bits.
void MpiRanks::sum(std::span<double> values) const {
  if (size_ == 1) return;
  constexpr std::size_t most = std::size_t{1} << 28;  // counts of MPI are ints
  for (std::size_t from = 0; from < values.size(); from += most) {
    const int count = static_cast<int>(std::min(most, values.size() - from));
    double* const part = values.data() + from;
    check(MPI_Reduce(rank_ == 0 ? MPI_IN_PLACE : part, part, count, MPI_DOUBLE, add_, 0, comm_), "a sum");
    check(MPI_Bcast(part, count, MPI_DOUBLE, 0, comm_), "a sum");
  }
}

void MpiRanks::gather(std::span<double> values, std::span<const std::int64_t> begin) const {
  if (size_ == 1) return;
  std::vector<int> count, first;
  for (std::size_t r = 0; r + 1 < begin.size(); ++r) {
    first.push_back(static_cast<int>(petsc_count(begin[r], "numbers of nodes")));
    count.push_back(static_cast<int>(petsc_count(begin[r + 1], "numbers of nodes")) - first.back());
  }
  check(MPI_Allgatherv(MPI_IN_PLACE, 0, MPI_DATATYPE_NULL, values.data(), count.data(), first.data(),
                       MPI_DOUBLE, comm_),
        "a gather");
}

std::unique_ptr<LinearSolver> MpiRanks::linear_solver(Solver kind, bool prefer_iterative) const {
  return make_petsc_solver(*this, kind, prefer_iterative);
}

}  // namespace isochor
