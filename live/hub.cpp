#include "live/hub.h"

#include <algorithm>
#include <charconv>
#include <string_view>

namespace isochor::live {

namespace {

constexpr std::chrono::seconds kAbsent{12};          // without a word: gone
constexpr std::chrono::milliseconds kPatience{800};  // for a picture; a viewer that is gone is noticed then

const char* const kUnknown = "this viewer is not known (any more); join again";

bool has_word(std::string_view list, std::string_view word) {
  for (std::size_t at = 0; at <= list.size();) {
    const std::size_t end = std::min(list.find(',', at), list.size());
    if (list.substr(at, end - at) == word) return true;
    at = end + 1;
  }
  return false;
}

}  // namespace

Hub::Viewer* Hub::find(const std::string& viewer, Clock::time_point now) {
  const auto found = viewers_.find(viewer);
  if (found == viewers_.end()) return nullptr;
  found->second.seen = now;
  return &found->second;
}

void Hub::forget_absent(Clock::time_point now) {
  for (auto it = viewers_.begin(); it != viewers_.end();) {
    if (now - it->second.seen <= kAbsent) {
      ++it;
      continue;
    }
    if (it->first == driver_) driver_.clear();
    it = viewers_.erase(it);
  }
}

Answer Hub::refuse(int status, const std::string& sentence) {
  return {status, error_message(sentence), false};
}

Answer Hub::refuse_counted(int status, const std::string& sentence) {
  ++refused_;
  return refuse(status, sentence);
}

Answer Hub::join(Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  forget_absent(now);
  if (viewers_.size() >= most_viewers)
    return refuse_counted(503, std::to_string(most_viewers) + " viewers look on already; close one of them");
  const std::string name = random_token();
  if (name.empty()) return refuse_counted(503, "the system has no random numbers for a new viewer");
  viewers_[name].seen = now;
  if (driver_.empty() && !readonly_) driver_ = name;
  return {200, "{\"viewer\":\"" + name + "\"}", false};
}

Answer Hub::leave(const std::string& viewer) {
  const std::lock_guard lock(mutex_);
  if (viewers_.erase(viewer) == 0) return refuse_counted(410, kUnknown);
  if (viewer == driver_) driver_.clear();
  return {200, "{}", false};
}

Answer Hub::scene(const std::string& viewer, Clock::time_point now) {
  {
    const std::lock_guard lock(mutex_);
    Viewer* v = find(viewer, now);
    if (!v) return refuse_counted(410, kUnknown);
    if (!v->pictures.take(now)) return refuse_counted(429, "too many pictures are asked for; ask less often");
  }
  return {200, scene_message(player_.simulation(), readonly_), true};
}

Answer Hub::picture(const std::string& viewer, const std::string& after, const std::string& field,
                    const std::string& wants) {
  std::uint64_t number = 0;
  const auto read = std::from_chars(after.data(), after.data() + after.size(), number);
  {
    const auto now = Clock::now();
    const std::lock_guard lock(mutex_);
    if (read.ec != std::errc() || read.ptr != after.data() + after.size())
      return refuse_counted(400, "after must be the number of a picture");
    Viewer* v = find(viewer, now);
    if (!v) return refuse_counted(410, kUnknown);
    if (!v->pictures.take(now)) return refuse_counted(429, "too many pictures are asked for; ask less often");
  }
  const ShownPtr shown = player_.wait(number, is_computed(player_.simulation(), field), kPatience);
  const Wish wish{field, has_word(wants, "forces"), has_word(wants, "fibers")};
  Audience audience;
  {
    const auto now = Clock::now();
    const std::lock_guard lock(mutex_);
    find(viewer, now);
    forget_absent(now);
    audience = {viewer == driver_, static_cast<int>(viewers_.size()), refused_};
  }
  return {200, picture_message(player_.simulation(), *shown, wish, audience), true};
}

Answer Hub::command(const std::string& viewer, std::string_view text, Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  Viewer* v = find(viewer, now);
  if (!v) return refuse_counted(410, kUnknown);
  if (!v->commands.take(now)) return refuse_counted(429, "too many commands; send fewer than 200 a second");
  const auto command = parse_command(text);
  if (!command) return refuse_counted(400, command.error());
  if (readonly_) return refuse_counted(403, "this session is for looking on (--readonly)");
  if (command.value().action == Action::take) {
    driver_ = viewer;
    return {200, "{}", false};
  }
  forget_absent(now);
  if (driver_.empty()) driver_ = viewer;
  if (viewer != driver_) return refuse(409, "another viewer drives; take over first");
  if (auto r = player_.push(command.value()); !r) return refuse_counted(429, r.error());
  return {200, "{}", false};
}

void Hub::count_refusal() {
  const std::lock_guard lock(mutex_);
  ++refused_;
}

std::uint64_t Hub::refused() const {
  const std::lock_guard lock(mutex_);
  return refused_;
}

}  // namespace isochor::live
