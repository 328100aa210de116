#include "petsc/calls.h"

#include <cstdio>
#include <limits>
#include <string>

#include "petsc/session.h"

namespace isochor {

namespace {

// PETSc calls back without a place for data of ours that outlives all errors.
std::string& first_words() {
  static std::string words;
  return words;
}

PetscErrorCode note(MPI_Comm, int, const char*, const char*, PetscErrorCode code, PetscErrorType type,
                    const char* words, void*) {
  if (type == PETSC_ERROR_INITIAL && words) first_words() = words;
  return code;
}

}  // namespace

void listen_to_petsc() {
  check(PetscPushErrorHandler(note, nullptr), "listening to its errors");
}

void check(PetscErrorCode code, const char* doing) {
  if (code == 0) return;
  const char* general = nullptr;
  PetscErrorMessage(code, &general, nullptr);
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  std::fprintf(stderr, "isochor: rank %d: PETSc failed at %s: %s%s%s\n", rank, doing,
               general ? general : "unknown error", first_words().empty() ? "" : ": ", first_words().c_str());
  PetscSession::end_all(code == PETSC_ERR_MEM ? 6 : 1);
}

PetscInt petsc_count(std::int64_t count, const char* what) {
  if (count <= std::numeric_limits<PetscInt>::max()) return static_cast<PetscInt>(count);
  std::fprintf(
      stderr,
      "isochor: %lld %s are more than this PETSc can count (it has %d bits for it); take more ranks, or a "
      "PETSc that was configured with --with-64-bit-indices\n",
      static_cast<long long>(count), what, static_cast<int>(8 * sizeof(PetscInt)));
  PetscSession::end_all(2);
}

}  // namespace isochor
