// One seed in a process of its own, so that a crash and a hang are verdicts like others.
#pragma once

#include <sys/types.h>

#include <chrono>

#include "studies/chaos/study.h"

namespace isochor::studies {

class ChaosChild {
 public:
  // `work` runs in the child; `folder` is made by it and takes what it prints to stderr.
  ChaosChild(std::uint64_t seed, std::string folder, double limit, const std::function<ChaosOutcome()>& work);
  ~ChaosChild();
  ChaosChild(ChaosChild&& other) noexcept;
  ChaosChild& operator=(ChaosChild&&) = delete;

  int pipe() const { return pipe_; }
  // Reads what is there; true when the process has ended or was ended for its time.
  bool ended();
  ChaosOutcome outcome();

 private:
  void kill_and_wait();

  std::uint64_t seed_ = 0;
  std::string folder_;
  double limit_ = 0;
  pid_t process_ = -1;
  int pipe_ = -1, status_ = 0;
  bool too_long_ = false;
  std::string text_;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace isochor::studies
