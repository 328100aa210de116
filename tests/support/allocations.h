// Counts heap allocations of the whole process, whoever makes them: operator new, Eigen, the C library.
#pragma once

namespace test {

// False where malloc cannot be replaced (another C library, a sanitizer): counts stay zero then.
bool allocations_are_counted();

// Counts from construction on.
class AllocationCount {
 public:
  AllocationCount();
  long count() const;

 private:
  long start_;
};

}  // namespace test
