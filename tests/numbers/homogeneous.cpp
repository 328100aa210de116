// Homogeneous states through the whole engine, against the closed forms for incompressible neo-Hookean solids
// (mu = 1).
#include "numbers/cube.h"

using namespace isochor;
using namespace test;

namespace {

// Tolerances below those that are tested.
WorldOptions exact_options() {
  WorldOptions options = static_options();
  options.force_tolerance = 1e-12;
  options.row_tolerance = 1e-12;
  return options;
}

// A sliding cube, mu = 1, with one or two faces moved.
struct Cube {
  World world = make_world(exact_options());
  BodyId body{};

  Cube(Element element, const MaterialPtr& material) {
    body = add_body(world, uneven_cube(cells_for(element)), element, material);
    add_volume(world, body);
    slide_on_axes(world, body);
  }
  void stretch(const std::string& face, int axis, double ratio) {
    Vec3 direction{}, move{};
    direction[axis] = 1;
    move[axis] = ratio - 1;
    hold(world, body, {face}, {direction}, move);
  }
};

}  // namespace

TEST_CASE("uniaxial stretch at nu = 0.5") {
  for (const Element element : kAllElements) {
    for (const double stretch : {0.5, 1.25, 2.0, 3.0}) {
      INFO(name_of(element) << ", stretch " << stretch);
      Cube c(element, neo_hookean(3, 0.5));
      c.stretch("x1", 0, stretch);
      must_advance(c.world);
      const double stress = stretch * stretch - 1 / stretch;
      const BodyFields f = c.world.fields(c.body);
      CHECK(stress_error(f, 0, stress) < 1e-9);
      for (const std::size_t other : {1u, 2u, 3u, 4u, 5u}) CHECK(stress_error(f, other, 0) < 1e-9);
      const double w = 1 / std::sqrt(stretch);
      CHECK(distance_from(c.world, c.body, [&](const Vec3& X) {
              return Vec3{stretch * X.x, w * X.y, w * X.z};
            }) < 1e-9);
      for (const double p : f.node_pressure) CHECK(p == Approx(stress / 3).margin(1e-9));
      CHECK(c.world.measures(c.body).volume_error < 1e-10);
    }
  }
}

TEST_CASE("equibiaxial stretch at nu = 0.5") {
  for (const Element element : kAllElements) {
    for (const auto& [stretch, stress] : {std::pair(0.8, -1.80140625), {1.25, 1.1529}, {2.0, 3.9375}}) {
      INFO(name_of(element) << ", stretch " << stretch);
      Cube c(element, neo_hookean(3, 0.5));
      c.stretch("x1", 0, stretch);
      c.stretch("y1", 1, stretch);
      must_advance(c.world);
      const BodyFields f = c.world.fields(c.body);
      CHECK(stress_error(f, 0, stress) < 1e-9);
      CHECK(stress_error(f, 1, stress) < 1e-9);
      CHECK(stress_error(f, 2, 0) < 1e-9);
    }
  }
}

TEST_CASE("simple shear at nu = 0.5") {
  for (const Element element : kAllElements) {
    for (const double gamma : {0.3, 1.0}) {
      INFO(name_of(element) << ", gamma " << gamma);
      World world = make_world(exact_options());
      const BodyId body = add_body(world, uneven_cube(cells_for(element)), element, neo_hookean(3, 0.5));
      add_volume(world, body);
      hold(world, body, {"z0"}, {{0, 0, 1}});
      move_linearly(world, body, {"x0", "x1", "y0", "y1"}, {{1, 0, 0}, {0, 1, 0}}, [&](const Vec3& X) {
        return Vec3{gamma * X.y, 0, 0};
      });
      must_advance(world);
      const BodyFields f = world.fields(body);
      CHECK(stress_error(f, 3, gamma) < 1e-9);
      CHECK(stress_error(f, 0, gamma * gamma) < 1e-9);
      CHECK(stress_error(f, 1, 0) < 1e-9);
      CHECK(stress_error(f, 2, 0) < 1e-9);
    }
  }
}

TEST_CASE("uniaxial stretch at nu = 0.3 with the bulk modulus in the rows") {
  for (const Element element : kAllElements) {
    INFO(name_of(element));
    Cube c(element, neo_hookean(2.6, 0.3, BulkChoice::bulk_modulus));
    c.stretch("x1", 0, 2);
    must_advance(c.world);
    CHECK(stress_error(c.world.fields(c.body), 0, 2.932594376728146) < 1e-9);
    CHECK(displacement_at(c.world, c.body, {1, 1, 1}).y == Approx(0.76331492555856 - 1).epsilon(1e-9));
  }
}

TEST_CASE("reactions of a stretched cube balance and equal stress times area") {
  for (const Element element : kAllElements) {
    INFO(name_of(element));
    World world = make_world(exact_options());
    const BodyId body = add_body(world, uneven_cube(cells_for(element)), element, neo_hookean(3, 0.5));
    add_volume(world, body);
    const EffectId back = hold(world, body, {"x0"}, {{1, 0, 0}});
    hold(world, body, {"y0"}, {{0, 1, 0}});
    hold(world, body, {"z0"}, {{0, 0, 1}});
    const EffectId front = hold(world, body, {"x1"}, {{1, 0, 0}}, {1, 0, 0});
    must_advance(world);
    // Force = Cauchy stress 3.5 times the area 1/2.
    CHECK(world.reaction(front)[0].x == Approx(1.75).epsilon(1e-8));
    CHECK(world.reaction(back)[0].x == Approx(-1.75).epsilon(1e-8));
  }
}
