#include "chart_page.h"

#include <string_view>

#include "page_encoding.h"
#include "results_template.h"

namespace isochor {

Result<std::string> chart_page(const std::string& title, const std::string& json) {
  static constexpr std::string_view title_mark = "<!--ISOCHOR-TITLE-->";
  static constexpr std::string_view data_mark = "<!--ISOCHOR-DATA-->";
  std::string html = page::charts_template();
  if (html.empty()) return Error{"no page: node and npm were missing when Isochor was built"};
  const std::size_t title_at = html.find(title_mark);
  if (title_at == std::string::npos) return Error{"the built-in page is damaged; rebuild Isochor"};
  html.replace(title_at, title_mark.size(), page::escape_html(title));
  const std::size_t data_at = html.find(data_mark);
  if (data_at == std::string::npos) return Error{"the built-in page is damaged; rebuild Isochor"};
  // No text inside may end the element that carries it.
  std::string safe;
  safe.reserve(json.size());
  for (std::size_t i = 0; i < json.size(); ++i) {
    if (json[i] == '<')
      safe += "\\u003c";
    else
      safe += json[i];
  }
  html.replace(data_at, data_mark.size(),
               "<script type=\"application/json\" id=\"isochor-charts\">" + safe + "</script>\n");
  return html;
}

}  // namespace isochor
