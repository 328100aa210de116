// Lattices around surfaces and fields cell by cell, as scene files give them.
#include "scenes/body_parts.h"

#include <cmath>

#include "catch.h"
#include "engine/mesh/boundary.h"
#include "isochor/generate.h"
#include "small_scene.h"

using namespace isochor;
using Catch::Matchers::Contains;

namespace {

// A cube of 1 m whose sides are quadrangles, in both ways of naming corners.
const char* cube_obj() {
  return "# cube\n"
         "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
         "vn 0 0 1\n"
         "f 1 4 3 2\nf 5/1 6/1 7/1 8/1\nf 1//1 2//1 6//1 5//1\nf -7 -6 -2 -3\nf 3 4 8 7\nf 4 1 5 8\n";
}

void write(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path) << text;
}

std::string scene_with(const std::string& mesh, const std::string& material, const char* element = "hex8") {
  return R"({"name": "s", "bodies": [{"name": "b", "mesh": )" + mesh + R"(, "element": ")" + element +
         R"(", "materials": [)" + material + R"(]}], "gravity": [0, -9.8, 0],
         "analysis": {"steps": 1},
         "dirichlet": [{"name": "held", "where": {"boxes": [[[-1, -1, -1], [2, 0.001, 2]]]}}]})";
}

std::string error_of(const test::Scratch& folder, const std::string& text) {
  auto scene = parse_scene(text, "s.json", folder.string());
  if (!scene) return scene.error();
  auto built = build(scene.value());
  return built ? std::string("(none)") : built.error();
}

constexpr const char* kRubber = R"({"young": 1e5, "poisson": 0.45})";

}  // namespace

TEST_CASE("a scene file puts a surface into a lattice, and the surface moves with it") {
  const test::Scratch folder("lattice");
  write(folder / "cube.obj", cube_obj());
  auto scene = parse_scene(scene_with(R"({"lattice": {"surface": "cube.obj", "spacing": 0.25}})", kRubber),
                           "s.json", folder.string());
  INFO((scene ? std::string() : scene.error()));
  REQUIRE(scene.ok());
  auto built = build(scene.value());
  INFO((built ? std::string() : built.error()));
  REQUIRE(built.ok());
  World& world = built.value().world;
  CHECK(world.mesh(BodyId{0}).cell_count() == 64);
  REQUIRE(built.value().surfaces.size() == 1);
  const DisplaySurface& surface = built.value().surfaces[0];
  REQUIRE(surface.points.size() == 8);
  CHECK(surface.triangles.size() == 36);
  REQUIRE(world.advance(1).status == StepStatus::converged);
  // Corners of the cube are nodes of the lattice: they go where the nodes go.
  const auto x = world.positions(BodyId{0}), rest = world.rest_positions(BodyId{0});
  for (const EmbeddedPoint& p : surface.points) {
    Vec3 here{}, start{};
    for (std::size_t a = 0; a < 8; ++a) {
      here += p.weights[a] * x[static_cast<std::size_t>(p.nodes[a])];
      start += p.weights[a] * rest[static_cast<std::size_t>(p.nodes[a])];
    }
    CHECK(std::abs(start.x * (1 - start.x)) < 1e-12);
    if (start.y > 0.5) CHECK(here.y < start.y);
  }
}

TEST_CASE("the boundary of a volume mesh is a surface for a lattice") {
  const Mesh box = box_mesh({{0, 0, 0}, {1, 2, 1}, {2, 4, 2}, CellType::tet10}).value();
  const TriangleSurface s = boundary_of(box);
  // Volume by the divergence theorem: closed, and facing outward.
  double volume = 0;
  for (std::size_t k = 0; k < s.triangles.size(); k += 3) {
    const auto p = [&](std::size_t i) { return s.points[static_cast<std::size_t>(s.triangles[k + i])]; };
    volume += dot(p(0), cross(p(1), p(2))) / 6;
  }
  CHECK(std::abs(volume - 2) < 1e-13);
}

