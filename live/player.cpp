#include "live/player.h"

#include <algorithm>
#include <new>

#include "engine/base/text.h"

namespace isochor::live {

namespace {

using std::chrono::duration;
using std::chrono::duration_cast;
using std::chrono::milliseconds;

constexpr milliseconds kIdle{500};             // between looks at what nobody changes
constexpr std::chrono::seconds kForgotten{3};  // after which fields that nobody asks for are left out

template <class Clock>
typename Clock::duration seconds_of(double seconds) {
  return duration_cast<typename Clock::duration>(duration<double>(seconds));
}

}  // namespace

void Tempo::step(Clock::time_point end, double seconds, double simulated) {
  steps_.push_back({end, seconds, simulated});
  while (steps_.size() > 400 || (steps_.size() > 2 && end - steps_.front().end > std::chrono::seconds(1)))
    steps_.pop_front();
}

double Tempo::step_ms() const {
  if (steps_.empty()) return 0;
  std::vector<double> all;
  for (const Step& s : steps_) all.push_back(s.seconds);
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
  std::nth_element(all.begin(), middle, all.end());
  return 1e3 * *middle;
}

// From the start of the first step in it to now, or to the end of the last where the next is not late.
double Tempo::window(Clock::time_point now) const {
  if (steps_.empty()) return 0;
  const double first =
      duration<double>(steps_.back().end - steps_.front().end).count() + steps_.front().seconds;
  const double since = duration<double>(now - steps_.back().end).count();
  return since > 2 * std::max(0.05, steps_.back().seconds) ? first + since : first;
}

double Tempo::per_s(Clock::time_point now) const {
  const double w = window(now);
  return w > 0 ? static_cast<double>(steps_.size()) / w : 0;
}

double Tempo::factor(Clock::time_point now) const {
  double sum = 0;
  for (const Step& s : steps_) sum += s.simulated;
  const double w = window(now);
  return w > 0 ? sum / w : 0;
}

Result<std::unique_ptr<Player>> Player::start(SceneDef scene, SimulationOptions options, bool playing,
                                              Drive drive) {
  std::unique_ptr<Player> player(new Player(playing));
  Player* self = player.get();
  options.interrupted = [self] { return self->interrupt_.load(std::memory_order_relaxed); };
  auto simulation = Simulation::make(std::move(scene), std::move(options));
  if (!simulation) return simulation.failure();
  player->simulation_ = std::move(simulation).value();
  player->latest_ = std::make_shared<Shown>();
  player->publish({true, false}, false);
  if (drive == Drive::thread) player->thread_ = std::thread([self] { self->run(); });
  return player;
}

Player::~Player() {
  (void)stop();
}

Result<void> Player::stop() {
  {
    const std::lock_guard lock(mutex_);
    over_ = true;
    interrupt_ = true;
  }
  work_.notify_all();
  news_.notify_all();
  if (thread_.joinable()) thread_.join();
  if (simulation_) {
    auto closed = simulation_->close();
    if (ended_) ended_ = closed;
  }
  return ended_;
}

Result<void> Player::push(const Command& command) {
  if (command.action == Action::speed && !(command.value >= lowest_speed && command.value <= highest_speed)) {
    return Error{"speed = " + number(command.value) + "; it must be from " + number(lowest_speed) + " to " +
                 number(highest_speed) + " times real time"};
  }
  {
    const std::lock_guard lock(mutex_);
    // Only what nothing else stands behind may be replaced: a reset between two values tells them apart.
    for (auto it = waiting_.rbegin(); it != waiting_.rend(); ++it) {
      if (it->action != Action::set && it->action != Action::move) break;
      if (!replaces(command, *it)) continue;
      *it = command;
      return {};
    }
    if (waiting_.size() >= most_waiting)
      return Error{std::to_string(most_waiting) + " commands wait for the step to end; try again later"};
    waiting_.push_back(command);
    const bool at_once = command.action == Action::pause || command.action == Action::reset;
    if (at_once) interrupt_ = true;
  }
  work_.notify_all();
  return {};
}

ShownPtr Player::latest() const {
  const std::lock_guard lock(mutex_);
  return latest_;
}

ShownPtr Player::wait(std::uint64_t after, bool fields, milliseconds timeout) {
  std::unique_lock lock(mutex_);
  const auto now = Clock::now();
  const bool news = now - asked_ > kForgotten || (fields && !latest_->values);
  asked_ = now;
  if (fields) fields_wanted_ = now;
  if (news) work_.notify_all();
  if (!thread_.joinable()) return latest_;
  const auto there = [&] { return over_ || (latest_->number > after && (latest_->values || !fields)); };
  news_.wait_for(lock, timeout, there);
  return latest_;
}

void Player::run() {
  try {
    live();
  } catch (const std::bad_alloc&) {
    end_without_memory();
  }
  news_.notify_all();
}

void Player::end_without_memory() {
  const std::lock_guard lock(mutex_);
  over_ = true;
  ended_ = Error{"memory ran out; take a coarser mesh or give the process more"};
}

bool Player::over() const {
  const std::lock_guard lock(mutex_);
  return over_;
}

bool Player::moves() const {
  return single_ || (playing_ && !stuck_ && !simulation_->settled());
}

// Real time between the starts of two steps. Statics has no time of its own: two seconds for all of it.
double Player::period() const {
  const double h = simulation_->step_length();
  if (simulation_->dynamic()) return h / speed_;
  const double all = simulation_->scene().analysis.duration;
  return std::min(0.1, 2 * h / all) / speed_;
}

bool Player::lacks(bool fields) const {
  return fields && (!latest_->values || values_old_);
}

Player::Asked Player::asked(Clock::time_point now) const {
  return {now - asked_ < kForgotten, now - fields_wanted_ < kForgotten};
}

// What has changed is shown as soon as a picture is due, and what moves goes on when its time has come.
Player::Clock::time_point Player::due(Clock::time_point now, const Asked& by) const {
  Clock::time_point when = now + kIdle;
  if (fresh_) when = std::min(when, by.watched ? picture_.next() : unseen_.next());
  if (lacks(by.fields)) when = std::min(when, latest_->values && moves() ? fields_.next() : now);
  if (moves()) when = std::min(when, single_ ? now : next_step_);
  return when;
}

void Player::live() {
  while (work()) {
    Asked by;
    {
      std::unique_lock lock(mutex_);
      const auto now = Clock::now();
      by = asked(now);
      const auto when = due(now, by);
      if (when > now) {
        work_.wait_until(lock, when, [&] {
          const Asked then = asked(Clock::now());
          return over_ || !waiting_.empty() || (!by.watched && then.watched) || (!by.fields && then.fields);
        });
        continue;
      }
    }
    act(by);
  }
}

Player::Clock::time_point Player::turn() {
  try {
    if (!work()) return Clock::time_point::max();
    const auto now = Clock::now();
    const Asked by = asked(now);
    if (const auto when = due(now, by); when > now) return when;
    act(by);
  } catch (const std::bad_alloc&) {
    end_without_memory();
  }
  return Clock::now();
}

void Player::act(const Asked& by) {
  const bool steps = moves() && (single_ || Clock::now() >= next_step_);
  if (steps) make_step();
  if (publish(by, steps)) answers_ = answers_ && !steps && moves();
}

bool Player::work() {
  std::deque<Command> commands;
  {
    const std::lock_guard lock(mutex_);
    if (over_) return false;
    commands.swap(waiting_);
    interrupt_ = false;
  }
  for (const Command& c : commands) obey(c);
  return true;
}

void Player::obey(const Command& c) {
  switch (c.action) {
    case Action::play:
      playing_ = true;
      stuck_ = false;
      next_step_ = Clock::now();
      break;
    case Action::pause:
      playing_ = false;
      tempo_.forget();
      break;
    case Action::step:
      playing_ = false;
      stuck_ = false;
      single_ = true;
      break;
    case Action::speed:
      speed_ = c.value;
      next_step_ = Clock::now();
      break;
    case Action::take:
      break;
    default:
      if (simulation_->apply(c)) stuck_ = false;
      if (c.action == Action::reset) tempo_.forget();
  }
  fresh_ = answers_ = true;
}

void Player::make_step() {
  single_ = false;
  const double before = simulation_->time();
  const auto begin = Clock::now();
  // Lost time is lost: a world that was late does not run after it.
  next_step_ = std::max(next_step_, begin - seconds_of<Clock>(period())) + seconds_of<Clock>(period());
  const StepEnd end = simulation_->advance();
  if (end == StepEnd::failed) stuck_ = true;
  spent_on_steps_ += duration<double>(Clock::now() - begin).count();
  if (end != StepEnd::interrupted)
    tempo_.step(Clock::now(), simulation_->seconds_of_step(), simulation_->time() - before);
  fresh_ = true;
}

void Turn::done(Clock::time_point begin, Clock::time_point end) {
  const double cost = duration<double>(end - begin).count();
  cost_ = cost_ > 0 ? 0.8 * cost_ + 0.2 * cost : cost;
  next_ = begin + seconds_of<Clock>(std::max(1 / most_per_s_, cost_ / share_));
}

bool Player::publish(const Asked& by, bool stepped) {
  const auto begin = Clock::now();
  // Values that somebody waits for are made at once, others when their turn has come, and the last ones at
  // rest.
  const bool first = by.fields && !latest_->values;
  const bool anew = first || (by.fields && (fresh_ || values_old_) && (fields_.due(begin) || !moves()));
  // What a command has done is shown behind the next step, out of turn.
  const bool due = (answers_ && stepped) || (by.watched ? picture_.due(begin) : unseen_.due(begin));
  if (!anew && !(fresh_ && due)) return false;
  auto shown = std::make_shared<Shown>();
  static_cast<Picture&>(*shown) = simulation_->picture(anew);
  if (anew) {
    shown->values = std::make_shared<std::vector<std::vector<double>>>(std::move(shown->frame.fields));
    fields_.done(begin, Clock::now());
  } else if (by.fields) {
    shown->values = latest_->values;
  }
  values_old_ = by.fields && !anew && (values_old_ || fresh_);
  shown->number = ++number_;
  shown->playing = playing_;
  shown->settled = playing_ && simulation_->settled();
  shown->speed = speed_;
  if (simulation_->dynamic() && playing_) shown->factor = tempo_.factor(begin);
  shown->step_ms = tempo_.step_ms();
  shown->per_s = tempo_.per_s(begin);
  spent_on_pictures_ += duration<double>(Clock::now() - begin).count();
  shown->spent_on_steps = spent_on_steps_;
  shown->spent_on_pictures = spent_on_pictures_;
  fresh_ = false;
  if (!anew) picture_.done(begin, Clock::now());
  unseen_.done(begin, Clock::now());
  {
    const std::lock_guard lock(mutex_);
    latest_ = std::move(shown);
  }
  news_.notify_all();
  return true;
}

}  // namespace isochor::live
