// What needs no handle.
#include "isochor/isochor.h"

extern "C" const char* iso_status_text(iso_status status) {
  switch (status) {
    case ISO_OK:
      return "all is fine";
    case ISO_REFUSED:
      return "the call was refused for what it was given, and changed nothing";
    case ISO_NOT_CONVERGED:
      return "a step found no equilibrium; the state is as it was, or the last one in balance";
    case ISO_UNFINISHED:
      return "the budget of a step ran out; the state is its best iterate";
    case ISO_CANCELLED:
      return "a step was stopped; the state is as it was";
    case ISO_BUSY:
      return "another thread, or a callback, is in a call of the same world; the call changed nothing";
    case ISO_NO_MEMORY:
      return "there is not enough memory";
    case ISO_FAILED:
      return "an error of the library";
    default:
      return "no status of this library";
  }
}

extern "C" const char* iso_version(void) {
  return ISOCHOR_VERSION;
}
