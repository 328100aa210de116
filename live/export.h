// A scene as one page that runs it in the browser of whoever opens it, without a server.
#pragma once

#include <string>

#include "scenes/scene.h"

namespace isochor::live {

struct ExportOptions {
  // Of the engine as WebAssembly, which live/wasm/build.sh makes; empty: $ISOCHOR_LIVE_WASM, or where the
  // script puts it.
  std::string engine;
  bool playing = true;
};

// The HTML. The scene goes with the files that it names, and is built once from them, so that what a page
// could not open is refused here.
Result<std::string> export_page(const SceneDef& scene, const ExportOptions& options);

}  // namespace isochor::live
