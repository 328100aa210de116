// Several viewers, one of whom drives; what is too much, too often or not allowed.
#include "live/hub.h"

#include <cstring>
#include <nlohmann/json.hpp>

#include "catch.h"
#include "live/message.h"
#include "scene/small_scene.h"

using namespace isochor;
using namespace isochor::live;

namespace {

using Clock = Hub::Clock;

std::unique_ptr<Player> player() {
  auto p = Player::start(test::small_scene(), {}, false);
  if (!p) FAIL(p.error());
  return std::move(p).value();
}

std::string join(Hub& hub, Clock::time_point now = Clock::now()) {
  const Answer a = hub.join(now);
  REQUIRE(a.status == 200);
  return nlohmann::json::parse(a.body)["viewer"];
}

nlohmann::json head_of(const Answer& a) {
  REQUIRE(a.status == 200);
  REQUIRE(a.binary);
  std::uint32_t size = 0;
  for (int k = 3; k >= 0; --k)
    size = size << 8 | static_cast<unsigned char>(a.body[static_cast<std::size_t>(k)]);
  REQUIRE(a.body.size() >= 4 + size);
  CHECK(size % 4 == 0);
  return nlohmann::json::parse(a.body.substr(4, size));
}

std::string error_of(const Answer& a) {
  return nlohmann::json::parse(a.body)["error"];
}

}  // namespace

TEST_CASE("the first viewer drives, another one may take over, and the driver's place does not stay empty") {
  auto p = player();
  Hub hub(*p, false);
  const auto now = Clock::now();
  const std::string first = join(hub, now), second = join(hub, now);
  CHECK(hub.command(first, R"({"do": "step"})", now).status == 200);
  const Answer refused = hub.command(second, R"({"do": "step"})", now);
  CHECK(refused.status == 409);
  CHECK(error_of(refused).find("take over") != std::string::npos);
  CHECK(hub.command(second, R"({"do": "take"})", now).status == 200);
  CHECK(hub.command(first, R"({"do": "step"})", now).status == 409);
  CHECK(head_of(hub.picture(second, "0", ""))["drives"] == true);
  CHECK(head_of(hub.picture(first, "0", ""))["drives"] == false);
  CHECK(head_of(hub.picture(first, "0", ""))["viewers"] == 2);
  // The driver goes, and the next one who does something drives.
  CHECK(hub.leave(second).status == 200);
  CHECK(hub.leave(second).status == 410);
  CHECK(hub.command(first, R"({"do": "step"})", now).status == 200);
  const std::string third = join(hub, now);
  CHECK(hub.command(third, R"({"do": "take"})", now).status == 200);
  // The driver is silent for long.
  const auto later = now + std::chrono::seconds(20);
  (void)hub.scene(first, later);
  CHECK(hub.command(first, R"({"do": "step"})", later).status == 200);
  CHECK(hub.command(third, R"({"do": "step"})", later).status == 410);
}

TEST_CASE(
    "pictures tell how far points have moved, also where that is less than a float has of their place") {
  for (const double load : {100.0, 1e-8}) {
    // A thousand lengths from the origin, where a float counts in steps of 1e-4.
    auto scene = test::small_scene({"bodies[0].mesh.box.lower=[2000, 0, 0]",
                                    "bodies[0].mesh.box.upper=[2002, 1, 1]", "probes=[]", "metrics=[]"});
    scene.tractions[0].traction.x = load;
    auto made = Simulation::make(scene, {});
    REQUIRE(made.ok());
    Simulation& s = *made.value();
    for (int i = 0; i < 3; ++i) REQUIRE(s.advance() == StepEnd::done);
    Shown shown;
    static_cast<Picture&>(shown) = s.picture(false);
    const std::string message = picture_message(s, shown, {}, {});
    const Answer answer{200, message, true};
    REQUIRE(head_of(answer)["vertices"] == s.shape().rest.size());
    std::uint32_t head = 0;
    std::memcpy(&head, message.data(), 4);
    double most = 0;
    for (std::size_t v = 0; v < s.shape().rest.size(); ++v) {
      for (int k = 0; k < 3; ++k) {
        float got = 0;
        std::memcpy(&got, message.data() + 4 + head + 4 * (3 * v + static_cast<std::size_t>(k)), 4);
        const double moved = shown.frame.positions[v][k] - s.shape().rest[v][k];
        CHECK(static_cast<double>(got) == Approx(moved).epsilon(1e-6).margin(1e-30));
        most = std::max(most, std::abs(moved));
      }
    }
    CHECK(most > 1e-4 * load);
  }
}

