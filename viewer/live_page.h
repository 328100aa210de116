// The page of scenes that run: it asks the server that it comes from for everything else, or carries it.
#pragma once

#include <map>
#include <string>

namespace isochor {

// Empty where node and npm were missing at build time.
std::string live_page();

// What a page without a server carries.
struct CarriedScene {
  std::string title;
  std::string scene;                         // the text of its file
  std::map<std::string, std::string> files;  // by the names that the scene has for them: without quotes
  bool playing = true;
  std::string loader;  // JavaScript of the worker that runs the engine
  std::string engine;  // its WebAssembly
};

// Likewise; empty where memory runs out as well.
std::string live_page(const CarriedScene& carried);

}  // namespace isochor
