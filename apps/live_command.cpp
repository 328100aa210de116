// live: a scene that runs in the browser and answers to the hand.
#include <chrono>
#include <cstdio>
#include <thread>

#include "apps/commands.h"
#include "apps/stop.h"
#ifdef ISOCHOR_HAVE_HTTPLIB
#include "live/server.h"
#include "live_page.h"
#include "scenes/run/outputs.h"
#endif

namespace isochor::app {

namespace {

int refuse(Exit code, const std::string& sentence) {
  std::fprintf(stderr, "isochor: live: %s\n", sentence.c_str());
  return code;
}

// Curves over the load factor are then curves over seconds.
void set_in_motion(AnalysisDef& a) {
  if (a.type == AnalysisType::dynamics) return;
  a.type = AnalysisType::dynamics;
  a.path_step.reset();
  a.step = 1.0 / 60;
  a.duration = 60;
}

#ifdef ISOCHOR_HAVE_HTTPLIB

void greet(const LiveArguments& a, const live::Server& server, const SceneDef& scene) {
  std::printf("%s\n", server.link().c_str());
  if (!live::is_loopback(a.host))
    std::fprintf(stderr,
                 "isochor: note: whoever sees the traffic of this network sees the link and may drive; it is "
                 "not encrypted\n");
  if (!a.quiet_browser) {
    const bool started = open_in_browser(server.link());
    if (!started) std::fprintf(stderr, "isochor: note: open the link above in a browser\n");
  }
  std::fprintf(stderr, "isochor: %s runs; Ctrl-C ends it\n", scene.name.c_str());
  std::fflush(stdout);
}

int serve(const LiveArguments& a, const SceneDef& def) {
  live::ServerOptions server_options{a.host, a.port, live_page()};
  if (server_options.page.empty())
    return refuse(unavailable, "this build has no page (node and npm were missing when it was made)");
  stop_on_signals();
  live::SimulationOptions options;
  options.threads = a.threads;
  options.folder = a.folder.empty() ? "out/live_" + def.name : a.folder;
  options.step_limit = a.step_limit;
  // Told here: the first step is too late for whoever looks away then.
  if (a.record) {
    if (auto r = RunOutputs::open(options.folder, def); !r) return refuse(not_written, r.error());
  }
  auto player = live::Player::start(def, options, !a.paused);
  if (!player) return refuse(bad_input, player.error());
  if (a.record) {
    live::Command record;
    record.action = live::Action::record;
    if (auto r = player.value()->push(record); !r) return refuse(internal, r.error());
  }
  live::Hub hub(*player.value(), a.readonly);
  auto server = live::Server::start(hub, server_options);
  if (!server) return refuse(no_port, server.error());
  greet(a, *server.value(), def);
  while (!stop_wanted() && !player.value()->over())
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
  // The player first: viewers that wait for a picture are sent home by it.
  const auto recorded_in = player.value()->latest()->recorded_in;
  const bool by_itself = player.value()->over();
  const auto ended = player.value()->stop();
  server.value()->stop();
  if (!ended) return refuse(by_itself ? out_of_memory : not_written, ended.error());
  if (!recorded_in.empty()) std::fprintf(stderr, "isochor: the recording is in %s/\n", recorded_in.c_str());
  if (hub.refused() > 0)
    std::fprintf(stderr, "isochor: %llu messages were refused\n",
                 static_cast<unsigned long long>(hub.refused()));
  return success;
}

#else

int serve(const LiveArguments&, const SceneDef&) {
  return refuse(unavailable,
                "live is not in this build; install libcpp-httplib-dev, configure anew with "
                "-DISOCHOR_WITH_LIVE=ON and build");
}

#endif

}  // namespace

int live(const LiveArguments& a) {
  auto scene = find_scene_named(a.scene, a.overrides);
  if (!scene) return refuse(bad_input, scene.error());
  if (a.dynamic) set_in_motion(scene.value().analysis);
  return a.export_to.empty() ? serve(a, scene.value()) : export_live(a, scene.value());
}

}  // namespace isochor::app
