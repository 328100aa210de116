// Obstacles and rigid bodies of a scene that come from files.
#include "scenes/obstacle_files.h"

#include "catch.h"
#include "scenes/library.h"
#include "scenes/run/run_overlays.h"
#include "small_scene.h"

using namespace isochor;

namespace {

const char* kCube =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nv 1 1 1\n"
    "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";

std::string text_with(const std::string& obstacle) {
  return R"({"name": "press",
    "bodies": [{"name": "block", "mesh": {"box": {"upper": [1, 1, 1], "divisions": [2, 2, 2]}},
                "materials": [{"young": 1000, "poisson": 0.5}]}],
    "analysis": {"steps": 1},
    "dirichlet": [{"name": "ground", "where": {"surfaces": "z0"}}],
    "contacts": [{"name": "stamp", "surfaces": "z1", "obstacle": {)" +
         obstacle + R"(, "position": [-0.5, -0.5, 1.01],
      "keyframes": [{"t": 0}, {"t": 1, "position": [0, 0, -0.06]}]}}],
    "metrics": [{"name": "force", "quantity": "contact_force", "of": "stamp", "component": "z"}]})";
}

}  // namespace

TEST_CASE("a stamp from a surface file presses alike as a mesh and as a distance field") {
  const test::Scratch scratch("obstacle_files");
  std::ofstream(scratch / "cube.obj") << kCube;
  double force[2];
  const char* words[] = {R"("shape": "mesh", "file": "cube.obj", "scale": 2)",
                         R"("shape": "distance_field", "file": "cube.obj", "scale": 2, "spacing": 0.1)"};
  for (int k = 0; k < 2; ++k) {
    auto scene = parse_scene(text_with(words[k]), "press.json", scratch.string());
    INFO((scene ? "" : scene.error()));
    REQUIRE(scene);
    // Written and read again, it is the same.
    const auto again = parse_scene(to_json(scene.value()), "again.json", scratch.string());
    REQUIRE(again);
    CHECK(again.value().contacts[0].obstacle.file == "cube.obj");
    CHECK(again.value().contacts[0].obstacle.scale == 2);
    auto built = build(scene.value());
    INFO((built ? "" : built.error()));
    REQUIRE(built);
    REQUIRE(built.value().world.advance(1).status == StepStatus::converged);
    force[k] = 0;
    for (const Gauge& g : built.value().world.gauges()) {
      if (g.effect == "stamp" && g.quantity == "force_z") force[k] = g.value;
    }
    CHECK(force[k] < -10);
    PageScene page;
    RunOverlays overlays;
    RunResult result;
    overlays.start({scene.value(), built.value(), result}, page, {});
    CHECK(page.parts.size() == 1);
    CHECK(page.triangles.size() >= 36);
  }
  CHECK(force[1] == Approx(force[0]).epsilon(2e-3));
}

TEST_CASE("obstacles whose files are wrong are refused with their place in the scene") {
  const test::Scratch scratch("obstacle_files");
  std::ofstream(scratch / "open.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  std::ofstream(scratch / "cube.obj") << kCube;
  const auto why = [&](const std::string& obstacle) {
    auto scene = parse_scene(text_with(obstacle), "press.json", scratch.string());
    if (!scene) return scene.error();
    const auto built = build(scene.value());
    REQUIRE_FALSE(built);
    return built.error();
  };
  const std::string open = why(R"("shape": "mesh", "file": "open.obj")");
  CHECK(open.starts_with("contacts[0].obstacle: "));
  CHECK(open.find("open.obj: the surface is open: 3 edges") != std::string::npos);
  CHECK(why(R"("shape": "mesh", "file": "none.obj")").find("there is no such file") != std::string::npos);
  CHECK(why(R"("shape": "mesh")").find("is a mesh but has no solid") != std::string::npos);
  CHECK(why(R"("shape": "sphere", "radius": 1, "file": "cube.obj")").find("only the shapes mesh and") !=
        std::string::npos);
  CHECK(why(R"("shape": "distance_field", "file": "cube.obj")").find("(a surface needs a spacing)") !=
        std::string::npos);
  CHECK(why(R"("shape": "distance_field", "file": "cube.obj", "spacing": -1)").find("it must be positive") !=
        std::string::npos);
}
