// Bodies that a scene refines: the same problem on a finer mesh.
#include <cmath>

#include "catch.h"
#include "scenes/body_parts.h"
#include "scenes/library.h"
#include "scenes/run/run.h"
#include "scenes/scene_file.h"
#include "small_scene.h"

using namespace isochor;

namespace {

double first_metric_error(const SceneDef& scene) {
  const RunResult r = run_scene(scene, {});
  INFO(r.reason);
  REQUIRE(r.status == RunStatus::converged);
  return r.metrics[0].value / *r.metrics[0].def.reference - 1;
}

}  // namespace

TEST_CASE("refined meshes converge to the reference with the order of the element") {
  SceneVariant v;
  v.mesh = "cook_plane_grid_1";
  for (const auto& [element, least] : {std::pair{Element::tet4, 0.7}, {Element::tet4_edge_smoothed, 0.9}}) {
    v.element = element;
    double error[3];
    for (int level = 0; level < 3; ++level) {
      SceneDef scene = cook_plane(v);
      scene.bodies[0].refine = level;
      error[level] = std::abs(first_metric_error(scene));
    }
    const double order = std::log2(error[0] / error[2]) / 2;
    CAPTURE(static_cast<int>(element), error[0], error[1], error[2], order);
    CHECK(order > least);
  }
}

TEST_CASE("a refined box is the scene with twice the divisions") {
  const RunResult by_key = run_scene(test::small_scene({"bodies[0].refine=1"}), {});
  const RunResult by_box = run_scene(test::small_scene({"bodies[0].mesh.box.divisions=[4,2,2]"}), {});
  REQUIRE(by_key.status == RunStatus::converged);
  CHECK(by_key.elements == by_box.elements);
  CHECK(by_key.size.displacement_unknowns == by_box.size.displacement_unknowns);
  CHECK(by_key.metrics[0].value == Approx(by_box.metrics[0].value).epsilon(1e-7));
}

TEST_CASE("surfaces chosen by place and numbers cell by cell go with the cells") {
  SceneDef scene = test::small_scene();
  SceneBody& body = scene.bodies[0];
  MeshSelection top;
  top.name = "top";
  top.plane = PlanePlace{{0, 0, 1}, {0, 0, 1}};
  body.surfaces = {top};
  for (int c = 0; c < 12; ++c) body.materials[0].stiffness_field.values.push_back(1 + c);
  body.refine = 1;
  const auto made = make_body(body, ".", "bodies[0]");
  INFO((made ? std::string() : made.error()));
  REQUIRE(made.ok());
  const Mesh& mesh = made.value().def.mesh;
  CHECK(mesh.cell_count() == 96);
  REQUIRE(mesh.surfaces.back().name == "top");
  CHECK(mesh.surfaces.back().faces.size() == 3 * 4 * 4);
  CHECK(run_scene(scene, {}).status == RunStatus::converged);
  // As it was written, so it is read.
  const auto again = parse_scene(to_json(scene), "again.json", ".");
  REQUIRE(again.ok());
  CHECK(again.value().bodies[0].refine == 1);
}

TEST_CASE("what cannot be refined is bad input") {
  SceneDef lattice = finger_lattice({});
  lattice.bodies[0].refine = 1;
  const RunResult r = run_scene(lattice, {});
  CHECK(r.status == RunStatus::bad_input);
  CHECK_THAT(r.reason, ContainsSubstring("bodies[0].refine = 1") && ContainsSubstring("spacing"));
  for (const char* value : {"-1", "9"}) {
    const RunResult wrong =
        run_scene(test::small_scene({std::string("bodies[0].refine=").append(value)}), {});
    CHECK(wrong.status == RunStatus::bad_input);
    CHECK_THAT(wrong.reason, ContainsSubstring("bodies[0].refine") && ContainsSubstring("from 0 to 8"));
  }
  CHECK_FALSE(parse_scene(test::small_text(), "s", ".", {"bodies[0].refine=0.5"}).ok());
}
