// What may stop a step that is under way.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <optional>

namespace isochor {

class Interrupt {
 public:
  using Clock = std::chrono::steady_clock;

  // Any thread may ask for the step under way, or else the next one, to stop.
  void request() { requested_.store(true, std::memory_order_relaxed); }
  bool requested() const { return requested_.load(std::memory_order_relaxed); }
  // A request is taken by the step that it stops: one that comes between steps is not lost.
  void take() { requested_.store(false, std::memory_order_relaxed); }

  void ask(std::function<bool()> asked) { asked_ = std::move(asked); }
  // Wall time of the step under way; none: no limit.
  void set_deadline(std::optional<Clock::time_point> deadline) { deadline_ = deadline; }

  // Whether a host wants the step to stop; running out of time is no such wish.
  bool wanted() const { return requested() || (asked_ && asked_()); }
  // Asked often, from any thread that works.
  bool raised() const { return (deadline_ && Clock::now() > *deadline_) || wanted(); }

 private:
  std::atomic<bool> requested_{false};
  std::function<bool()> asked_;
  std::optional<Clock::time_point> deadline_;
};

}  // namespace isochor
