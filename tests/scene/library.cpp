// Every scene of the library: as a program and as a file it is the same scene.
#include "scenes/library.h"

#include "catch.h"
#include "small_scene.h"

using namespace isochor;

namespace {

SceneDef from_file(std::string_view name) {
  auto scene = read_scene_file(std::string(ISOCHOR_SCENES "/files/").append(name).append(".json"));
  INFO((scene ? std::string() : scene.error()));
  REQUIRE(scene.ok());
  return std::move(scene).value();
}

// Paths differ, since they start at different folders.
std::string text_without_path(SceneDef scene) {
  for (auto& body : scene.bodies) {
    if (auto* file = std::get_if<MeshFile>(&body.mesh)) {
      file->path = file->path.substr(file->path.rfind('/') + 1);
    }
    if (auto* lattice = std::get_if<LatticeMesh>(&body.mesh)) {
      lattice->surface = lattice->surface.substr(lattice->surface.rfind('/') + 1);
    }
  }
  return to_json(scene);
}

}  // namespace

TEST_CASE("program and file say the same") {
  for (const LibraryScene& s : scene_library()) {
    INFO(std::string(s.name));
    const SceneDef program = s.make({});
    CHECK(program.name == s.name);
    CHECK(text_without_path(program) == text_without_path(from_file(s.name)));
    CHECK_FALSE(program.title.empty());
    CHECK_FALSE(program.metrics.empty());
  }
}

TEST_CASE("a scene written and read again is written the same") {
  for (const LibraryScene& s : scene_library()) {
    const std::string text = to_json(s.make({}));
    auto again = parse_scene(text, "again.json", scenes_folder());
    REQUIRE(again.ok());
    CHECK(to_json(again.value()) == text);
  }
}

TEST_CASE("a quantity with a former name is written by the present one") {
  const SceneDef scene = test::small_scene({R"(metrics=[{"name": "kept", "quantity": "volume_error"}])"});
  CHECK_THAT(to_json(scene), Catch::Matchers::Contains("\"volume_row_residual\""));
}

TEST_CASE("program and file give the same bits after a step") {
  for (const char* name : {"tube", "cook_plane", "spine"}) {
    INFO(name);
    auto program = build(find_scene(name)->make({}));
    auto file = build(from_file(name));
    REQUIRE(program.ok());
    REQUIRE(file.ok());
    const double h = plan_steps(find_scene(name)->make({}).analysis).h;
    CHECK(program.value().world.advance(h).status == StepStatus::converged);
    CHECK(file.value().world.advance(h).status == StepStatus::converged);
    CHECK(program.value().world.state_hash() == file.value().world.state_hash());
  }
}

TEST_CASE("every scene of the library builds") {
  for (const LibraryScene& s : scene_library()) {
    auto built = build(s.make({}));
    INFO(std::string(s.name) << ": " << (built ? std::string() : built.error()));
    CHECK(built.ok());
  }
}

TEST_CASE("a variant changes element and mesh") {
  SceneVariant v;
  v.element = Element::tet10;
  const SceneDef s = thick_tube(v);
  CHECK(std::get<MeshFile>(s.bodies[0].mesh).path == "meshes/thick_tube_tet10.msh");
  v.mesh = "cantilever_1_tet10";
  CHECK(std::get<MeshFile>(cantilever(v).bodies[0].mesh).path == "meshes/cantilever_1_tet10.msh");
}