TEST_CASE("who only looks on changes nothing") {
  auto p = player();
  Hub hub(*p, true);
  const std::string viewer = join(hub);
  for (const char* text : {R"({"do": "play"})", R"({"do": "take"})", R"({"do": "reset"})"})
    CHECK(hub.command(viewer, text, Clock::now()).status == 403);
  CHECK(head_of(hub.scene(viewer, Clock::now()))["readonly"] == true);
  CHECK(head_of(hub.picture(viewer, "0", ""))["drives"] == false);
  CHECK(hub.refused() == 3);
}

TEST_CASE("strangers, nonsense and floods are refused with a sentence and counted") {
  auto p = player();
  Hub hub(*p, false);
  CHECK(hub.command("nobody", R"({"do": "play"})", Clock::now()).status == 410);
  CHECK(hub.picture("nobody", "0", "").status == 410);
  CHECK(hub.scene("", Clock::now()).status == 410);
  const std::string viewer = join(hub);
  CHECK(hub.command(viewer, "{", Clock::now()).status == 400);
  for (const char* after : {"", "-1", "x", "1 ", "99999999999999999999999"})
    CHECK(hub.picture(viewer, after, "").status == 400);
  CHECK(hub.refused() == 9);
  int let_through = 0;
  const auto now = Clock::now();
  for (int i = 0; i < 2000; ++i) {
    const Answer a = hub.command(viewer, R"({"do": "pause"})", now);
    if (a.status == 200)
      ++let_through;
    else
      CHECK(a.status == 429);
  }
  CHECK(let_through <= 400);
  for (std::size_t i = 1; i < Hub::most_viewers; ++i) join(hub);
  CHECK(hub.join(Clock::now()).status == 503);
}

TEST_CASE("a picture has the numbers that its head counts, and the field that was asked for") {
  auto p = player();
  Hub hub(*p, false);
  const std::string viewer = join(hub);
  const Answer scene = hub.scene(viewer, Clock::now());
  const auto head = head_of(scene);
  CHECK(head["dials"].size() == p->simulation().dials().size());
  for (const auto& f : head["fields"]) {
    const std::string name = f["name"];
    const Answer a = hub.picture(viewer, "0", name);
    const auto h = head_of(a);
    INFO(name);
    if (is_computed(p->simulation(), name)) {
      CHECK(h["field"] == name);
      CHECK(h["values"] == h["vertices"]);
    } else {
      CHECK(h["field"].is_null());
    }
    std::size_t json = 0;
    for (int k = 3; k >= 0; --k)
      json = json << 8 | static_cast<unsigned char>(a.body[static_cast<std::size_t>(k)]);
    std::size_t points =
        h["vertices"].get<std::size_t>() + h["probes"].get<std::size_t>() + h["contacts"].get<std::size_t>();
    for (const auto& n : h["lines"]) points += n.get<std::size_t>();
    CHECK(a.body.size() == 4 + json + 12 * points + 4 * h["values"].get<std::size_t>());
  }
  CHECK(head_of(hub.picture(viewer, "0", "../../etc/passwd"))["field"].is_null());
}

TEST_CASE("forces and fibers come to who asks for them, and nothing else is told by the word") {
  auto made = Player::start(
      test::small_scene({R"(contacts=[{"name": "table", "obstacle": {"position": [0, 0, -1e-3]}}])",
                         R"(bodies[0].materials[0].fibers=[{"direction": [1, 0, 0], "k1": 10}])",
                         "tractions[0].traction=[0,0,-20]", "metrics=[]"}),
      {}, true);
  if (!made) FAIL(made.error());
  auto& p = made.value();
  while (!p->latest()->settled) (void)p->wait(p->latest()->number, false, std::chrono::milliseconds(100));
  Hub hub(*p, false);
  const std::string viewer = join(hub);
  const auto scene = head_of(hub.scene(viewer, Clock::now()));
  CHECK(scene["forces"] == true);
  CHECK(scene["fibers"] == true);
  const auto points = [&](const std::string& wants) {
    const Answer a = hub.picture(viewer, "0", "", wants);
    const auto h = head_of(a);
    std::size_t json = 0;
    for (int k = 3; k >= 0; --k)
      json = json << 8 | static_cast<unsigned char>(a.body[static_cast<std::size_t>(k)]);
    const auto count = [&](const char* key) { return h[key].get<std::size_t>(); };
    CHECK(a.body.size() == 4 + json +
                               12 * (count("vertices") + count("probes") + count("contacts") +
                                     3 * count("forces") + count("fibers")));
    return std::pair(count("forces"), count("fibers"));
  };
  const auto [forces, fibers] = points("forces,fibers");
  CHECK(forces > 0);
  CHECK(fibers > 0);
  CHECK(points("forces") == std::pair(forces, std::size_t{0}));
  CHECK(points("fibers") == std::pair(std::size_t{0}, fibers));
  for (const char* other : {"", "force", "forces.fibers", ",,", "FORCES"})
    CHECK(points(other) == std::pair(std::size_t{0}, std::size_t{0}));
}
