// The thread of a simulation: newest pictures, commands in order, nobody waits for anybody.
#include "live/player.h"

#include <algorithm>

#include "catch.h"
#include "scene/small_scene.h"

using namespace isochor;
using namespace isochor::live;
using std::chrono::milliseconds;

namespace {

std::unique_ptr<Player> start(bool playing,
                              const Overrides& overrides = {"analysis.type=dynamic", "analysis.steps=10",
                                                            "analysis.duration=0.2"}) {
  auto p = Player::start(test::small_scene(overrides), {}, playing);
  if (!p) FAIL(p.error());
  return std::move(p).value();
}

Command plain(Action action, double value = 0, int control = -1) {
  Command c;
  c.action = action;
  c.value = value;
  c.control = control;
  return c;
}

// Waits for what is to come, however slow the machine is.
template <class Holds>
ShownPtr wait_for(Player& p, Holds holds, bool fields = false) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  ShownPtr shown = p.latest();
  while (!holds(*shown)) {
    REQUIRE(std::chrono::steady_clock::now() < end);
    shown = p.wait(shown->number, fields, milliseconds(200));
  }
  return shown;
}

}  // namespace

TEST_CASE("a player plays, pauses, steps once and begins again") {
  auto p = start(true);
  wait_for(*p, [](const Shown& s) { return s.step > 5; });
  REQUIRE(p->push(plain(Action::pause)).ok());
  const int step = wait_for(*p, [](const Shown& s) { return !s.playing; })->step;
  CHECK(p->wait(p->latest()->number, false, milliseconds(150))->step == step);
  REQUIRE(p->push(plain(Action::step)).ok());
  wait_for(*p, [&](const Shown& s) { return s.step == step + 1; });
  REQUIRE(p->push(plain(Action::reset)).ok());
  const auto fresh = wait_for(*p, [](const Shown& s) { return s.step == 0; });
  CHECK(fresh->time == 0);
  CHECK(fresh->hash == start(false)->latest()->hash);
}

TEST_CASE("fields come when they are asked for, also at rest") {
  auto p = start(false);
  CHECK(p->latest()->values == nullptr);
  const auto shown = wait_for(
      *p, [](const Shown& s) { return s.values != nullptr; }, true);
  CHECK(shown->values->size() >= 4);
  CHECK(shown->step == 0);
  // Where it comes to rest, the values are those of the state.
  REQUIRE(p->push(plain(Action::play)).ok());
  wait_for(
      *p, [](const Shown& s) { return s.step > 20; }, true);
  REQUIRE(p->push(plain(Action::pause)).ok());
  wait_for(
      *p, [](const Shown& s) { return !s.playing; }, true);
  const BodyFields fields = p->simulation().fields_now(0);
  const double most = *std::max_element(fields.node_pressure.begin(), fields.node_pressure.end());
  wait_for(
      *p,
      [&](const Shown& s) { return *std::max_element((*s.values)[1].begin(), (*s.values)[1].end()) == most; },
      true);
}

TEST_CASE("who looks on seldom sees the newest picture, and nothing has waited") {
  auto p = start(true);
  const auto first = wait_for(*p, [](const Shown& s) { return s.step > 0; });
  REQUIRE(p->push(plain(Action::speed, 1000)).ok());
  // Others look meanwhile, so steps go on without this viewer.
  const auto later = wait_for(*p, [&](const Shown& s) { return s.step > first->step + 50; });
  CHECK(later->number > first->number);
  // The next look is at once at the latest.
  CHECK(p->wait(first->number, false, milliseconds(0))->step >= later->step);
}

