// A simulation in a thread of its own: commands go in, the newest picture comes out. Nobody who looks makes
// the simulation wait.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "live/simulation.h"

namespace isochor::live {

// A picture with how the simulation goes.
struct Shown : Picture {
  std::uint64_t number = 0;  // ascends
  // Fields of bodies, as of frames; of this state where it is the latest for long, else of one a little
  // older: they cost many times what positions do. Null: nobody has asked for them.
  std::shared_ptr<const std::vector<std::vector<double>>> values;
  bool playing = false, settled = false;
  double speed = 1;               // the most that is made of real time
  std::optional<double> factor;   // simulated over real time, lately
  double step_ms = 0, per_s = 0;  // a step, and steps a second, lately
  // Of the thread so far, for steps and for pictures [s].
  double spent_on_steps = 0, spent_on_pictures = 0;
};
using ShownPtr = std::shared_ptr<const Shown>;

// How fast steps come: the median of their lengths, and rates over the last second.
class Tempo {
 public:
  using Clock = std::chrono::steady_clock;
  void step(Clock::time_point end, double seconds, double simulated);
  void forget() { steps_.clear(); }
  double step_ms() const;
  double per_s(Clock::time_point now) const;
  double factor(Clock::time_point now) const;  // simulated over real time

 private:
  struct Step {
    Clock::time_point end;
    double seconds = 0, simulated = 0;
  };
  double window(Clock::time_point now) const;
  std::deque<Step> steps_;
};

// When something may be done again whose cost is to stay a share of all time.
class Turn {
 public:
  using Clock = std::chrono::steady_clock;
  explicit Turn(double share, double most_per_s) : share_(share), most_per_s_(most_per_s) {}
  Clock::time_point next() const { return next_; }
  bool due(Clock::time_point now) const { return now >= next_; }
  void done(Clock::time_point begin, Clock::time_point end);

 private:
  double share_, most_per_s_, cost_ = 0;
  Clock::time_point next_{};
};

class Player {
 public:
  static constexpr std::size_t most_waiting = 256;
  static constexpr double lowest_speed = 0.01, highest_speed = 1000;

  using Clock = std::chrono::steady_clock;
  // In a thread of its own, or in turns that the caller gives it, where there are no threads (live/wasm).
  enum class Drive : std::uint8_t { thread, caller };

  // `options.interrupted` is the player's own. Begins in motion where `playing`.
  static Result<std::unique_ptr<Player>> start(SceneDef scene, SimulationOptions options, bool playing,
                                               Drive drive = Drive::thread);
  ~Player();

  // Of Drive::caller: commands, and a step and a picture where they are due; when to come again. Nothing
  // waits in between, and a command waits for the step that it finds.
  Clock::time_point turn();

  // From any thread. Of commands that replace each other the last one counts. Refused: too many wait.
  Result<void> push(const Command& command);
  ShownPtr latest() const;
  bool over() const;  // stopped, or ended by itself where memory ran out
  // One that is newer, with values where fields are wanted; the latest after `timeout`, or at once where the
  // caller drives.
  ShownPtr wait(std::uint64_t after, bool fields, std::chrono::milliseconds timeout);
  // Ends the thread, stopping a step that works; says what could not be ended in good order.
  Result<void> stop();

  // What does not change while the thread runs.
  const Simulation& simulation() const { return *simulation_; }

 private:
  explicit Player(bool playing) : playing_(playing) {}
  // Whether anybody looks on, and at fields.
  struct Asked {
    bool watched = false, fields = false;
  };
  Asked asked(Clock::time_point now) const;                             // under the mutex
  Clock::time_point due(Clock::time_point now, const Asked& by) const;  // likewise
  void run();
  void live();  // until it is over
  void act(const Asked& by);
  void end_without_memory();
  bool work();  // commands; false: it is over
  void obey(const Command& command);
  void make_step();
  // False: its turn has not come.
  bool publish(const Asked& by, bool stepped);
  bool lacks(bool fields) const;  // what is shown, under the mutex
  double period() const;
  bool moves() const;

  std::unique_ptr<Simulation> simulation_;
  std::thread thread_;
  mutable std::mutex mutex_;
  std::condition_variable work_, news_;
  // Under the mutex.
  std::deque<Command> waiting_;
  ShownPtr latest_;
  bool over_ = false;
  Clock::time_point asked_{}, fields_wanted_{};  // the last time, for a picture and for fields
  // Asked by steps from any thread.
  std::atomic<bool> interrupt_{false};
  // Of the thread.
  bool playing_, single_ = false, fresh_ = true, stuck_ = false;
  double speed_ = 1, spent_on_steps_ = 0, spent_on_pictures_ = 0;
  Tempo tempo_;
  Clock::time_point next_step_{};
  Turn picture_{0.015, 40}, fields_{0.012, 15}, unseen_{0.01, 2};
  bool values_old_ = false, answers_ = false;  // answers_: the next picture shows what a command has done
  std::uint64_t number_ = 0;
  Result<void> ended_;
};

}  // namespace isochor::live
