#include "live_page.h"

#include <string_view>

#include "results_template.h"

namespace isochor {

std::string live_page() {
  std::string html = page::live_template();
  const auto put = [&html](std::string_view mark, std::string_view text) {
    const std::size_t at = html.find(mark);
    if (at != std::string::npos) html.replace(at, mark.size(), text);
  };
  put("<!--ISOCHOR-TITLE-->", "Isochor live");
  put("<!--ISOCHOR-DATA-->", "");
  return html;
}

}  // namespace isochor
