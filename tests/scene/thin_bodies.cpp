// Thin bodies in scene files: a sheet from a box or a file, its shell, what is refused.
#include <filesystem>

#include "catch.h"
#include "isochor/mesh_io.h"
#include "small_scene.h"

using namespace isochor;

namespace {

std::string sheet(const std::string& body, const std::string& shells) {
  return R"({"name": "sheet", "bodies": [{"name": "s", "element": "tri3", )" + body + R"(}],
    "shells": [)" +
         shells + R"(], "dirichlet": [{"name": "edge", "where": {"node_sets": "x0"}}],
    "gravity": [0, 0, -10], "analysis": {"steps": 1}, "probes": [{"name": "end", "point": [1, 0.4, 0]}],
    "metrics": [{"name": "sag", "of": "end", "component": "z"}]})";
}

const std::string kBox =
    R"("mesh": {"box": {"upper": [1, 1, 0], "divisions": [8, 8, 1], "cell_type": "tri3"}})";
const std::string kShell =
    R"({"young": 1e9, "poisson": 0.3, "thickness": 0.01, "density": 1000, "clamped": {"node_sets": "x0"}})";

std::string outcome(const std::string& text) {
  const auto scene = parse_scene(text, "sheet.json", ".", {});
  if (!scene) return scene.error();
  const auto built = build(scene.value(), {1, nullptr});
  return built ? "built" : built.error();
}

}  // namespace

TEST_CASE("a sheet from a scene file sags as a cantilever plate does, and writes frames") {
  test::Scratch scratch("thin_body");
  auto scene = parse_scene(sheet(kBox, kShell), "sheet.json", ".", {});
  INFO((scene ? std::string() : scene.error()));
  REQUIRE(scene.ok());
  CHECK(to_json(parse_scene(to_json(scene.value()), "again.json", ".", {}).value()) ==
        to_json(scene.value()));
  RunOptions options;
  options.folder = (scratch / "out").string();
  const RunResult r = run_scene(scene.value(), options);
  INFO(r.reason);
  REQUIRE(r.status == RunStatus::converged);
  REQUIRE(r.metrics.size() == 1);
  // rho g t L^4 / (8 D) of a strip, which a plate that is as wide as it is long is close to.
  const double D = 1e9 * 1e-6 / (12 * 0.91), strip = 1000 * 10 * 0.01 / (8 * D);
  CHECK(-r.metrics[0].value == Approx(strip).epsilon(0.1));
  bool frames = false;
  for (const auto& file : std::filesystem::recursive_directory_iterator(scratch / "out")) {
    if (file.path().extension() != ".vtu") continue;
    MeshReadOptions triangles;
    triangles.triangles = true;
    const auto frame = read_mesh(file.path().string(), triangles);
    INFO((frame ? std::string() : frame.error()));
    REQUIRE(frame.ok());
    CHECK(frame.value().cell_count() == 128);
    frames = true;
  }
  CHECK(frames);
}

TEST_CASE("thin bodies that cannot be are refused with place and remedy") {
  CHECK(outcome(sheet(kBox, kShell)) == "built");
  CHECK_THAT(outcome(sheet(kBox, "")), ContainsSubstring("no shell is on it"));
  CHECK_THAT(outcome(sheet(kBox + R"(, "materials": [{"young": 1, "poisson": 0.3}])", kShell)),
             ContainsSubstring("bodies[0].materials: a thin body"));
  CHECK_THAT(outcome(sheet(R"("mesh": {"box": {"cell_type": "tri3"}})", kShell)),
             ContainsSubstring("no axis has the same lower and upper corner"));
  CHECK_THAT(outcome(sheet(R"("mesh": {"file": "none.stl"})", kShell)), ContainsSubstring("none.stl"));
  CHECK(outcome(sheet(kBox + R"(, "refine": 1)", kShell)) == "built");
  std::string solid = sheet(kBox, kShell);
  solid.replace(solid.find("\"tri3\""), 6, "\"tet4\"");
  CHECK_THAT(outcome(solid), ContainsSubstring("materials is empty"));
}
