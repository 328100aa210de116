#include "petsc/session.h"

#include <petscsys.h>

#include <cstdio>
#include <cstdlib>

#include "isochor/threads.h"
#include "petsc/calls.h"
#include "petsc/mpi_ranks.h"

namespace isochor {

namespace {

// What options of the user's override.
constexpr const char* kDefaults =
    "-mat_mumps_icntl_13 1 -mat_mumps_icntl_24 1 -mat_mumps_icntl_8 0 -mat_mumps_cntl_1 0.01 "
    "-mat_mumps_cntl_3 1e-14 "
    "-fieldsplit_x_ksp_type preonly -fieldsplit_x_pc_type gamg -fieldsplit_x_mg_levels_ksp_type chebyshev "
    "-fieldsplit_x_mg_levels_ksp_max_it 2 -fieldsplit_x_mg_levels_pc_type jacobi "
    "-fieldsplit_lambda_ksp_type preonly -fieldsplit_lambda_pc_type jacobi "
    "-mg_levels_ksp_type chebyshev -mg_levels_ksp_max_it 2 -mg_levels_pc_type jacobi";

}  // namespace

bool PetscSession::launched() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMI_RANK", "PMIX_RANK"}) {
    if (std::getenv(name)) return true;
  }
  return false;
}

PetscSession::PetscSession(const std::string& options) {
  // Threads call the engine's loops; what is said between ranks is said by the first.
  int provided = 0;
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
  // PETSc takes options of the environment when it begins, and the defaults are for what they do not say.
  const char* const given = std::getenv("PETSC_OPTIONS");
  const std::string user = (given ? given : "") + std::string(" ") + options;
  check(PetscInitializeNoArguments(), "its beginning");
  listen_to_petsc();
  check(PetscPopSignalHandler(), "its signal handlers");
  check(PetscOptionsInsertString(nullptr, kDefaults), "its options");
  check(PetscOptionsInsertString(nullptr, user.c_str()), "its options");
  // Cores are for ranks.
  set_blas_threads(1);
  ranks_ = std::make_shared<MpiRanks>();
}

PetscSession::~PetscSession() {
  ranks_.reset();
  PetscFinalize();
  MPI_Finalize();
}

bool PetscSession::running() {
  int begun = 0, ended = 0;
  MPI_Initialized(&begun);
  MPI_Finalized(&ended);
  return begun && !ended;
}

void PetscSession::end_all(int code) {
  std::fflush(stdout);
  std::fflush(stderr);
  MPI_Abort(MPI_COMM_WORLD, code);
  std::_Exit(code);
}

std::string petsc_version() {
  return std::to_string(PETSC_VERSION_MAJOR) + "." + std::to_string(PETSC_VERSION_MINOR) + "." +
         std::to_string(PETSC_VERSION_SUBMINOR);
}

std::string mpi_version() {
  char text[MPI_MAX_LIBRARY_VERSION_STRING];
  int length = 0;
  MPI_Get_library_version(text, &length);
  std::string words(text, static_cast<std::size_t>(length));
  return words.substr(0, words.find_first_of(",\n"));
}

}  // namespace isochor
