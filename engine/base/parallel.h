// Parallel loops over index ranges. A loop body is passed as two pointers, so a call allocates nothing.
#pragma once

#include <memory>
#include <type_traits>

#include "engine/base/base.h"
#include "isochor/host.h"

namespace isochor {

// Reference to a loop body `void(Index begin, Index end)`. The referred object must outlive the call.
class RangeBody {
 public:
  template <class F>
  RangeBody(const F& f)
      : object_(&f), call_([](const void* o, Index b, Index e) { (*static_cast<const F*>(o))(b, e); }) {}
  void operator()(Index begin, Index end) const { call_(object_, begin, end); }

 private:
  const void* object_;
  void (*call_)(const void*, Index, Index);
};

// Runs a body over [0, n) in chunks of `grain` whose borders depend on n and grain alone, never on the number
// of threads. A host may plug its own task system in.
class Parallel {
 public:
  virtual ~Parallel() = default;
  virtual int threads() const = 0;
  virtual void run(Index n, Index grain, RangeBody body) const = 0;
  // As many threads of the same kind.
  virtual std::unique_ptr<Parallel> another() const = 0;
};

// oneTBB arena with this number of threads; 0: all the machine has. Without oneTBB: the thread that calls.
class TbbParallel final : public Parallel {
 public:
  explicit TbbParallel(int threads);
  ~TbbParallel() override;
  int threads() const override { return threads_; }
  void run(Index n, Index grain, RangeBody body) const override;
  std::unique_ptr<Parallel> another() const override { return std::make_unique<TbbParallel>(threads_); }

 private:
  struct Arena;
  Arena* arena_;
  int threads_;
};

// The threads of the host.
class HostParallel final : public Parallel {
 public:
  explicit HostParallel(std::shared_ptr<ThreadPool> pool) : pool_(std::move(pool)) {}
  int threads() const override { return pool_->threads(); }
  void run(Index n, Index grain, RangeBody body) const override;
  std::unique_ptr<Parallel> another() const override { return std::make_unique<HostParallel>(pool_); }

 private:
  std::shared_ptr<ThreadPool> pool_;
};

// Sum of n terms in an order that depends on n alone: blocks of fixed size, then the blocks in turn.
double ordered_sum(std::span<const double> terms);

}  // namespace isochor
