// The page of a study as data: text, diagrams, bars and tables. Written as one self-contained HTML file.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "isochor/types.h"

namespace isochor::studies {

struct Line {
  std::string name;
  std::vector<double> x, y;
  std::vector<std::string> hints = {};  // one a point, shown when it is pointed at
  bool front = false;                   // the Pareto front: drawn as a broad band below the others
  bool dashed = false;                  // a reference or a slope
  bool steps = false;                   // constant between points
};

struct Diagram {
  std::string title, text;
  std::string x, y;  // labels with unit
  bool log_x = false, log_y = false;
  std::vector<Line> lines = {};
};

// Horizontal bars, each cut into named parts.
struct Bar {
  std::string name;
  std::vector<std::pair<std::string, double>> parts;
};
struct Bars {
  std::string title, unit;
  std::vector<Bar> bars;
};

struct Table {
  std::string title;
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;
  std::vector<std::size_t> failed = {};  // rows in red
};

struct Section {
  std::string title, text;
  std::vector<Diagram> diagrams = {};
  std::vector<Bars> bars = {};
  std::vector<Table> tables = {};
};

struct Page {
  std::string title, subtitle, footer;
  std::vector<std::string> notes;  // what the reader must know first
  std::vector<std::pair<std::string, std::string>> run;
  std::vector<Section> sections;
};

std::string page_json(const Page& page);
// The page as HTML; refused where this build has no bundled page.
Result<std::string> page_html(const Page& page);
// The tables as Markdown, for the documentation.
std::string tables_markdown(const std::vector<Section>& sections);

// `digits` significant digits.
std::string text(double value, int digits = 3);

}  // namespace isochor::studies