TEST_CASE("what is wrong with a lattice or a surface is named") {
  const test::Scratch folder("lattice_errors");
  write(folder / "cube.obj", cube_obj());
  write(folder / "bad_face.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
  write(folder / "bad_point.obj", "v 0 0\n");
  write(folder / "line.obj", "v 0 0 0\nv 1 0 0\nf 1 2\n");
  write(folder / "empty.obj", "# nothing\n");
  const auto lattice = [&](const std::string& rest, const char* element = "hex8") {
    return error_of(folder, scene_with("{\"lattice\": {" + rest + "}}", kRubber, element));
  };
  CHECK_THAT(lattice(R"("surface": "none.obj", "spacing": 0.5)"), Contains("none.obj"));
  CHECK_THAT(lattice(R"("surface": "bad_face.obj", "spacing": 0.5)"),
             Contains("line 4") && Contains("\"9\""));
  CHECK_THAT(lattice(R"("surface": "bad_point.obj", "spacing": 0.5)"), Contains("line 1"));
  CHECK_THAT(lattice(R"("surface": "line.obj", "spacing": 0.5)"), Contains("2 corners"));
  CHECK_THAT(lattice(R"("surface": "empty.obj", "spacing": 0.5)"), Contains("no faces"));
  CHECK_THAT(lattice(R"("surface": "cube.obj")"), Contains("mesh.lattice.spacing = 0"));
  CHECK_THAT(lattice(R"("surface": "cube.obj", "spacing": 0.5)", "tet4"), Contains("hex8"));
  CHECK_THAT(lattice(R"("surface": "cube.obj", "spacing": 0.5, "scale": -1)"), Contains("scale = -1"));
  CHECK_THAT(error_of(folder, scene_with(R"({"lattice": {"surface": "cube.obj", "spacing": 1}, "scale": 2})",
                                         kRubber)),
             Contains("\"scale\""));
}

TEST_CASE("fields of a scene file are those of a program, in place or from a file") {
  const test::Scratch folder("fields");
  const std::string box = R"({"box": {"divisions": [1, 2, 1], "cell_type": "hex8"}})";
  write(folder / "nu.txt", "0.3 0.5\n");
  const auto top = [&](const std::string& material) {
    auto scene = parse_scene(scene_with(box, material), "s.json", folder.string());
    REQUIRE(scene.ok());
    auto built = build(scene.value());
    INFO((built ? std::string() : built.error()));
    REQUIRE(built.ok());
    REQUIRE(built.value().world.advance(1).status == StepStatus::converged);
    return built.value().world.positions(BodyId{0}).back();
  };
  const Vec3 in_place = top(R"({"young": 1e5, "poisson_field": {"values": [0.3, 0.5]}})");
  CHECK(in_place == top(R"({"young": 1e5, "poisson_field": {"file": "nu.txt"}})"));
  CHECK_FALSE(in_place == top(R"({"young": 1e5, "poisson_field": {"values": [0.3, 0.3]}})"));
  // Equal factors are a stiffer material.
  const Vec3 twice = top(R"({"young": 1e5, "poisson": 0.3, "stiffness_field": {"values": [2, 2]}})");
  const Vec3 stiff = top(R"({"young": 2e5, "poisson": 0.3})");
  CHECK(std::abs(twice.y - stiff.y) < 1e-10);

  const auto refusal = [&](const std::string& material) {
    return error_of(folder, scene_with(box, material));
  };
  write(folder / "words.txt", "0.3 many\n");
  CHECK_THAT(refusal(R"({"young": 1e5, "poisson_field": {"file": "none.txt"}})"), Contains("none.txt"));
  CHECK_THAT(refusal(R"({"young": 1e5, "poisson_field": {"file": "words.txt"}})"),
             Contains("entry 1") && Contains("many"));
  CHECK_THAT(refusal(R"({"young": 1e5, "poisson_field": {"values": [0.3]}})"), Contains("1 entries"));
  CHECK_THAT(refusal(R"({"young": 1e5, "poisson_field": {"values": [0.3, 0.7]}})"),
             Contains("entry 1") && Contains("0.7"));
  CHECK_THAT(refusal(R"({"young": 1e5, "poisson": 0.3, "poisson_field": {"values": [0.3, 0.3]}})"),
             Contains("poisson_field") && Contains("takes its place"));
  CHECK_THAT(refusal(R"({"young": 1e5, "stiffness_field": {"values": [1, 1], "file": "nu.txt"}})"),
             Contains("values and a file"));
}
