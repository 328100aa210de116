// Counts heap allocations of the whole process, whoever makes them: operator new, Eigen, the C library. And
// lets operator new fail.
#pragma once

namespace test {

// False where malloc cannot be replaced (another C library, a sanitizer): counts stay zero then.
bool allocations_are_counted();

// While it lives, operator new fails the n-th time that any thread calls it, and with `ever_after` from then
// on: as memory does that is gone for good.
class FailingAllocation {
 public:
  FailingAllocation(long n, bool ever_after);
  ~FailingAllocation();
  FailingAllocation(const FailingAllocation&) = delete;
  FailingAllocation& operator=(const FailingAllocation&) = delete;
  // Whether it came to that.
  bool failed() const;
};

// Counts from construction on.
class AllocationCount {
 public:
  AllocationCount();
  long count() const;

 private:
  long start_;
};

}  // namespace test
