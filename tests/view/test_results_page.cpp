#include <zlib.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "catch.h"
#include "page_encoding.h"
#include "page_surface.h"
#include "results_page.h"

namespace fs = std::filesystem;
using namespace isochor;

namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr double infinite = std::numeric_limits<double>::infinity();

// A folder of its own for each test, removed with everything in it.
struct Folder {
  fs::path path =
      fs::temp_directory_path() / ("isochor-page-" + std::to_string(reinterpret_cast<std::uintptr_t>(this)));
  Folder() { fs::create_directories(path); }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
  std::string file(const std::string& name) const { return (path / name).string(); }
};

std::string read(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::size_t count(std::string_view text, std::string_view what) {
  std::size_t n = 0;
  for (std::size_t at = text.find(what); at != std::string_view::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

// The way back, written apart from the code under test.
std::vector<std::uint8_t> unpack(const std::string& base64, std::size_t size) {
  std::vector<std::uint8_t> packed;
  std::uint32_t bits = 0;
  int have = 0;
  for (const char c : base64) {
    if (c == '=') break;
    const int digit = c == '+'   ? 62
                      : c == '/' ? 63
                      : c <= '9' ? c - '0' + 52
                      : c <= 'Z' ? c - 'A'
                                 : c - 'a' + 26;
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    have += 6;
    if (have >= 8) packed.push_back(static_cast<std::uint8_t>(bits >> (have -= 8)));
  }
  std::vector<std::uint8_t> out(size + 1);
  uLongf length = static_cast<uLongf>(out.size());
  REQUIRE(uncompress(out.data(), &length, packed.data(), static_cast<uLong>(packed.size())) == Z_OK);
  REQUIRE(length == size);
  return out;
}

PageScene tetrahedron() {
  PageScene scene;
  scene.rest = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  scene.triangles = {0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2};
  scene.fields = {{"pressure", "Pressure", "Pa"}, {"zone", "Zone", "", true}};
  scene.probes = {"tip"};
  return scene;
}

PageFrame frame_of(const PageScene& scene) {
  PageFrame frame;
  frame.positions = scene.rest;
  frame.fields = {{1, 2, 3, 4}, {0, 0, 1, 1}};
  frame.probes = {{0, 0, 1}};
  return frame;
}

double enclosed_volume(const PageScene& scene) {
  double six = 0;
  for (std::size_t t = 0; t < scene.triangles.size(); t += 3) {
    const auto at = [&](std::size_t k) {
      return scene.rest[static_cast<std::size_t>(scene.triangles[t + k])];
    };
    six += dot(at(0), cross(at(1), at(2)));
  }
  return six / 6;
}

}  // namespace

TEST_CASE("Integers survive the block encoding", "[view]") {
  const std::vector<std::uint16_t> small = {0, 65535, 1, 300, 299, 0};
  const std::vector<std::uint32_t> large = {7, 4000000000u, 0, 65536};
  page::BlockWriter block;
  block.integers(small);
  block.integers(large);
  const auto bytes = unpack(block.packed(), small.size() * 2 + large.size() * 4);
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < small.size(); ++i) {
    value += bytes[i] + 256u * bytes[small.size() + i];
    CHECK((value & 0xffffu) == small[i]);
  }
  const std::uint8_t* wide = bytes.data() + small.size() * 2;
  value = 0;
  for (std::size_t i = 0; i < large.size(); ++i) {
    for (std::size_t k = 0; k < 4; ++k)
      value += static_cast<std::uint32_t>(wide[k * large.size() + i]) << (8 * k);
    CHECK(value == large[i]);
  }
}

TEST_CASE("Fields keep half a level and mark what is not finite", "[view]") {
  const std::vector<double> values = {-3, not_a_number, 0.123, 5, infinite, 4.9};
  const page::QuantizedField field = page::quantize_field(values);
  CHECK(field.low == -3);
  CHECK(field.high == 5);
  CHECK(field.invalid == 2);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) {
      CHECK(field.codes[i] == page::invalid_code);
      continue;
    }
    const double back = field.low + field.codes[i] * (field.high - field.low) / page::field_levels;
    CHECK(std::abs(back - values[i]) <= 0.5001 * 8 / page::field_levels);
  }

  const page::QuantizedField partial = page::quantize_field(std::vector<double>{1, 50, not_a_number, 2},
                                                            std::vector<std::uint8_t>{0, 1, 1, 0});
  CHECK(partial.high == 2);
  CHECK(partial.invalid == 0);
  CHECK(partial.codes[1] == page::invalid_code);

  const page::QuantizedField constant = page::quantize_field(std::vector<double>{2, 2});
  CHECK(constant.codes == std::vector<std::uint16_t>{0, 0});
  const page::QuantizedField wide = page::quantize_field(std::vector<double>{-1.7e308, 0, 1.7e308});
  CHECK(wide.codes == std::vector<std::uint16_t>{0, 2048, 4095});
  CHECK(std::isnan(page::quantize_field(std::vector<double>{not_a_number}).low));
}

