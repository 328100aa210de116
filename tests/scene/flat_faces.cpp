// Round bodies with flat faces are told from flat ones.
#include "scenes/flat_faces.h"

#include <cmath>

#include "scenes/library.h"
#include "scenes/run/error_search.h"
#include "support/worlds.h"

using namespace isochor;

namespace {

// A prism over a regular polygon, of tets.
Mesh prism(int sides) {
  Mesh mesh;
  const double turn = 2 * std::acos(-1.0) / sides;
  for (const double z : {0.0, 1.0}) {
    mesh.nodes.push_back({0, 0, z});
    for (int k = 0; k < sides; ++k) mesh.nodes.push_back({std::cos(k * turn), std::sin(k * turn), z});
  }
  const Index up = sides + 1;
  for (Index k = 0; k < sides; ++k) {
    const Index a = 1 + k, b = 1 + (k + 1) % sides;
    for (const auto& cell : {std::array<Index, 4>{0, a, b, up}, std::array<Index, 4>{a, b, up, up + a},
                             std::array<Index, 4>{b, up, up + a, up + b}}) {
      const auto x = [&](int i) {
        return mesh.nodes[static_cast<std::size_t>(cell[static_cast<std::size_t>(i)])];
      };
      const bool right = dot(cross(x(1) - x(0), x(2) - x(0)), x(3) - x(0)) > 0;
      mesh.cells.insert(mesh.cells.end(), {cell[0], cell[right ? 1 : 2], cell[right ? 2 : 1], cell[3]});
    }
  }
  return mesh;
}

}  // namespace

TEST_CASE("the faces of prisms cut off what circles have more") {
  for (const int sides : {12, 20, 48}) {
    INFO(sides << " sides");
    const FlatFaces f = flat_faces(prism(sides));
    const double turn = 2 * std::acos(-1.0) / sides;
    CHECK(f.turn == Approx(turn).epsilon(1e-9));
    CHECK(f.deficit == Approx(1 - std::sin(turn) / turn).epsilon(0.02));
  }
}

TEST_CASE("flat sides and sharp edges cut nothing off") {
  CHECK(flat_faces(test::block({0, 0, 0}, {1, 2, 3}, {2, 3, 1})).deficit == 0);
  CHECK(flat_faces(prism(4)).deficit == 0);
  CHECK(flat_faces(test::block({0, 0, 0}, {1, 1, 1}, {2, 2, 2}, CellType::hex8)).deficit == 0);
  CHECK(flat_faces(test::scene_mesh("cook3d_1")).deficit < 1e-12);
  CHECK(flat_faces(test::scene_mesh("thick_sphere_coarse")).deficit > 0.004);
}

TEST_CASE("a search for an error says what it cannot see") {
  SceneVariant variant;
  variant.mesh = "thick_tube_coarse";
  const SceneDef scene = thick_tube(variant);
  ErrorSearchOptions options;
  options.error = 0.03;
  options.run.threads = 1;
  const ErrorSearch round = search_error(scene, options);
  INFO(round.sentence);
  REQUIRE(round.end == SearchEnd::reached);
  CHECK(round.sentence.find("flat faces turn by up to") != std::string::npos);
}
