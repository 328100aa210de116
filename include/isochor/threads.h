// Threads of the BLAS under the direct solvers.
#pragma once

#include "isochor/export.h"

namespace isochor {

// A setting of the whole process: how many threads a BLAS works with decides the last bits of a factor, so it
// is a fixed number, never taken from WorldOptions::threads or from the machine. The first solver that is
// made sets it to 2 unless the host has called this before. Returns false when `threads` < 1 or the BLAS in
// this process (OpenBLAS, MKL and BLIS do) offers no way to say it.
ISOCHOR_API bool set_blas_threads(int threads);

// What was set; 0: nothing, or no BLAS that can be told.
ISOCHOR_API int blas_threads();

}  // namespace isochor
