// Walls that are too thin for their elements are told of, and no others.
#include "scenes/thin_walls.h"

#include <cmath>
#include <numbers>

#include "catch.h"
#include "scenes/library.h"
#include "scenes/run/run.h"
#include "small_scene.h"
#include "support/meshes.h"

using namespace isochor;

namespace {

double share_of(const SceneDef& scene) {
  auto built = build(scene);
  INFO((built ? std::string() : built.error()));
  REQUIRE(built.ok());
  return share_without_inside(built.value().world.mesh(built.value().bodies[0]), scene.dirichlet);
}

bool told(const SceneDef& scene) {
  auto built = build(scene);
  REQUIRE(built.ok());
  return !thin_walls(scene, built.value()).empty();
}

// A tube of radius 1 with so many cells through its wall; open at both ends.
Mesh tube_of(int across, double thickness) {
  Mesh mesh = ::test::box({across, 24, 8}, {thickness, 1, 2});
  for (Vec3& x : mesh.nodes) {
    const double r = 1 - thickness + x.x, angle = 1.5 * std::numbers::pi * x.y;
    x = {r * std::cos(angle), r * std::sin(angle), x.z};
  }
  return mesh;
}

}  // namespace

TEST_CASE("library scenes with thin walls are told of, plane strain and thick bodies are not") {
  for (SceneDef (*make)(const SceneVariant&) : {finger, bellows, spine}) {
    const SceneDef scene = make({});
    CAPTURE(scene.name, share_of(scene));
    CHECK(told(scene));
  }
  for (SceneDef (*make)(const SceneVariant&) :
       {thick_tube, cook_plane, thick_sphere, cantilever, torsion, puck}) {
    const SceneDef scene = make({});
    CAPTURE(scene.name, share_of(scene));
    CHECK_FALSE(told(scene));
  }
  SceneVariant better;
  better.element = Element::tet10;
  CHECK_FALSE(told(finger(better)));
}

TEST_CASE("one element across a wall is thin, two are not") {
  CHECK(share_without_inside(tube_of(1, 0.1)) == Approx(1));
  CHECK_FALSE(thin_walls(tube_of(1, 0.1)).empty());
  for (const int across : {2, 3}) {
    CHECK(share_without_inside(tube_of(across, 0.1)) < 0.2);
    CHECK(thin_walls(tube_of(across, 0.1)).empty());
  }
  CHECK(thin_walls(::test::box({8, 1, 1}, {8, 1, 1}, CellType::hex8)).empty());
  CHECK(thin_walls(::test::box({8, 1, 1}, {8, 1, 1}, CellType::tet10)).empty());
}

TEST_CASE("sides that are held along their normal are no surface") {
  const Mesh layer = ::test::box({6, 6, 1}, {6, 6, 1});
  DirichletDef plane;
  plane.where.surfaces = {"z0", "z1"};
  CHECK(share_without_inside(layer) == Approx(1));
  plane.directions = {{1, 0, 0}};
  CHECK(share_without_inside(layer, {plane}) == Approx(1));
  plane.directions = {{0, 0, 2}};
  CHECK(share_without_inside(layer, {plane}) < kThinWallShare);
  plane.directions.clear();
  CHECK(share_without_inside(layer, {plane}) < kThinWallShare);
  DirichletDef by_box;
  by_box.where.boxes = {{Vec3{-1, -1, -0.1}, Vec3{7, 7, 0.1}}, {Vec3{-1, -1, 0.9}, Vec3{7, 7, 1.1}}};
  CHECK(share_without_inside(layer, {by_box}) < kThinWallShare);
  DirichletDef half;
  half.where.surfaces = {"z0"};
  CHECK(share_without_inside(::test::box({6, 6, 1}, {6, 6, 1}), {half}) < 1);
}

TEST_CASE("a run warns of thin walls once, with the remedy") {
  const RunResult r = run_scene(isochor::test::small_scene(), {});
  int count = 0;
  for (const std::string& w : r.warnings) {
    if (w.find("walls with fewer than two elements") == std::string::npos) continue;
    ++count;
    CHECK_THAT(
        w, ContainsSubstring("body \"block\"") && ContainsSubstring("tet10") && ContainsSubstring("--error"));
  }
  CHECK(count == 1);
  CHECK(summary_json(r).find("fewer than two elements") != std::string::npos);
  // Refined once, they are thick enough.
  SceneDef finer = isochor::test::small_scene();
  finer.bodies[0].refine = 2;
  CHECK_FALSE(told(finer));
}
