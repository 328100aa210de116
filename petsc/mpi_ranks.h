// Ranks over MPI.
#pragma once

#include <mpi.h>

#include "isochor/ranks.h"

namespace isochor {

class MpiRanks final : public Ranks {
 public:
  MpiRanks();
  ~MpiRanks() override;
  MpiRanks(const MpiRanks&) = delete;
  MpiRanks& operator=(const MpiRanks&) = delete;

  int rank() const override { return rank_; }
  int size() const override { return size_; }
  void sum(std::span<double> values) const override;
  void gather(std::span<double> values, std::span<const std::int64_t> begin) const override;
  std::unique_ptr<LinearSolver> linear_solver(Solver kind, bool prefer_iterative) const override;

 private:
  MPI_Comm comm_ = MPI_COMM_NULL;
  MPI_Op add_ = MPI_OP_NULL;
  int rank_ = 0, size_ = 1;
};

}  // namespace isochor
