#include "engine/base/parallel.h"

#ifndef ISOCHOR_WITHOUT_TBB
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>
#endif

#include <algorithm>
#include <functional>

namespace isochor {

#ifndef ISOCHOR_WITHOUT_TBB

struct TbbParallel::Arena {
  tbb::task_arena arena;
};

TbbParallel::TbbParallel(int threads)
    : threads_(threads > 0 ? threads : tbb::this_task_arena::max_concurrency()) {
  arena_ = new Arena{tbb::task_arena(threads_)};
}

void TbbParallel::run(Index n, Index grain, RangeBody body) const {
  if (n <= 0) return;
  const Index chunks = (n + grain - 1) / grain;
  // A short loop is not worth waking threads for.
  if (threads_ == 1 || chunks == 1) {
    for (Index c = 0; c < chunks; ++c) body(c * grain, std::min(n, (c + 1) * grain));
    return;
  }
  arena_->arena.execute([&] {
    tbb::parallel_for(
        tbb::blocked_range<Index>(0, chunks, 1),
        [&](const tbb::blocked_range<Index>& r) {
          for (Index c = r.begin(); c < r.end(); ++c) body(c * grain, std::min(n, (c + 1) * grain));
        },
        tbb::simple_partitioner());
  });
}

#else

// Chunks in turn on the caller's thread: borders and answers are those of any number of threads.
struct TbbParallel::Arena {};

TbbParallel::TbbParallel(int) : arena_(nullptr), threads_(1) {}

void TbbParallel::run(Index n, Index grain, RangeBody body) const {
  for (Index begin = 0; begin < n; begin += grain) body(begin, std::min(n, begin + grain));
}

#endif

TbbParallel::~TbbParallel() {
  delete arena_;
}

void HostParallel::run(Index n, Index grain, RangeBody body) const {
  if (n <= 0) return;
  const Index chunks = (n + grain - 1) / grain;
  const auto chunk = [&](Index c) { body(c * grain, std::min(n, (c + 1) * grain)); };
  if (chunks == 1 || pool_->threads() == 1) {
    for (Index c = 0; c < chunks; ++c) chunk(c);
  } else {
    pool_->parallel_for(chunks, std::ref(chunk));  // a reference: std::function allocates nothing for it
  }
}

double ordered_sum(std::span<const double> terms) {
  constexpr std::size_t block = 256;
  double total = 0;
  for (std::size_t b = 0; b < terms.size(); b += block) {
    const std::size_t end = std::min(terms.size(), b + block);
    double s = 0;
    for (std::size_t i = b; i < end; ++i) s += terms[i];
    total += s;
  }
  return total;
}

}  // namespace isochor
