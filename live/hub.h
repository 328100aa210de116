// Viewers of one player: who they are, who drives, what they may ask for and how often.
#pragma once

#include <map>
#include <mutex>
#include <string>

#include "live/guard.h"
#include "live/message.h"

namespace isochor::live {

// An answer, with the status that HTTP has for it.
struct Answer {
  int status = 200;
  std::string body;  // JSON, or a message of message.h where `binary`
  bool binary = false;
};

class Hub {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::size_t most_viewers = 16;

  Hub(Player& player, bool readonly) : player_(player), readonly_(readonly) {}

  // A new viewer; the first one drives. {"viewer": "..."}
  Answer join(Clock::time_point now);
  // A viewer that goes says so; one that does not is missed after a while.
  Answer leave(const std::string& viewer);
  Answer scene(const std::string& viewer, Clock::time_point now);
  // The newest picture, waited for while it has number `after`.
  // `wants`: words of "forces" and "fibers" with commas between; others are passed over.
  Answer picture(const std::string& viewer, const std::string& after, const std::string& field,
                 const std::string& wants = "");
  // A command as text.
  Answer command(const std::string& viewer, std::string_view text, Clock::time_point now);
  // For what was refused before it came to a viewer.
  void count_refusal();
  std::uint64_t refused() const;

 private:
  struct Viewer {
    Rate commands{200, 400}, pictures{240, 480};
    Clock::time_point seen{};
  };
  // Under the mutex.
  Viewer* find(const std::string& viewer, Clock::time_point now);
  void forget_absent(Clock::time_point now);
  Answer refuse(int status, const std::string& sentence);
  Answer refuse_counted(int status, const std::string& sentence);

  Player& player_;
  const bool readonly_;
  mutable std::mutex mutex_;
  std::map<std::string, Viewer> viewers_;
  std::string driver_;
  std::uint64_t refused_ = 0;
};

}  // namespace isochor::live
