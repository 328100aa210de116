// The thread count of the BLAS under the solvers. Which BLAS that is, is decided when the program is loaded.
#include <atomic>
#include <cstdint>
#include <initializer_list>

#include "isochor/threads.h"

#if __has_include(<dlfcn.h>) && !defined(__EMSCRIPTEN__)  // a WebAssembly module has no loader to ask
#include <dlfcn.h>
#define ISOCHOR_HAVE_DLSYM
#endif

namespace isochor {
namespace {

std::atomic<int> threads_set{0};

template <class Function>
Function* find([[maybe_unused]] const char* name) {
#ifdef ISOCHOR_HAVE_DLSYM
  return reinterpret_cast<Function*>(dlsym(RTLD_DEFAULT, name));
#else
  return nullptr;
#endif
}

}  // namespace

bool set_blas_threads(int threads) {
  if (threads < 1) return false;
  bool found = false;
  for (const char* name : {"openblas_set_num_threads", "MKL_Set_Num_Threads"}) {
    if (auto* const set = find<void(int)>(name)) {
      set(threads);
      found = true;
    }
  }
  if (auto* const set = find<void(std::int64_t)>("bli_thread_set_num_threads")) {
    set(threads);
    found = true;
  }
  if (found) threads_set = threads;
  return found;
}

int blas_threads() {
  return threads_set;
}

}  // namespace isochor