TEST_CASE("Positions keep a 65535th of the box", "[view]") {
  const std::vector<Vec3> rest = {{0, 0, 0}, {1, 1, 0}, {0.5, 0.5, 0}};
  const std::vector<Vec3> now = {{0, 0, 0}, {3, 1, 0}, {not_a_number, 2, 0}};
  page::Box box;
  for (const Vec3& p : now) box.add(p);
  box.add(rest[2]);
  const auto codes = page::quantize_points(now, rest, box);
  CHECK(codes[1] == 65535);
  CHECK(codes[2] == std::lround(65535 * 0.5 / 3));  // the lost point stands at rest
  CHECK(codes[8] == 0);                             // a flat body has no third extent
}

TEST_CASE("Words cannot leave their place in the page", "[view]") {
  std::string out;
  page::append_json(out, std::string_view("</script>\"\\\n µ \xff"));
  CHECK(out == "\"\\u003c/script\\u003e\\u0022\\u005c\\u000a µ \\ufffd\"");
  out.clear();
  page::append_json(out, std::string_view("\xe2\x82"));  // cut in the middle of a sign
  CHECK(out == "\"\\ufffd\\ufffd\"");
  out.clear();
  page::append_json(out, not_a_number);
  page::append_json(out, 0.25);
  CHECK(out == "null0.25");
  CHECK(page::escape_html("a<b>&c") == "a&lt;b&gt;&amp;c");
}

TEST_CASE("Scenes and frames that do not fit are refused by name", "[view]") {
  PageScene scene = tetrahedron();
  scene.triangles[5] = 4;
  auto refused = ResultsRecorder::start(scene);
  REQUIRE(!refused);
  CHECK(refused.error().find("triangles entry 5 is 4") != std::string::npos);

  scene = tetrahedron();
  scene.triangle_part = {0, 0, 0, 1};
  CHECK(!ResultsRecorder::start(scene));
  scene = tetrahedron();
  scene.rest[2].y = infinite;
  CHECK(!ResultsRecorder::start(scene));

  scene = tetrahedron();
  auto recorder = ResultsRecorder::start(scene);
  REQUIRE(recorder);
  PageFrame frame = frame_of(scene);
  frame.fields[1].pop_back();
  const auto bad = recorder.value().append(frame);
  REQUIRE(!bad);
  CHECK(bad.error().find("zone") != std::string::npos);
  CHECK(recorder.value().frame_count() == 0);
  frame = frame_of(scene);
  frame.time = not_a_number;
  CHECK(!recorder.value().append(frame));
  REQUIRE(recorder.value().append(frame_of(scene)));
  CHECK(recorder.value().frame_count() == 1);
}

TEST_CASE("A page is written whole, twice the same, and beside nothing", "[view]") {
  const Folder folder;
  ResultsPage content;
  content.scene = tetrahedron();
  content.report.title = "</title><script>alert(1)</script>";
  content.report.series = {{"Chamber", "Pressure", "Pa", {0, 1}, {not_a_number, 2}},
                           {"Empty", "Nothing", "", {}, {}}};
  content.frames = {frame_of(content.scene), frame_of(content.scene)};
  content.frames[1].time = 0.5;
  content.frames[1].positions[0].x = not_a_number;
  content.frames[1].fields[0][2] = infinite;
  const auto written = write_results_page(folder.file("a.html"), content);
  if (!results_page_available()) {
    CHECK(written.error().find("node") != std::string::npos);
    WARN("The page itself is not checked: this build has none.");
    return;
  }
  REQUIRE(written);
  const std::string html = read(folder.file("a.html"));
  CHECK(count(html, "class=\"isochor-block\"") == 3);
  CHECK(count(html, "id=\"isochor-head\"") == 1);
  CHECK(html.find("alert(1)</script>") == std::string::npos);
  CHECK(html.find("Frame 2: 1 of 4 positions are not finite") != std::string::npos);
  CHECK(html.find("\"ranges\":[[1,4,1,1,4,1,4],[0,1,0,0,1,0,1]]") != std::string::npos);
  CHECK(html.find("<!--ISOCHOR-") == std::string::npos);
  CHECK(html.substr(html.size() - 8) == "</html>\n");

  REQUIRE(write_results_page(folder.file("b.html"), content));
  CHECK(read(folder.file("b.html")) == html);
  REQUIRE(write_results_page(folder.file("b.html"), content));  // over an older page
  CHECK(std::distance(fs::directory_iterator(folder.path), fs::directory_iterator()) == 2);

  const auto nowhere = write_results_page(folder.file("missing/a.html"), content);
  REQUIRE(!nowhere);
  CHECK(nowhere.error().find("missing/a.html") != std::string::npos);
}

