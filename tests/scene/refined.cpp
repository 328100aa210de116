// Bodies that a scene refines: the same problem on a finer mesh.
#include <algorithm>
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

TEST_CASE("places are refined one after the other, and numbers cell by cell go with them") {
  SceneDef scene = test::small_scene();
  SceneBody& body = scene.bodies[0];
  for (int c = 0; c < 12; ++c) body.materials[0].stiffness_field.values.push_back(1 + c);
  RefinedPlace box, ball, side, some;
  box.box = {Vec3{-1, -1, -1}, Vec3{1e-9, 2, 2}};
  ball.sphere = SpherePlace{{0, 0, 0}, 1e-9};
  ball.levels = 3;
  side.surfaces = {"x1"};
  some.cells.values = {0, 7};
  body.refine_where = {box, ball, side, some};
  const auto made = make_body(body, ".", "bodies[0]");
  INFO((made ? std::string() : made.error()));
  REQUIRE(made.ok());
  const MadeBody& m = made.value();
  REQUIRE(m.parent.size() == static_cast<std::size_t>(m.def.mesh.cell_count()));
  CHECK(m.def.mesh.cell_count() > 60);
  CHECK(*std::max_element(m.parent.begin(), m.parent.end()) == 11);
  // Volumes of the cells that were there.
  const auto before = make_body(test::small_scene().bodies[0], ".", "bodies[0]");
  std::array<double, 12> was{}, is{};
  const auto add = [](const Mesh& mesh, std::size_t c, double& sum) {
    const auto x = [&](std::size_t a) { return mesh.nodes[static_cast<std::size_t>(mesh.cells[4 * c + a])]; };
    sum += dot(cross(x(1) - x(0), x(2) - x(0)), x(3) - x(0)) / 6;
  };
  for (std::size_t c = 0; c < 12; ++c) add(before.value().def.mesh, c, was[c]);
  for (std::size_t c = 0; c < m.parent.size(); ++c)
    add(m.def.mesh, c, is.at(static_cast<std::size_t>(m.parent[c])));
  for (std::size_t c = 0; c < 12; ++c) CHECK(is[c] == Approx(was[c]));
  CHECK(run_scene(scene, {}).status == RunStatus::converged);
  const auto again = parse_scene(to_json(scene), "again.json", ".");
  INFO((again ? std::string() : again.error()));
  REQUIRE(again.ok());
  CHECK(to_json(again.value()) == to_json(scene));
  CHECK(make_body(again.value().bodies[0], ".", "bodies[0]").value().parent == m.parent);
}

TEST_CASE("places without a cell are bad input") {
  const auto refusal = [](const char* places) {
    const auto scene =
        parse_scene(test::small_text(), "s", ".", {std::string("bodies[0].refine_where=").append(places)});
    if (!scene) return scene.error();
    const RunResult r = run_scene(scene.value(), {});
    CHECK(r.status == RunStatus::bad_input);
    return r.reason;
  };
  CHECK_THAT(refusal("[{}]"), ContainsSubstring("bodies[0].refine_where[0] says nowhere"));
  CHECK_THAT(refusal(R"([{"box":[[5,5,5],[6,6,6]]}])"), ContainsSubstring("bodies[0].refine_where[0]"));
  CHECK_THAT(refusal(R"([{"box":[[1,1,1],[0,2,2]]}])"),
             ContainsSubstring("refine_where[0]") && ContainsSubstring("lower corner first"));
  for (const char* radius : {"0", "-1"}) {
    CHECK_THAT(refusal((R"([{"sphere":{"center":[0,0,0],"radius":)" + std::string(radius) + "}}]").c_str()),
               ContainsSubstring("refine_where[0]") && ContainsSubstring("positive radius"));
  }
  CHECK_THAT(refusal(R"([{"cells":{"values":[0]},"levels":2}])"), ContainsSubstring("levels = 2"));
  CHECK_THAT(refusal(R"([{"regions":"wall"}])"), ContainsSubstring("there is no \"wall\""));
  CHECK_THAT(refusal(R"([{"surfaces":"top"}])"),
             ContainsSubstring("bodies[0].refine_where[0]: the mesh has no surface named \"top\""));
  CHECK_THAT(refusal(R"([{"cells":{"values":[12]}}])"), ContainsSubstring("cells 0 to 11"));
  CHECK_THAT(refusal(R"([{"cells":{"values":[1.5]}}])"), ContainsSubstring("cells[0] = 1.5"));
  CHECK_THAT(refusal(R"([{"cells":{"file":"/nowhere"}}])"), ContainsSubstring("/nowhere"));
  CHECK_THAT(refusal(R"([{"box":[[0,0,0],[1,1,1]],"levels":0}])"), ContainsSubstring("levels"));
  const auto hex = parse_scene(test::small_text(), "s", ".",
                               {"bodies[0].mesh.box.cell_type=hex8", "bodies[0].element=hex8",
                                R"(bodies[0].refine_where=[{"regions":"body"}])"});
  if (hex) {
    const RunResult r = run_scene(hex.value(), {});
    CHECK(r.status == RunStatus::bad_input);
    CHECK_THAT(r.reason, ContainsSubstring("hexahedra"));
  }
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
