// Messages of viewers to a live scene: what is understood is done to a small world, whatever it is, and the
// next picture of it can be made.
#include <algorithm>
#include <memory>

#include "fuzz/input.h"
#include "live/message.h"
#include "scenes/scene_file.h"

namespace {

using namespace isochor;

const char* const kScene = R"({
  "name": "fuzz",
  "bodies": [{"name": "block", "mesh": {"box": {"upper": [2, 1, 1], "divisions": [1, 1, 1]}},
              "materials": [{"young": 1000, "poisson": 0.5}]}],
  "analysis": {"type": "dynamic", "steps": 10, "duration": 0.5},
  "dirichlet": [{"name": "wall", "where": {"surfaces": "x0"}}],
  "tractions": [{"name": "pull", "surface": "x1", "traction": [100, 0, 0]}],
  "contacts": [{"name": "table", "obstacle": {"position": [0, 0, -0.5]}}]
})";

live::Simulation& simulation() {
  static const std::unique_ptr<live::Simulation> made = [] {
    auto scene = parse_scene(kScene, "fuzz", ".");
    fuzz::require(scene.ok(), "the scene of the target is refused");
    auto s = live::Simulation::make(scene.value(), {1, "", 5, {}});
    fuzz::require(s.ok(), "the scene of the target is not built");
    return std::move(s).value();
  }();
  return *made;
}

}  // namespace

// Lines, a message each.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  live::Simulation& s = simulation();
  live::Command reset;
  reset.action = live::Action::reset;
  fuzz::require(s.apply(reset).ok(), "a reset is refused");
  const std::string text(reinterpret_cast<const char*>(data), size);
  int steps = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const auto command = live::parse_command(std::string_view(text).substr(at, end - at));
    at = end + 1;
    if (!command) {
      fuzz::require_message(command.error());
      continue;
    }
    if (const auto done = s.apply(command.value()); !done) fuzz::require_message(done.error());
    if (command.value().action == live::Action::step && steps++ < 4) (void)s.advance();
  }
  live::Shown shown;
  static_cast<live::Picture&>(shown) = s.picture(true);
  shown.values = std::make_shared<std::vector<std::vector<double>>>(shown.frame.fields);
  fuzz::require(shown.dials.size() == s.dials().size(), "a picture lacks controls");
  fuzz::require(!live::picture_message(s, shown, {"von_mises", true, true}, {}).empty(),
                "a picture is empty");
  return 0;
}
