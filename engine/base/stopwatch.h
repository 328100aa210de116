// For the time that a stage takes.
#pragma once

namespace isochor {

// Adds the seconds of its own life to a total.
class Stopwatch {
 public:
  explicit Stopwatch(double& total);
  ~Stopwatch();
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  double& total_;
  double start_;
};

}  // namespace isochor
