#include "results_page.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <span>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <utility>

#include "page_encoding.h"
#include "results_template.h"

namespace isochor {

using page::append_json;
using page::Box;

struct ResultsRecorder::Content {
  PageScene scene;
  Box rest_box, box;                // box: of rest and all frames
  std::string rest_block;           // compressed
  std::vector<std::string> blocks;  // one a frame
  std::string frames_json;          // what the page knows of a frame before unpacking it
  std::vector<std::string> notes;
  bool has_fibers = false;
  // Not zero for triangles of obstacles and for vertices that only these use; empty without obstacles.
  std::vector<std::uint8_t> skip_triangle, skip_vertex;
};

namespace {

Error refuse(std::string what) {
  return Error{"results page: " + std::move(what)};
}

std::string number(std::size_t n) {
  return std::to_string(n);
}

// Writes {"key":value,...} and [a,b,...] without a library: the page needs six kinds of values.
class Json {
 public:
  explicit Json(std::string& out) : out_(out) {}

  void begin(char bracket) {
    separate();
    out_ += bracket;
    first_ = true;
  }
  void end(char bracket) {
    out_ += bracket;
    first_ = false;
  }
  void key(std::string_view name) {
    separate();
    append_json(out_, name);
    out_ += ':';
    first_ = true;
  }
  void value(double v) {
    separate();
    append_json(out_, v);
  }
  void value(std::string_view text) {
    separate();
    append_json(out_, text);
  }
  void value(bool v) {
    separate();
    out_ += v ? "true" : "false";
  }
  void count(std::size_t n) {
    separate();
    out_ += number(n);
  }
  void raw(std::string_view text) {
    separate();
    out_ += text;
  }
  template <class T>
  void pair(std::string_view name, const T& v) {
    key(name);
    if constexpr (std::is_same_v<T, bool> || std::is_same_v<T, double>) {
      value(v);
    } else {
      value(std::string_view(v));
    }
  }
  void point(const Vec3& p) {
    for (int axis = 0; axis < 3; ++axis) value(p[axis]);
  }

 private:
  void separate() {
    if (!first_) out_ += ',';
    first_ = false;
  }

