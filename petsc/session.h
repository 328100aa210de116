// MPI and PETSc in a program.
#pragma once

#include <memory>
#include <string>

#include "isochor/ranks.h"

namespace isochor {

class PetscSession {
 public:
  // Whether this process was started by mpirun, srun or a relative of them.
  static bool launched();

  // Begins MPI and PETSc, once a process; `options` as on the command line of a PETSc program, behind those
  // of the environment (PETSC_OPTIONS).
  explicit PetscSession(const std::string& options);
  // Ends both; every rank gets here, or one has called end_all().
  ~PetscSession();
  PetscSession(const PetscSession&) = delete;
  PetscSession& operator=(const PetscSession&) = delete;

  std::shared_ptr<const Ranks> ranks() const { return ranks_; }
  // Ends the processes of all ranks with this exit code, wherever they are; between begin and end only.
  [[noreturn]] static void end_all(int code);
  static bool running();

 private:
  std::shared_ptr<const Ranks> ranks_;
};

// "PETSc 3.18.5" and "Open MPI 4.1.4", for `isochor version`.
std::string petsc_version();
std::string mpi_version();

}  // namespace isochor
