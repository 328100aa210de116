// Points of cells as weighted sums of nodes.
#include "engine/scene/embedding.h"

#include <cmath>
#include <random>

#include "support/worlds.h"

namespace {

using namespace isochor;

double drawn(std::mt19937& engine) {
  return static_cast<double>(engine() >> 8) / static_cast<double>(1 << 24);
}

}  // namespace

TEST_CASE("points of every kind of cell are where they were asked for, and follow what is linear") {
  for (const CellType type : {CellType::tet4, CellType::hex8}) {
    for (std::uint32_t seed = 1; seed <= 5; ++seed) {
      std::mt19937 engine(seed);
      Mesh mesh = test::block({0, 0, 0}, {1, 0.7, 0.5}, {3, 2, 2}, type);
      for (Vec3& x : mesh.nodes) {
        for (int k = 0; k < 3; ++k) x[k] += 0.06 * (drawn(engine) - 0.5);
      }
      World world = test::make_world(test::static_options());
      const BodyId body = test::add_body(world, mesh, type == CellType::hex8 ? Element::hex8 : Element::tet4,
                                         test::neo_hookean(1e5, 0.3));
      test::hold(world, body, {"x0"});
      (void)body;
      BodyData data;
      data.name = "body";
      data.mesh = mesh;
      data.global_cells = mesh.cells;
      for (int k = 0; k < 50; ++k) {
        // Inside, and a little outside.
        const Vec3 p{-0.05 + 1.1 * drawn(engine), -0.05 + 0.8 * drawn(engine), -0.05 + 0.6 * drawn(engine)};
        const PointInBody e = test::value(embed(data, mesh.nodes, p, "test"));
        double sum = 0;
        for (const double w : e.weight) sum += w;
        CHECK(sum == Approx(1));
        const Vec3 miss = e.at(mesh.nodes) - p;
        CHECK(std::sqrt(dot(miss, miss)) < 1e-12);
      }
      CHECK_FALSE(embed(data, mesh.nodes, {5, 5, 5}, "test"));
    }
  }
}

TEST_CASE("a tie to hexahedra carries a load as one mesh does") {
  const auto tip = [](bool tied) {
    World world = test::make_world(test::static_options());
    const auto material = test::neo_hookean(1e5, 0.3);
    const auto add = [&](double from, double to, int cells, const char* name) {
      const BodyId b =
          test::add_body(world, test::block({from, 0, 0}, {to, 1, 1}, {cells, 2, 2}, CellType::hex8),
                         Element::hex8, material, 1000, name);
      return b;
    };
    const BodyId first = add(0, tied ? 1.0 : 2.0, tied ? 2 : 4, "first");
    test::hold(world, first, {"x0"});
    BodyId last = first;
    if (tied) {
      last = add(1, 2, 2, "second");
      TieDef def;
      def.where.body = last;
      def.where.surfaces = {"x0"};
      def.to = first;
      test::value(world.add(tie(def)));
    }
    test::hold(world, last, {"x1"}, {{0, 0, 1}}, {0, 0, 0.3});
    test::must_advance(world);
    return test::displacement_at(world, last, {2, 0.5, 0.5});
  };
  const Vec3 d = tip(true) - tip(false);
  CHECK(std::sqrt(dot(d, d)) < 1e-9);
}
