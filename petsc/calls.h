// What comes of calls of MPI and PETSc.
#pragma once

#include <petscsys.h>

namespace isochor {

// Keeps what PETSc says of an error, for the sentence of check().
void listen_to_petsc();

// An error of PETSc or MPI may have come to this rank alone, and the others wait: says what it is and ends
// all of them, with exit code 6 where memory ran out, else 1.
void check(PetscErrorCode code, const char* doing);

// Counts of PETSc have 32 bits where it was built so: ends all ranks where this one does not fit.
PetscInt petsc_count(std::int64_t count, const char* what);

}  // namespace isochor
