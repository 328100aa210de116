#include "live_page.h"

#include <cstdint>
#include <string_view>

#include "page_encoding.h"
#include "results_template.h"

namespace isochor {

namespace {

std::string filled(const std::string& title, const std::string& data) {
  std::string html = page::live_template();
  const auto put = [&html](std::string_view mark, std::string_view text) {
    const std::size_t at = html.find(mark);
    if (at != std::string::npos) html.replace(at, mark.size(), text);
  };
  put("<!--ISOCHOR-TITLE-->", page::escape_html(title));
  put("<!--ISOCHOR-DATA-->", data);
  return html;
}

std::string packed(const std::string& bytes) {
  return page::packed({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
}

}  // namespace

std::string live_page() {
  return filled("Isochor live", "");
}

// viewer/web/src/live/engine.js reads it.
std::string live_page(const CarriedScene& carried) {
  bool whole = true;
  std::string data;
  const auto add = [&](const char* id, const std::string& name, const std::string& bytes) {
    const std::string text = packed(bytes);
    whole = whole && !text.empty();
    data += std::string("<script type=\"text/plain\" class=\"") + id + "\" data-name=\"" +
            page::escape_html(name) + "\">" + text + "</script>\n";
  };
  add("isochor-loader", "", carried.loader);
  add("isochor-engine", carried.playing ? "playing" : "paused", carried.engine);
  add("isochor-scene", "", carried.scene);
  for (const auto& [name, bytes] : carried.files) add("isochor-file", name, bytes);
  const std::string html = filled(carried.title + " \u00b7 Isochor live", data);
  return whole ? html : std::string();
}

}  // namespace isochor
