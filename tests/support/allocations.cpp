#include "support/allocations.h"

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <new>

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define ISOCHOR_COUNT_ALLOCATIONS 1
#endif

namespace {
std::atomic<long> g_allocations{0};
// Calls of operator new that are left until one fails; beyond that they go on failing where asked to.
std::atomic<bool> g_armed{false}, g_ever_after{false}, g_failed{false};
std::atomic<long> g_left{0};
}  // namespace

#ifdef ISOCHOR_COUNT_ALLOCATIONS
// Not under sanitizers, which pair every kind of new with its delete.
namespace {
void fail_if_it_is_time() {
  if (!g_armed.load(std::memory_order_relaxed)) return;
  const long left = g_left.fetch_sub(1) - 1;
  if (left > 0 || (left < 0 && !g_ever_after.load())) return;
  g_failed.store(true);
  throw std::bad_alloc();
}
}  // namespace

void* operator new(std::size_t bytes) {
  fail_if_it_is_time();
  if (void* p = std::malloc(bytes > 0 ? bytes : 1)) return p;
  throw std::bad_alloc();
}
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  fail_if_it_is_time();
  const auto step = static_cast<std::size_t>(alignment);
  if (void* p = std::aligned_alloc(step, (bytes + step - 1) / step * step)) return p;
  throw std::bad_alloc();
}
void operator delete(void* p) noexcept {
  std::free(p);
}
void operator delete(void* p, std::size_t) noexcept {
  std::free(p);
}
void operator delete(void* p, std::align_val_t) noexcept {
  std::free(p);
}
void operator delete(void* p, std::size_t, std::align_val_t) noexcept {
  std::free(p);
}

// The C library's own allocator under its other name.
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

void* malloc(std::size_t bytes) {
  g_allocations.fetch_add(1, std::memory_order_relaxed);
  return __libc_malloc(bytes);
}
void* calloc(std::size_t count, std::size_t bytes) {
  g_allocations.fetch_add(1, std::memory_order_relaxed);
  return __libc_calloc(count, bytes);
}
void* realloc(void* old, std::size_t bytes) {
  g_allocations.fetch_add(1, std::memory_order_relaxed);
  return __libc_realloc(old, bytes);
}
void* memalign(std::size_t alignment, std::size_t bytes) {
  g_allocations.fetch_add(1, std::memory_order_relaxed);
  return __libc_memalign(alignment, bytes);
}
void* aligned_alloc(std::size_t alignment, std::size_t bytes) {
  return memalign(alignment, bytes);
}
int posix_memalign(void** out, std::size_t alignment, std::size_t bytes) {
  *out = memalign(alignment, bytes);
  return *out ? 0 : ENOMEM;
}
}
#endif

namespace test {

bool allocations_are_counted() {
#ifdef ISOCHOR_COUNT_ALLOCATIONS
  return true;
#else
  return false;
#endif
}

FailingAllocation::FailingAllocation(long n, bool ever_after) {
  g_failed = false;
  g_ever_after = ever_after;
  g_left = n;
  g_armed = true;
}
FailingAllocation::~FailingAllocation() {
  g_armed = false;
}
bool FailingAllocation::failed() const {
  return g_failed.load();
}

AllocationCount::AllocationCount() : start_(g_allocations.load()) {}
long AllocationCount::count() const {
  return g_allocations.load() - start_;
}

}  // namespace test
