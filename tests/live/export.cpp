// A scene as one page: what it carries, what it says of this machine (nothing), and what it cannot carry.
#include "live/export.h"

#include <nlohmann/json.hpp>

#include "catch.h"
#include "live_page.h"
#include "scene/small_scene.h"

using namespace isochor;
using namespace isochor::live;

namespace {

void write(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

// One tetrahedron, in a file of a name that must not come through as it is.
const char* const kMesh = R"($MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
4
1 0 0 0
2 1 0 0
3 0 1 0
4 0 0 1
$EndNodes
$Elements
2
1 2 2 1 1 1 2 3
2 4 2 2 2 1 2 3 4
$EndElements
)";

SceneDef scene_of(const std::string& file, const std::string& folder) {
  auto scene = parse_scene(R"({"name": "one", "bodies": [{"name": "tet", "mesh": {"file": ")" + file + R"("},
    "materials": [{"young": 1000, "poisson": 0.5}]}], "analysis": {"type": "dynamic", "steps": 3}})",
                           "one.json", folder);
  if (!scene) FAIL(scene.error());
  return scene.value();
}

// In the place of what Emscripten makes: a page is put together of any bytes.
ExportOptions engine_in(const test::Scratch& scratch) {
  write(scratch / "isochor_live_engine.js", "// loader");
  write(scratch / "isochor_live_engine.wasm", "module");
  ExportOptions options;
  options.engine = scratch.string();
  return options;
}

}  // namespace

TEST_CASE("a page without an engine is refused with the way to one") {
  const test::Scratch scratch("export");
  ExportOptions options;
  options.engine = scratch.string();
  const auto page = export_page(test::small_scene(), options);
  REQUIRE(!page.ok());
  CHECK(page.error().find(scratch.string()) != std::string::npos);
  CHECK(page.error().find("live/wasm/build.sh") != std::string::npos);
}

TEST_CASE("a page carries scene, mesh and engine, and not where they were") {
  if (live_page().empty()) return;  // node or npm was missing at build time
  const test::Scratch scratch("export");
  std::filesystem::create_directories(scratch / "of somebody");
  write(scratch / "of somebody" / "a \"mesh\".msh", kMesh);
  const auto page =
      export_page(scene_of("of somebody/a \\\"mesh\\\".msh", scratch.string()), engine_in(scratch));
  INFO((page ? "" : page.error()));
  REQUIRE(page.ok());
  const std::string& html = page.value();
  for (const char* part : {"class=\"isochor-loader\"", "class=\"isochor-engine\" data-name=\"playing\"",
                           "class=\"isochor-scene\"", "data-name=\"0_a__mesh_.msh\""}) {
    INFO(part);
    CHECK(html.find(part) != std::string::npos);
  }
  CHECK(html.find("of somebody") == std::string::npos);
  CHECK(html.find(scratch.string()) == std::string::npos);
  ExportOptions paused = engine_in(scratch);
  paused.playing = false;
  CHECK(export_page(test::small_scene(), paused).value().find("data-name=\"paused\"") != std::string::npos);
}

TEST_CASE("files that are missing, or that pages cannot read, are refused before there is a page") {
  const test::Scratch scratch("export");
  const ExportOptions options = engine_in(scratch);
  const auto missing = export_page(scene_of("gone.msh", scratch.string()), options);
  REQUIRE(!missing.ok());
  CHECK(missing.error() == (scratch / "gone.msh").string() + ": cannot be read; check the path");
  write(scratch / "grid.vtu", "<VTKFile type=\"UnstructuredGrid\"/>");
  write(scratch / "grid.node", "4 3 0 0");
  for (const char* name : {"grid.vtu", "grid.node"}) {
    const auto foreign = export_page(scene_of(name, scratch.string()), options);
    REQUIRE(!foreign.ok());
    CHECK(foreign.error().find((scratch / name).string()) == 0);
    CHECK(foreign.error().find(".msh") != std::string::npos);
  }
  write(scratch / "broken.msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n");
  CHECK(!export_page(scene_of("broken.msh", scratch.string()), options).ok());
}
