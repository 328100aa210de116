// A live scene for a page without a server: what live/server.cpp is to HTTP, this is to the worker of the
// page (viewer/web/src/live/engine_worker.js). One scene, one thread, which the worker gives its turns.
#include <emscripten.h>

#include <algorithm>
#include <cstdlib>

#include "live/hub.h"
#include "scenes/scene_file.h"

namespace isochor::live {

namespace {

struct Session {
  explicit Session(std::unique_ptr<Player> p) : player(std::move(p)), hub(*player, false) {}
  std::unique_ptr<Player> player;
  Hub hub;
};

std::unique_ptr<Session> session;
Answer answer;  // the last; the worker reads it before it asks for more

int answered(Answer with) {
  answer = std::move(with);
  return answer.status;
}

}  // namespace

}  // namespace isochor::live

using namespace isochor;
using namespace isochor::live;

extern "C" {

// The scene as the text of a scene file, whose files are in `folder` of the module's own file system.
EMSCRIPTEN_KEEPALIVE int isochor_open(const char* scene_file, const char* folder, int playing) {
  auto scene = parse_scene(scene_file, "the scene of this page", folder);
  if (!scene) return answered({400, error_message(scene.error()), false});
  auto player = Player::start(std::move(scene).value(), {}, playing != 0, Player::Drive::caller);
  if (!player) return answered({400, error_message(player.error()), false});
  session = std::make_unique<Session>(std::move(player).value());
  return answered({200, "{}", false});
}

// Works, where something is due; how long nothing will be [ms]. Negative: it is over, and the answer says
// why.
EMSCRIPTEN_KEEPALIVE double isochor_turn() {
  const auto next = session->player->turn();
  if (session->player->over()) {
    const auto why = session->player->stop();
    answered({500, error_message(why ? "the scene has ended" : why.error()), false});
    return -1;
  }
  const std::chrono::duration<double, std::milli> left = next - Player::Clock::now();
  return std::max(0.0, left.count());
}

// Whether there is a picture after this one, with the field that is asked for.
EMSCRIPTEN_KEEPALIVE int isochor_has_picture(double after, const char* field) {
  const auto number = static_cast<std::uint64_t>(after);
  const bool fields = is_computed(session->player->simulation(), field);
  const ShownPtr shown = session->player->wait(number, fields, std::chrono::milliseconds(0));
  return shown->number > number && (shown->values || !fields);
}

// These give the status that HTTP has for it.
EMSCRIPTEN_KEEPALIVE int isochor_join() {
  return answered(session->hub.join(Hub::Clock::now()));
}
EMSCRIPTEN_KEEPALIVE int isochor_leave(const char* viewer) {
  return answered(session->hub.leave(viewer));
}
EMSCRIPTEN_KEEPALIVE int isochor_scene(const char* viewer) {
  return answered(session->hub.scene(viewer, Hub::Clock::now()));
}
EMSCRIPTEN_KEEPALIVE int isochor_picture(const char* viewer, const char* after, const char* field,
                                         const char* wants) {
  return answered(session->hub.picture(viewer, after, field, wants));
}
EMSCRIPTEN_KEEPALIVE int isochor_command(const char* viewer, const char* text) {
  return answered(session->hub.command(viewer, text, Hub::Clock::now()));
}

EMSCRIPTEN_KEEPALIVE const char* isochor_answer() {
  return answer.body.data();
}
EMSCRIPTEN_KEEPALIVE std::size_t isochor_answer_size() {
  return answer.body.size();
}
}
