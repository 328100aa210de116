#include "studies/page.h"

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "chart_page.h"

namespace isochor::studies {

namespace {

using Json = nlohmann::ordered_json;

// JSON has no NaN: a point that is none is left out of its line.
Json line_json(const Line& line) {
  Json x = Json::array(), y = Json::array(), hints = Json::array();
  for (std::size_t i = 0; i < line.x.size(); ++i) {
    if (!std::isfinite(line.x[i]) || !std::isfinite(line.y[i])) continue;
    x.push_back(line.x[i]);
    y.push_back(line.y[i]);
    if (i < line.hints.size()) hints.push_back(line.hints[i]);
  }
  return {{"name", line.name},
          {"x", x},
          {"y", y},
          {"hints", hints},
          {"front", line.front},
          {"dashed", line.dashed},
          {"steps", line.steps}};
}

Json diagram_json(const Diagram& d) {
  Json lines = Json::array();
  for (const Line& line : d.lines) lines.push_back(line_json(line));
  return {{"title", d.title}, {"text", d.text},  {"x", d.x},      {"y", d.y},
          {"logX", d.log_x},  {"logY", d.log_y}, {"lines", lines}};
}

Json bars_json(const Bars& b) {
  Json bars = Json::array();
  for (const Bar& bar : b.bars) {
    Json parts = Json::array();
    for (const auto& [name, value] : bar.parts) parts.push_back(Json::array({name, value}));
    bars.push_back({{"name", bar.name}, {"parts", parts}});
  }
  return {{"title", b.title}, {"unit", b.unit}, {"bars", bars}};
}

std::string markdown_row(const std::vector<std::string>& cells) {
  std::string line = "|";
  for (const auto& c : cells) line += " " + c + " |";
  return line + "\n";
}

}  // namespace

std::string page_json(const Page& page) {
  Json sections = Json::array();
  for (const Section& s : page.sections) {
    Json section{{"title", s.title}, {"text", s.text}};
    for (const char* key : {"diagrams", "bars", "tables"}) section[key] = Json::array();
    for (const Diagram& d : s.diagrams) section["diagrams"].push_back(diagram_json(d));
    for (const Bars& b : s.bars) section["bars"].push_back(bars_json(b));
    for (const Table& t : s.tables) {
      section["tables"].push_back(
          {{"title", t.title}, {"head", t.head}, {"rows", t.rows}, {"failed", t.failed}});
    }
    sections.push_back(std::move(section));
  }
  Json run = Json::array();
  for (const auto& [key, value] : page.run) run.push_back(Json::array({key, value}));
  const Json j{
      {"title", page.title}, {"subtitle", page.subtitle}, {"footer", page.footer}, {"notes", page.notes},
      {"run", run},          {"sections", sections}};
  return j.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Result<std::string> page_html(const Page& page) {
  return chart_page(page.title, page_json(page));
}

std::string tables_markdown(const std::vector<Section>& sections) {
  std::string out;
  for (const Section& s : sections) {
    for (const Table& t : s.tables) {
      out += "### " + s.title + (t.title.empty() ? "" : ": " + t.title) + "\n\n" + markdown_row(t.head);
      out += markdown_row(std::vector<std::string>(t.head.size(), "---"));
      for (const auto& row : t.rows) out += markdown_row(row);
      out += "\n";
    }
  }
  return out;
}

std::string text(double value, int digits) {
  if (!std::isfinite(value)) return "–";
  char buffer[48];
  std::snprintf(buffer, sizeof buffer, "%.*g", digits, value);
  return buffer;
}

}  // namespace isochor::studies
