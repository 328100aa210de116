// Patch test: a boundary that follows an affine map takes the inside with it, for every element and both
// formulations.
#include "numbers/cube.h"

using namespace isochor;
using namespace test;

TEST_CASE("an affine boundary makes an affine body") {
  const double G[3][3] = {{1.15, 0.2, -0.1}, {0.05, 0.9, 0.15}, {-0.1, 0.1, 1.1}};
  const auto map = [&](const Vec3& X) {
    Vec3 x{};
    for (int i = 0; i < 3; ++i) x[i] = G[i][0] * X.x + G[i][1] * X.y + G[i][2] * X.z;
    return x;
  };
  for (const Element element : kAllElements) {
    for (const double nu : {0.0, 0.3, 0.49, 0.4999}) {
      for (const int space : {-1, 0, 1, 2}) {
        INFO(name_of(element) << ", nu = " << nu << ", rows " << space);
        World world = make_world(static_options());
        const BodyId body = add_body(world, uneven_cube(cells_for(element)), element, neo_hookean(1e5, nu));
        if (space >= 0) add_volume(world, body, static_cast<VolumeSpace>(space));
        move_linearly(world, body, {"x0", "x1", "y0", "y1", "z0", "z1"}, {},
                      [&](const Vec3& X) { return map(X) - X; });
        must_advance(world);
        CHECK(distance_from(world, body, map) < 1e-9);
        const BodyFields f = world.fields(body);
        double size = 0;
        for (const double s : f.cell_stress) size = std::max(size, std::abs(s));
        for (std::size_t k = 0; k < 6; ++k) CHECK(stress_error(f, k, f.cell_stress[k]) < 1e-8 * size);
      }
    }
  }
}

// Curved edges inside: the isoparametric map holds all affine motions, whatever the rest shape.
TEST_CASE("an affine boundary makes an affine body of curved Tet10 and bent hexahedra") {
  const auto map = [](const Vec3& X) {
    return Vec3{1.15 * X.x + 0.2 * X.y - 0.1 * X.z, 0.05 * X.x + 0.9 * X.y + 0.15 * X.z,
                -0.1 * X.x + 0.1 * X.y + 1.1 * X.z};
  };
  for (const Element element : {Element::tet10, Element::hex8}) {
    const CellType type = element == Element::hex8 ? CellType::hex8 : CellType::tet10;
    for (const double nu : {0.3, 0.4999}) {
      for (const bool rows : {false, true}) {
        INFO(name_of(element) << ", nu = " << nu << (rows ? ", rows" : ", one field"));
        World world = make_world(static_options());
        const BodyId body =
            add_body(world, mapped(box({2, 2, 2}, {1, 1, 1}, type), wavy), element, neo_hookean(1e5, nu));
        if (rows) add_volume(world, body);
        move_linearly(world, body, {"x0", "x1", "y0", "y1", "z0", "z1"}, {},
                      [&](const Vec3& X) { return map(X) - X; });
        must_advance(world);
        CHECK(distance_from(world, body, map) < 1e-9);
        // The stress is the same everywhere, in the cells and at the nodes.
        const BodyFields f = world.fields(body);
        double size = 0;
        for (const double s : f.cell_stress) size = std::max(size, std::abs(s));
        for (std::size_t k = 0; k < 6; ++k) {
          CHECK(stress_error(f, k, f.cell_stress[k]) < 1e-8 * size);
          for (std::size_t i = k; i < f.node_stress.size(); i += 6) {
            CHECK(std::abs(f.node_stress[i] - f.cell_stress[k]) < 1e-8 * size);
          }
        }
      }
    }
  }
}
