// The local penalty on its own, and with a zone of exact volume: two tets, one of them crushed flat.
#include <cmath>

#include "engine/elements/material_model.h"
#include "numbers/cube.h"
#include "support/worlds.h"

using namespace isochor;
using test::value;

namespace {

// Systems of a few unknowns.
WorldOptions small_system() {
  WorldOptions options = test::static_options();
  options.solver = Solver::eigen;
  return options;
}

// Two equal tets joined by the face of nodes 1, 2, 3 in the plane x = 0: node 0 on the left, 4 on the right.
Mesh two_tets() {
  Mesh mesh;
  mesh.cell_type = CellType::tet4;
  mesh.nodes = {{-1, 0, 0}, {0, 1, 0}, {0, -0.5, 0.9}, {0, -0.5, -0.9}, {1, 0, 0}};
  mesh.cells = {0, 1, 2, 3, 4, 1, 3, 2};
  return mesh;
}

double six_volumes(std::span<const Vec3> x, std::array<std::size_t, 4> n) {
  return dot(x[n[1]] - x[n[0]], cross(x[n[2]] - x[n[0]], x[n[3]] - x[n[0]]));
}

double volume_of(std::span<const Vec3> x, int cell) {
  return (cell == 0 ? six_volumes(x, {0, 1, 2, 3}) : six_volumes(x, {4, 1, 3, 2})) / 6;
}

struct TwoTets {
  World world = test::make_world(small_system());
  BodyId body;
  TwoTets(const MaterialPtr& material, bool zone)
      : body(test::add_body(world, two_tets(), Element::tet4, material)) {
    if (zone) {
      VolumeDef def;
      def.body = body;
      def.space = VolumeSpace::body;
      def.hard = true;
      def.carries_bulk = false;
      value(world.add(volume(def)));
    }
    // The face stays where it is, the left tip goes into its plane, the right one is free along x.
    DirichletDef face;
    face.name = "face";
    face.where.body = body;
    face.where.nodes = {1, 2, 3};
    value(world.add(dirichlet(face)));
    DirichletDef tip;
    tip.name = "tip";
    tip.where.body = body;
    tip.where.nodes = {0};
    tip.displacement = {1, 0, 0};
    tip.amount = Curve::ramp(1);
    value(world.add(dirichlet(tip)));
  }
};

MaterialPtr extended(double poisson) {
  ElasticConstants c;
  c.young = 1e5;
  c.poisson = poisson;
  return value(isochoric_extended(c));
}

}  // namespace

TEST_CASE("one of two tets is crushed flat and the other takes its volume") {
  for (const bool stable : {true, false}) {
    ElasticConstants c;
    c.young = 1e5;
    c.poisson = 0.3;
    const MaterialPtr material = stable ? value(stable_neo_hookean(c)) : extended(0.3);
    const double rest = volume_of(two_tets().nodes, 0);
    TwoTets zone(material, true), alone(material, false);
    test::must_advance(zone.world);
    test::must_advance(alone.world);
    const auto x = zone.world.positions(zone.body);
    CHECK(std::abs(volume_of(x, 0)) < 1e-14);
    CHECK(volume_of(x, 1) == Approx(2 * rest).epsilon(1e-12));
    CHECK(zone.world.measures(zone.body).volume == Approx(2 * rest).epsilon(1e-12));
    // Without the zone half of the volume is gone.
    CHECK(alone.world.measures(alone.body).volume < 1.3 * rest);
  }
}

TEST_CASE("the penalty adds its modulus to the small-strain bulk stiffness") {
  const MaterialPtr base = extended(0.3);
  const double mu = base->shear_modulus(), lambda = 2 * mu * 0.3 / 0.4;
  const MaterialPtr with = value(with_compression_penalty(base, {3 * mu, 9}));
  CHECK(with->shear_modulus() == mu);
  CHECK(with->poisson() == Approx((lambda + 3 * mu) / (2 * (lambda + 4 * mu))));
  // A cube under a small confined strain: stress = lambda + 2 mu + modulus times the strain.
  World world = test::make_world(small_system());
  const BodyId body = test::add_body(world, test::box({1, 1, 1}), Element::tet4, with);
  test::hold(world, body, {"x0", "y0", "y1", "z0", "z1"}, {{0, 1, 0}, {0, 0, 1}});
  const EffectId wall = test::hold(world, body, {"x0"}, {{1, 0, 0}});
  test::hold(world, body, {"x1"}, {{0, 1, 0}, {0, 0, 1}});
  DirichletDef push;
  push.name = "push";
  push.where.body = body;
  push.where.surfaces = {"x1"};
  push.directions = {{1, 0, 0}};
  push.displacement = {1e-6, 0, 0};
  push.amount = Curve::ramp(1);
  value(world.add(dirichlet(push)));
  test::must_advance(world);
  CHECK(std::abs(world.reaction(wall)[0].x) == Approx(1e-6 * (lambda + 5 * mu)).epsilon(1e-5));
}

TEST_CASE("a finite compression follows the derivative of the penalty") {
  for (const double beta : {0.0, 9.0}) {
    // Confined, squeezed to half: every element has J = 0.5, and the push is P of the base plus modulus
    // U'(J).
    double force[2];
    for (int k = 0; k < 2; ++k) {
      const MaterialPtr base = extended(0.3);
      World world = test::make_world(small_system());
      const BodyId body = test::add_body(world, test::box({2, 1, 1}), Element::tet4,
                                         k == 0 ? base : value(with_compression_penalty(base, {1e6, beta})));
      test::hold(world, body, {"y0", "y1", "z0", "z1"}, {{0, 1, 0}, {0, 0, 1}});
      const EffectId wall = test::hold(world, body, {"x0"}, {{1, 0, 0}});
      test::hold(world, body, {"x1"}, {{1, 0, 0}}, {-0.5, 0, 0});
      test::must_advance(world);
      force[k] = world.reaction(wall)[0].x;
    }
    CHECK(std::abs(force[1] - force[0]) == Approx(1e6 * 0.5 * (beta * 0.25 + 3) / 3).epsilon(1e-9));
  }
}

TEST_CASE("constants of the penalty that mean nothing are refused") {
  const MaterialPtr base = extended(0.3);
  CHECK_THAT(with_compression_penalty(base, {-1, 9}).error(), ContainsSubstring("modulus = -1"));
  CHECK_THAT(with_compression_penalty(base, {0, 9}).error(), ContainsSubstring("must be positive"));
  CHECK_THAT(with_compression_penalty(base, {1, -2}).error(), ContainsSubstring("beta = -2"));
  CHECK_THAT(with_compression_penalty(nullptr, {1, 9}).error(), ContainsSubstring("empty"));
}
