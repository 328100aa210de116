#include "engine/base/stopwatch.h"

#include <chrono>

namespace isochor {

namespace {

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

Stopwatch::Stopwatch(double& total) : total_(total), start_(now()) {}
Stopwatch::~Stopwatch() {
  total_ += now() - start_;
}

}  // namespace isochor