TEST_CASE("The usual range of a field is that of 98 or 90 of 100 of its values", "[view]") {
  // Any order, any size: a hundredth is left out at each end, and zeros do not count.
  std::uint32_t random = 1;
  for (const std::size_t size : {1u, 99u, 100u, 1000u, 12345u}) {
    std::vector<double> values;
    for (std::size_t i = 0; i < size; ++i) values.push_back(1 + static_cast<double>(i));
    for (std::size_t i = size; i > 1; --i) {
      random = random * 1664525u + 1013904223u;
      std::swap(values[i - 1], values[random % i]);
    }
    const auto cut = static_cast<double>(size / 100), top = static_cast<double>(size);
    page::QuantizedField field = page::quantize_field(values);
    CHECK(field.usual.low == 1 + cut);
    CHECK(field.usual.high == top - cut);
    CHECK(field.middle.low == 1 + static_cast<double>(size / 20));
    CHECK(field.middle.high == top - static_cast<double>(size / 20));
    values.insert(values.end(), 50 * size, 0.0);
    values.push_back(not_a_number);
    field = page::quantize_field(values);
    CHECK(field.usual.low == 0);
    CHECK(field.usual.high == top - cut);
    CHECK(field.high == top);
  }
  const page::QuantizedField nothing = page::quantize_field(std::vector<double>(20, 0.0));
  CHECK(nothing.usual.low == 0);
  CHECK(nothing.usual.high == 0);
}

TEST_CASE("Obstacles have no say in the ranges", "[view]") {
  const Folder folder;
  PageScene scene = tetrahedron();
  // A table below, sharing one vertex with the body.
  scene.rest.insert(scene.rest.end(), {{5, 0, -1}, {0, 5, -1}});
  scene.triangles.insert(scene.triangles.end(), {0, 4, 5});
  scene.parts = {{"body"}, {"table", "", true}};
  scene.triangle_part = {0, 0, 0, 0, 1};
  auto recorder = ResultsRecorder::start(scene);
  REQUIRE(recorder);
  PageFrame frame = frame_of(scene);
  frame.fields = {{1, 2, 3, 4, not_a_number, 900}, {0, 0, 1, 1, 7}};
  frame.positions[5].z = -50;
  REQUIRE(recorder.value().append(frame));
  if (!results_page_available()) return;
  REQUIRE(recorder.value().write(folder.file("a.html"), {}));
  const std::string html = read(folder.file("a.html"));
  CHECK(html.find("\"displacement\":0,") != std::string::npos);
  CHECK(html.find("\"ranges\":[[1,4,0,1,4,1,4],[0,1,0,0,1,0,1]]") != std::string::npos);
}

TEST_CASE("The surface of a mesh is closed and faces outward", "[view]") {
  Mesh mesh;
  mesh.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  mesh.cells = {0, 1, 2, 3, 1, 2, 3, 4};
  PageScene scene;
  const auto nodes = add_page_mesh(scene, mesh, {"pair", ""});
  CHECK(nodes.size() == 5);
  CHECK(scene.triangles.size() == 6 * 3);
  CHECK(scene.cells.size() == 2 * 4);
  CHECK(enclosed_volume(scene) == Approx(1.0 / 6 + 1.0 / 3));

  SECTION("a second body follows the first") {
    add_page_mesh(scene, mesh, {"copy", ""}, {.cells = false});
    CHECK(scene.rest.size() == 10);
    CHECK(scene.triangle_part.back() == 1);
    CHECK(scene.cells.size() == 2 * 4);
    CHECK(ResultsRecorder::start(scene));
  }
}

TEST_CASE("Six-node faces become four triangles without false edges", "[view]") {
  Mesh mesh;
  mesh.cell_type = CellType::tet10;
  mesh.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  constexpr std::array<std::array<std::size_t, 2>, 6> edges = {
      {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};
  for (const auto& [a, b] : edges) mesh.nodes.push_back(0.5 * (mesh.nodes[a] + mesh.nodes[b]));
  mesh.cells = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9};
  PageScene scene;
  add_page_mesh(scene, mesh, {});
  CHECK(scene.triangles.size() == 16 * 3);
  CHECK(enclosed_volume(scene) == Approx(1.0 / 6));
  double volume = 0;
  for (std::size_t c = 0; c < scene.cells.size(); c += 4) {
    const auto at = [&](std::size_t k) { return scene.rest[static_cast<std::size_t>(scene.cells[c + k])]; };
    const double six = dot(cross(at(1) - at(0), at(2) - at(0)), at(3) - at(0));
    CHECK(six > 0);
    volume += six / 6;
  }
  CHECK(volume == Approx(1.0 / 6));
  // An edge that is shown lies on an edge of the tetrahedron: its middle is a corner and a mid node's mean.
  for (std::size_t t = 0; t < scene.triangles.size() / 3; ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (!(scene.triangle_edges[t] & (1u << k))) continue;
      const auto at = [&](std::size_t c) {
        return scene.rest[static_cast<std::size_t>(scene.triangles[3 * t + c % 3])];
      };
      const auto halves = [](const Vec3& p) {
        int n = 0;
        for (int axis = 0; axis < 3; ++axis) n += p[axis] == 0.5;
        return n;
      };
      CHECK((halves(at(k)) == 0) != (halves(at(k + 1)) == 0));
    }
  }
}
