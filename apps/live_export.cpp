// live --export: a scene as one page that runs without a server.
#include <cstdio>

#include "apps/commands.h"
#include "live/export.h"
#include "live_page.h"
#include "scenes/run/outputs.h"

namespace isochor::app {

int export_live(const LiveArguments& a, const SceneDef& scene) {
  const auto refuse = [](Exit code, const std::string& sentence) {
    std::fprintf(stderr, "isochor: live: %s\n", sentence.c_str());
    return code;
  };
  if (live_page().empty())
    return refuse(unavailable, "this build has no page (node and npm were missing when it was made)");
  live::ExportOptions options;
  options.playing = !a.paused;
  const auto html = live::export_page(scene, options);
  if (!html)
    return refuse(html.failure().kind == ErrorKind::no_memory ? out_of_memory : bad_input, html.error());
  if (auto r = write_text(a.export_to, html.value()); !r) return refuse(not_written, r.error());
  std::fprintf(stderr, "isochor: %s runs in %s (%.1f MB)\n", scene.name.c_str(), a.export_to.c_str(),
               static_cast<double>(html.value().size()) / 1e6);
  return success;
}

}  // namespace isochor::app
