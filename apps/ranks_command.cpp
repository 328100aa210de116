// run as one of several processes.
#ifdef ISOCHOR_HAVE_PETSC

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>

#include "apps/commands.h"
#include "petsc/session.h"

namespace isochor::app {

namespace {

// Memory that this rank has not leaves the others waiting for it.
void end_where_memory_ran_out() {
  std::fputs("isochor: a rank ran out of memory; take more ranks or machines, or a smaller mesh\n", stderr);
  PetscSession::end_all(out_of_memory);
}

// What is said once is said by the root; ranks that fail alone end all by themselves.
void silence_this_rank() {
  if (!std::freopen("/dev/null", "w", stdout)) std::fputs("isochor: no /dev/null\n", stderr);
}

}  // namespace

int run_on_ranks(RunArguments a) {
  const PetscSession session(a.petsc);
  std::set_new_handler(end_where_memory_ran_out);
  const auto ranks = session.ranks();
  const bool root = ranks->rank() == 0;
  if (!root) silence_this_rank();
  // Cores are for ranks.
  if (a.threads == 0) a.threads = 1;
  if (a.accuracy || a.error || a.price || a.explain) {
    if (root)
      std::fputs(
          "isochor: --accuracy, --error, --price and --explain are not there across ranks yet; leave them "
          "out, or "
          "run without mpirun\n",
          stderr);
    return bad_input;
  }
  try {
    return run(a, ranks);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "isochor: rank %d: internal error: %s\n", ranks->rank(), e.what());
  } catch (...) {
    std::fprintf(stderr, "isochor: rank %d: internal error\n", ranks->rank());
  }
  PetscSession::end_all(internal);
}

}  // namespace isochor::app

#endif