TEST_CASE("of values that wait the last one counts, and a reset stands between them") {
  auto p = start(false);
  int young = -1;
  for (std::size_t i = 0; i < p->simulation().dials().size(); ++i) {
    if (p->simulation().dials()[i].name.find("Young") != std::string::npos) young = static_cast<int>(i);
  }
  REQUIRE(young >= 0);
  for (int i = 0; i < 5000; ++i) REQUIRE(p->push(plain(Action::set, 500 + 0.01 * i, young)).ok());
  wait_for(*p, [&](const Shown& s) { return s.dials[static_cast<std::size_t>(young)] == 500 + 0.01 * 4999; });
  REQUIRE(p->push(plain(Action::set, 700, young)).ok());
  REQUIRE(p->push(plain(Action::reset)).ok());
  REQUIRE(p->push(plain(Action::set, 800, young)).ok());
  wait_for(*p, [&](const Shown& s) { return s.dials[static_cast<std::size_t>(young)] == 800; });
  REQUIRE(p->push(plain(Action::reset)).ok());
  wait_for(*p, [&](const Shown& s) { return s.dials[static_cast<std::size_t>(young)] == 1000; });
}

TEST_CASE("statics comes to rest at the end of its loading, and wakes up where something changes") {
  auto p = start(true, {});
  const auto rest = wait_for(*p, [](const Shown& s) { return s.settled; });
  CHECK(rest->step == 3);
  REQUIRE(p->push(plain(Action::set, 0.5, 1)).ok());
  const auto again = wait_for(*p, [](const Shown& s) { return s.settled && s.step > 3; });
  CHECK(again->step == 4);
}

TEST_CASE("a speed that there is not is refused; a stop ends at once") {
  auto p = start(true);
  CHECK_FALSE(p->push(plain(Action::speed, 0)).ok());
  CHECK_FALSE(p->push(plain(Action::speed, -1)).ok());
  CHECK_FALSE(p->push(plain(Action::speed, 1e6)).ok());
  REQUIRE(p->stop().ok());
  CHECK(p->over());
  const auto after = p->latest();
  CHECK(p->wait(after->number, true, milliseconds(60000))->number == after->number);
}

TEST_CASE("rates are those of the last second") {
  Tempo tempo;
  Tempo::Clock::time_point now{};
  for (int i = 0; i < 100; ++i) tempo.step(now += milliseconds(20), 0.005, 0.01);
  CHECK(tempo.step_ms() == Approx(5));
  CHECK(tempo.per_s(now) == Approx(50).epsilon(0.1));
  CHECK(tempo.factor(now) == Approx(0.5).epsilon(0.1));
  // Where nothing comes any more, the rate falls.
  CHECK(tempo.per_s(now + std::chrono::seconds(4)) < 12);
}

TEST_CASE("in turns of the caller a player does what it does in a thread, and never waits") {
  const Overrides moving = {"analysis.type=dynamic", "analysis.steps=10", "analysis.duration=0.2"};
  auto threaded = start(false, moving);
  auto made = Player::start(test::small_scene(moving), {}, false, Player::Drive::caller);
  REQUIRE(made.ok());
  Player& p = *made.value();
  CHECK(p.latest()->step == 0);
  // Nothing is due, and it is said for how long.
  p.wait(0, false, milliseconds(0));
  while (p.turn() <= Player::Clock::now()) {
  }
  for (int step = 1; step <= 3; ++step) {
    REQUIRE(threaded->push(plain(Action::step)).ok());
    REQUIRE(p.push(plain(Action::step)).ok());
    const auto before = std::chrono::steady_clock::now();
    CHECK(p.wait(p.latest()->number, false, std::chrono::seconds(60))->step == step - 1);
    CHECK(std::chrono::steady_clock::now() - before < std::chrono::seconds(30));
    while (p.latest()->step < step) p.turn();
    const auto other = wait_for(*threaded, [&](const Shown& s) { return s.step == step; });
    CHECK(p.latest()->hash == other->hash);
  }
  p.wait(0, true, milliseconds(0));
  p.turn();
  CHECK(p.wait(0, true, milliseconds(0))->values != nullptr);
  REQUIRE(p.push(plain(Action::reset)).ok());
  while (p.latest()->step > 0) p.turn();
  CHECK(p.latest()->hash == start(false, moving)->latest()->hash);
  REQUIRE(p.stop().ok());
  CHECK(p.turn() == Player::Clock::time_point::max());
}