  std::string& out_;
  bool first_ = true;
};

Result<void> check_indices(std::span<const Index> indices, std::size_t limit, std::string_view what) {
  for (std::size_t i = 0; i < indices.size(); ++i) {
    if (indices[i] < 0 || static_cast<std::size_t>(indices[i]) >= limit) {
      return refuse(std::string(what) + " entry " + number(i) + " is " + std::to_string(indices[i]) +
                    ", but there are only " + number(limit) + " to refer to");
    }
  }
  return {};
}

Result<void> check_scene(const PageScene& scene) {
  if (scene.triangles.size() % 3 != 0) return refuse("triangles must hold 3 vertices each");
  if (scene.cells.size() % 4 != 0) return refuse("cells must hold 4 vertices each");
  if (scene.up != 'y' && scene.up != 'z') return refuse("up must be 'y' or 'z'");
  const std::size_t triangles = scene.triangles.size() / 3;
  const auto one_each = [&](std::size_t size) { return size == 0 || size == triangles; };
  if (!one_each(scene.triangle_part.size()) || !one_each(scene.triangle_edges.size())) {
    return refuse("triangle_part and triangle_edges must be empty or hold one entry a triangle (" +
                  number(triangles) + ")");
  }
  for (std::size_t i = 0; i < scene.rest.size(); ++i) {
    if (!page::finite(scene.rest[i])) return refuse("rest position " + number(i) + " is not finite");
  }
  const std::size_t vertices = scene.rest.size();
  if (auto ok = check_indices(scene.triangles, vertices, "triangles"); !ok) return ok;
  if (auto ok = check_indices(scene.cells, vertices, "cells"); !ok) return ok;
  return check_indices(scene.triangle_part, std::min<std::size_t>(65535, scene.parts.size()),
                       "triangle_part");
}

Result<void> check_frame(const PageFrame& frame, const PageScene& scene) {
  const auto expect = [](std::size_t have, std::size_t want, const std::string& what) -> Result<void> {
    if (have == want) return {};
    return refuse("the frame has " + number(have) + " " + what + ", the scene " + number(want));
  };
  if (!std::isfinite(frame.time)) return refuse("the time of the frame is not finite");
  if (auto ok = expect(frame.positions.size(), scene.rest.size(), "positions"); !ok) return ok;
  if (auto ok = expect(frame.fields.size(), scene.fields.size(), "fields"); !ok) return ok;
  if (auto ok = expect(frame.lines.size(), scene.lines.size(), "lines"); !ok) return ok;
  if (auto ok = expect(frame.probes.size(), scene.probes.size(), "probes"); !ok) return ok;
  for (std::size_t i = 0; i < frame.fields.size(); ++i) {
    const std::size_t want = scene.fields[i].per_triangle ? scene.triangles.size() / 3 : scene.rest.size();
    if (auto ok = expect(frame.fields[i].size(), want, "values of field " + scene.fields[i].name); !ok)
      return ok;
  }
  return {};
}

void mark_obstacles(const PageScene& scene, std::vector<std::uint8_t>& triangle,
                    std::vector<std::uint8_t>& vertex) {
  const auto is_obstacle = [](const PagePart& part) { return part.obstacle; };
  if (std::none_of(scene.parts.begin(), scene.parts.end(), is_obstacle)) return;
  const std::size_t count = scene.triangles.size() / 3;
  triangle.assign(count, 0);
  vertex.assign(scene.rest.size(), 0);
  const auto mark = [&](bool obstacle) {
    for (std::size_t t = 0; t < count; ++t) {
      const Index part = scene.triangle_part.empty() ? 0 : scene.triangle_part[t];
      if (scene.parts[static_cast<std::size_t>(part)].obstacle != obstacle) continue;
      triangle[t] = obstacle;
      for (std::size_t k = 0; k < 3; ++k)
        vertex[static_cast<std::size_t>(scene.triangles[3 * t + k])] = obstacle;
    }
  };
  mark(true);
  mark(false);  // a vertex shared with a body belongs to the body
}

std::vector<std::uint32_t> widen(std::span<const Index> values) {
  return {values.begin(), values.end()};
}

void write_points(page::BlockWriter& block, std::span<const std::uint16_t> codes) {
  const std::size_t count = codes.size() / 3;
  for (std::size_t axis = 0; axis < 3; ++axis) block.integers(codes.subspan(axis * count, count));
}

std::string pack_rest(const PageScene& scene, const Box& box) {
  const std::size_t triangles = scene.triangles.size() / 3;
  page::BlockWriter block;
  write_points(block, page::quantize_points(scene.rest, scene.rest, box));
  block.integers(widen(scene.triangles));
  std::vector<std::uint16_t> part(triangles, 0), edges(triangles, 7);
  std::transform(scene.triangle_part.begin(), scene.triangle_part.end(), part.begin(),
                 [](Index p) { return static_cast<std::uint16_t>(p); });
  std::copy(scene.triangle_edges.begin(), scene.triangle_edges.end(), edges.begin());
  block.integers(part);
  block.integers(edges);
  block.integers(widen(scene.cells));
  return block.packed();
}

// Forces that are not finite are left out.
void pack_arrows(page::BlockWriter& block, const PageFrame& frame) {
  std::vector<Vec3> forces;
  for (const PageForce& f : frame.forces) {
    if (page::finite(f.at) && page::finite(f.normal) && page::finite(f.friction))
      forces.insert(forces.end(), {f.at, f.normal, f.friction});
  }
  block.points(forces);
  block.points(frame.fibers);
}

double largest_force(const PageFrame& frame) {
  double out = 0;
  for (const PageForce& f : frame.forces) {
    for (const Vec3& v : {f.normal, f.friction}) {
      if (page::finite(v)) out = std::max(out, std::sqrt(dot(v, v)));
    }
  }
  return out;
}

void write_box(Json& json, std::string_view name, const Box& box) {
  json.key(name);
  json.begin('[');
  json.point(box.low);
  json.point(box.high);
  json.end(']');
}

void write_entries(Json& json, std::string_view name, const std::vector<PageEntry>& entries) {
  json.key(name);
  json.begin('[');
  for (const PageEntry& entry : entries) {
    json.begin('[');
    json.value(std::string_view(entry.key));
    json.value(std::string_view(entry.value));
    if (!entry.numbers.empty()) {
      json.begin('[');
      for (const double v : entry.numbers) json.value(v);
      json.end(']');
      json.value(std::string_view(entry.unit));
    }
    json.end(']');
  }
  json.end(']');
}

void write_strings(Json& json, std::string_view name, const std::vector<std::string>& texts) {
  json.key(name);
  json.begin('[');
  for (const std::string& text : texts) json.value(std::string_view(text));
  json.end(']');
}

void write_numbers(Json& json, std::string_view name, const std::vector<double>& values) {
  json.key(name);
  json.begin('[');
  for (const double v : values) json.value(v);
  json.end(']');
}

void write_scene(Json& json, const PageScene& scene) {
  json.pair("up", std::string_view(&scene.up, 1));
  json.key("vertices");
  json.count(scene.rest.size());
  json.key("triangles");
  json.count(scene.triangles.size() / 3);
  json.key("cells");
  json.count(scene.cells.size() / 4);
  json.key("fields");
  json.begin('[');
  for (const PageField& field : scene.fields) {
    json.begin('{');
    json.pair("name", field.name);
    json.pair("label", field.label);
    json.pair("unit", field.unit);
    json.pair("place", std::string_view(field.per_triangle ? "triangle" : "vertex"));
    json.pair("diverging", field.diverging);
    json.pair("center", field.center);
    write_strings(json, "categories", field.categories);
    json.end('}');
  }
  json.end(']');
  const auto named = [&](std::string_view key, const auto& items) {
    json.key(key);
    json.begin('[');
    for (const auto& item : items) {
      json.begin('{');
      json.pair("name", item.name);
      json.pair("color", item.color);
      if constexpr (requires { item.obstacle; }) json.pair("obstacle", item.obstacle);
      json.end('}');
    }
    json.end(']');
  };
  named("parts", scene.parts);
  named("lines", scene.lines);
  write_strings(json, "probes", scene.probes);
}

void write_report(Json& json, const PageReport& report) {
  json.pair("title", report.title);
  json.pair("subtitle", report.subtitle);
  json.pair("footer", report.footer);
  write_entries(json, "run", report.run);
  write_entries(json, "summary", report.summary);
  json.key("x");
  json.begin('{');
  json.pair("label", report.x_label);
  json.pair("symbol", report.x_symbol);
  json.pair("unit", report.x_unit);
  json.end('}');
  if (report.section) {
    json.key("section");
    json.begin('{');
    json.pair("axis", std::string_view("xyz").substr(static_cast<std::size_t>(report.section->axis), 1));
    json.key("at");
    json.begin('[');
    json.point(report.section->at);
    json.end(']');
    json.end('}');
  }
  json.key("series");
  json.begin('[');
  for (const PageSeries& series : report.series) {
    json.begin('{');
    json.pair("group", series.group);
    json.pair("name", series.name);
    json.pair("unit", series.unit);
    json.pair("log", series.log);
    write_numbers(json, "x", series.x);
    write_numbers(json, "y", series.y);
    json.end('}');
  }
  json.end(']');
}

// A name beside the target that no other run uses, so that two runs cannot write into one another's file.
std::filesystem::path scratch_name(const std::filesystem::path& target) {
  const auto now = std::chrono::steady_clock::now().time_since_epoch().count();
  std::filesystem::path scratch = target;
  scratch += ".part-" + std::to_string(now);
  return scratch;
}

}  // namespace

ResultsRecorder::ResultsRecorder(std::unique_ptr<Content> content) : content_(std::move(content)) {}
ResultsRecorder::ResultsRecorder(ResultsRecorder&&) noexcept = default;
ResultsRecorder& ResultsRecorder::operator=(ResultsRecorder&&) noexcept = default;
ResultsRecorder::~ResultsRecorder() = default;

Result<ResultsRecorder> ResultsRecorder::start(PageScene scene) {
  if (scene.parts.empty()) scene.parts.emplace_back();
  if (auto ok = check_scene(scene); !ok) return Error{ok.error()};
  auto content = std::make_unique<Content>();
  for (const Vec3& p : scene.rest) content->rest_box.add(p);
  content->box = content->rest_box;
  content->rest_block = pack_rest(scene, content->rest_box);
  if (content->rest_block.empty()) return refuse("out of memory while compressing the mesh");
  mark_obstacles(scene, content->skip_triangle, content->skip_vertex);
  content->scene = std::move(scene);
  return ResultsRecorder(std::move(content));
}

Result<void> ResultsRecorder::append(const PageFrame& frame) {
  Content& content = *content_;
  const PageScene& scene = content.scene;
  if (auto ok = check_frame(frame, scene); !ok) return ok;

  Box box;
  std::size_t lost = 0;
  double displacement = 0;
  for (std::size_t i = 0; i < frame.positions.size(); ++i) {
    const bool good = page::finite(frame.positions[i]);
    box.add(good ? frame.positions[i] : scene.rest[i]);
    if (!good) {
      ++lost;
      continue;
    }
    if (!content.skip_vertex.empty() && content.skip_vertex[i]) continue;
    const Vec3 moved = frame.positions[i] - scene.rest[i];
    displacement = std::max(displacement, std::sqrt(dot(moved, moved)));
  }

  page::BlockWriter block;
  write_points(block, page::quantize_points(frame.positions, scene.rest, box));
  std::string text;
  Json json(text);
  json.begin('{');
  json.pair("time", frame.time);
  json.pair("label", frame.label);
  json.pair("displacement", displacement);
  json.pair("force", largest_force(frame));
  content.has_fibers = content.has_fibers || !frame.fibers.empty();
  write_box(json, "box", box);
  json.key("ranges");
  json.begin('[');
  for (std::size_t i = 0; i < frame.fields.size(); ++i) {
    const auto& skip = scene.fields[i].per_triangle ? content.skip_triangle : content.skip_vertex;
    const page::QuantizedField field = page::quantize_field(frame.fields[i], skip);
    block.integers(field.codes);
    json.begin('[');
    json.value(field.low);
    json.value(field.high);
    json.count(field.invalid);
    for (const page::FieldRange& range : {field.usual, field.middle}) {
      json.value(range.low);
      json.value(range.high);
    }
    json.end(']');
  }
  json.end(']');
  json.end('}');
  for (const std::vector<Vec3>& points : frame.lines) block.points(points);
  block.points(frame.probes);
  block.points(frame.contacts);
  pack_arrows(block, frame);

  std::string packed = block.packed();
  if (packed.empty()) return refuse("out of memory while compressing a frame");
  content.blocks.push_back(std::move(packed));
  if (!content.frames_json.empty()) content.frames_json += ',';
  content.frames_json += text;
  content.box.add(box);
  for (const auto& points : frame.lines) {
    for (const Vec3& p : points) content.box.add(p);
  }
  if (lost > 0) {
    content.notes.push_back("Frame " + number(content.blocks.size()) + ": " + number(lost) + " of " +
                            number(frame.positions.size()) +
                            " positions are not finite; these vertices are drawn at rest.");
  }
  return {};
}

std::size_t ResultsRecorder::frame_count() const {
  return content_->blocks.size();
}

std::size_t ResultsRecorder::stored_bytes() const {
  std::size_t bytes = content_->rest_block.size() + content_->frames_json.size();
  for (const std::string& block : content_->blocks) bytes += block.size();
  return bytes;
}

Result<void> ResultsRecorder::write(const std::string& path, const PageReport& report) const {
  namespace fs = std::filesystem;
  if (!results_page_available())
    return refuse("not built (node and npm were missing when Isochor was built)");
  static constexpr std::string_view title_mark = "<!--ISOCHOR-TITLE-->";
  static constexpr std::string_view data_mark = "<!--ISOCHOR-DATA-->";
  const std::string& html = page::results_template();
  const std::size_t title_at = html.find(title_mark);
  const std::size_t data_at = html.find(data_mark);
  if (title_at == std::string::npos || data_at == std::string::npos || data_at < title_at) {
    return refuse("the built-in template is damaged; rebuild Isochor");
  }

  // A run that diverged has a bad position in every frame: ten such notes say it, a thousand bury it.
  static constexpr std::size_t most_notes = 10;
  std::vector<std::string> notes = report.notes;
  const std::size_t shown = std::min(most_notes, content_->notes.size());
  notes.insert(notes.end(), content_->notes.begin(),
               content_->notes.begin() + static_cast<std::ptrdiff_t>(shown));
  if (shown < content_->notes.size()) {
    notes.push_back("The same holds for " + number(content_->notes.size() - shown) + " later frames.");
  }

  std::string head;
  Json json(head);
  json.begin('{');
  json.key("format");
  json.count(1);
  write_report(json, report);
  write_strings(json, "notes", notes);
  write_scene(json, content_->scene);
  json.pair("fibers", content_->has_fibers);
  write_box(json, "restBox", content_->rest_box);
  json.key("box");
  json.begin('{');
  const auto corner = [&](std::string_view name, const Vec3& p) {
    json.key(name);
    json.begin('[');
    json.point(p);
    json.end(']');
  };
  corner("low", content_->box.low);
  corner("high", content_->box.high);
  json.end('}');
  json.key("frames");
  json.raw("[" + content_->frames_json + "]");
  json.end('}');

  const fs::path target(path);
  const fs::path scratch = scratch_name(target);
  std::error_code failed;
  {
    std::ofstream out(scratch, std::ios::binary | std::ios::trunc);
    const std::string_view view(html);
    out << view.substr(0, title_at) << page::escape_html(report.title)
        << view.substr(title_at + title_mark.size(), data_at - title_at - title_mark.size())
        << "<script type=\"application/json\" id=\"isochor-head\">" << head << "</script>\n";
    const auto put = [&](const std::string& block) {
      out << "<script type=\"text/plain\" class=\"isochor-block\">" << block << "</script>\n";
    };
    put(content_->rest_block);
    for (const std::string& block : content_->blocks) put(block);
    out << view.substr(data_at + data_mark.size());
    out.close();
    if (!out) {
      fs::remove(scratch, failed);
      return refuse("cannot write " + path + " (does the folder exist, is the disk full?)");
    }
  }
  fs::rename(scratch, target, failed);
  if (failed) {
    const std::string reason = failed.message();
    fs::remove(scratch, failed);
    return refuse("cannot replace " + path + ": " + reason);
  }
  return {};
}

Result<void> write_results_page(const std::string& path, const ResultsPage& content) {
  Result<ResultsRecorder> recorder = ResultsRecorder::start(content.scene);
  if (!recorder) return Error{recorder.error()};
  for (const PageFrame& frame : content.frames) {
    if (auto ok = recorder.value().append(frame); !ok) return ok;
  }
  return recorder.value().write(path, content.report);
}

bool results_page_available() {
  return !page::results_template().empty();
}

}  // namespace isochor
