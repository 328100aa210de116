// view: the results page of a folder.
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "apps/commands.h"
#include "scenes/run/frames_page.h"

namespace isochor::app {

namespace {

bool has_display() {
  const auto set = [](const char* name) {
    const char* value = std::getenv(name);
    return value != nullptr && *value != '\0';
  };
  return set("DISPLAY") || set("WAYLAND_DISPLAY") || set("BROWSER");
}

// Quoted for a shell: a folder may be called anything.
std::string shell_word(const std::string& text) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'')
      out += "'\\''";
    else
      out += c;
  }
  return out + "'";
}

}  // namespace

bool open_in_browser(const std::string& address) {
  if (!has_display()) return false;
  const std::string command = "xdg-open " + shell_word(address) + " >/dev/null 2>&1 &";
  return std::system(command.c_str()) == 0;
}

int view(const ViewArguments& a) {
  std::error_code code;
  if (!std::filesystem::is_directory(a.folder, code)) {
    std::fprintf(stderr, "isochor: view: %s is not a folder; name one that `isochor run` or `study` wrote\n",
                 a.folder.c_str());
    return bad_input;
  }
  std::string page = (std::filesystem::path(a.folder) / "index.html").string();
  if (a.remake || !std::filesystem::exists(page, code)) {
    const auto made = write_frames_page(a.folder);
    if (!made) {
      std::fprintf(stderr, "isochor: view: %s\n", made.error().c_str());
      return bad_input;
    }
    std::printf("%zu frames, %zu elements\n", made.value().frames, made.value().elements);
  }
  std::printf("%s\n", page.c_str());
  if (a.quiet_browser || !has_display()) return success;
  if (!open_in_browser(page))
    std::fprintf(stderr, "isochor: view: no browser could be started; open the file above in one\n");
  return success;
}

}  // namespace isochor::app
