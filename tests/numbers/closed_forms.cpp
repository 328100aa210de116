// Inhomogeneous closed forms of incompressible neo-Hookean solids, mu = 1: torsion, thick tube, thick sphere.
#include <algorithm>
#include <cmath>

#include "support/worlds.h"

using namespace isochor;
using namespace test;

namespace {

constexpr double kPi = 3.14159265358979323846;

double tube_pressure(double a) {
  const double A = 1, B = 2, b2 = B * B + a * a - A * A;
  return 0.5 * (std::log(B * B * a * a / (A * A * b2)) + (a * a - A * A) * (1 / (a * a) - 1 / b2));
}

double sphere_pressure(double a) {
  const double b = std::cbrt(8 + a * a * a - 1), lb = b / 2;
  return 2 / lb + 0.5 / std::pow(lb, 4) - 2 / a - 0.5 / std::pow(a, 4);
}

// Volume of the cavity over its rest volume at an inner stretch: `power` 2 for the tube, 3 for the sphere.
struct Vessel {
  World world;
  BodyId body{};
  EffectId chamber{};

  Vessel(const std::string& shape, Element element, CavityControl control,
         const WorldOptions& options = static_options())
      : world(make_world(options)) {
    const std::string file = shape + (element == Element::tet10 ? "_tet10" : "");
    body = add_body(world, scene_mesh(file), element, neo_hookean(3, 0.5));
    add_volume(world, body);
    hold(world, body, {"symmetry_x"}, {{1, 0, 0}});
    hold(world, body, {"symmetry_y"}, {{0, 1, 0}});
    hold(world, body, {shape == "thick_tube" ? "faces_z" : "symmetry_z"}, {{0, 0, 1}});
    CavityDef def;
    def.body = body;
    def.surfaces = {"inner"};
    def.control = control;
    def.amount = Curve::constant(control == CavityControl::pressure ? 0 : 1);
    chamber = value(world.add(isochor::cavity(def)));
  }
  // Mean radius of the nodes that are at radius r at rest.
  double radius(double r, bool tube) const {
    double sum = 0;
    int count = 0;
    for (std::size_t i = 0; i < world.positions(body).size(); ++i) {
      Vec3 X = world.rest_positions(body)[i], x = world.positions(body)[i];
      if (tube) X.z = x.z = 0;
      if (std::abs(std::sqrt(dot(X, X)) - r) > 1e-9) continue;
      sum += std::sqrt(dot(x, x));
      ++count;
    }
    REQUIRE(count > 0);
    return sum / count;
  }
};

}  // namespace

TEST_CASE("torsion of a cylinder") {
  for (const Element element : {Element::tet4_edge_smoothed, Element::tet10}) {
    for (const double twist : {0.5, 1.0}) {
      INFO(name_of(element) << ", twist " << twist);
      World world = make_world(static_options());
      const std::string file = element == Element::tet10 ? "torsion_cylinder_tet10" : "torsion_cylinder";
      const BodyId body = add_body(world, scene_mesh(file), element, neo_hookean(3, 0.5));
      add_volume(world, body);
      hold(world, body, {"bottom"});
      DirichletDef turn;
      turn.name = "turn";
      turn.where.surfaces = {"top"};
      turn.axis = {0, 0, 1};
      turn.angle = twist;
      turn.amount = Curve::ramp(1);
      const EffectId top = value(world.add(dirichlet(turn)));
      must_advance(world);
      const auto [force, moment] = world.reaction(top);
      // The mesh is a polyhedron for linear elements; torque goes with the fourth power of the radius.
      const double tolerance = element == Element::tet10 ? 2e-3 : 2e-2;
      INFO("torque " << moment.z << ", axial force " << force.z);
      CHECK(moment.z == Approx(kPi / 2 * twist).epsilon(tolerance));
      CHECK(force.z == Approx(-kPi / 4 * twist * twist).epsilon(2 * tolerance));
      CHECK(displacement_at(world, body, {1, 0, 0.5}).z == Approx(0).margin(0.01));
      double radius = 0;
      for (std::size_t i = 0; i < world.positions(body).size(); ++i) {
        const Vec3 x = world.positions(body)[i];
        radius = std::max(radius, std::hypot(x.x, x.y));
      }
      CHECK(radius == Approx(1).epsilon(element == Element::tet10 ? 2e-3 : 1e-2));
    }
  }
}

TEST_CASE("pressure in a thick tube and a thick sphere") {
  for (const std::string shape : {"thick_tube", "thick_sphere"}) {
    const bool tube = shape == "thick_tube";
    for (const Element element : {Element::tet10, Element::tet4_edge_smoothed}) {
      Vessel v(shape, element, CavityControl::volume_ratio);
      CHECK(v.world.mesh(v.body).cell_count() < 10000);
      const double rest = gauge(v.world, "volume");
      for (const double stretch : {1.25, 1.5, 2.0}) {
        const double ratio = tube ? stretch * stretch : stretch * stretch * stretch;
        REQUIRE(v.world.set_amount(v.chamber, ratio).ok());
        must_advance(v.world);
        const double exact = tube ? tube_pressure(stretch) : sphere_pressure(stretch);
        const double p = gauge(v.world, "pressure");
        INFO(shape << ", " << name_of(element) << ", stretch " << stretch << ": pressure " << p << ", exact "
                   << exact << ", error " << 100 * (p / exact - 1) << " %");
        const double tolerance = element == Element::tet10 ? 0.005 : 0.01;
        CHECK(p == Approx(exact).epsilon(tolerance));
        CHECK(gauge(v.world, "volume") / rest == Approx(ratio).epsilon(1e-9));
        const double outer =
            tube ? std::sqrt(4 + stretch * stretch - 1) : std::cbrt(8 + stretch * stretch * stretch - 1);
        CHECK(v.radius(2, tube) == Approx(outer).epsilon(2e-3));
        CHECK(v.radius(1, tube) == Approx(stretch).epsilon(5e-3));
        CHECK(v.world.measures(v.body).volume_error < 1e-9);
      }
    }
  }
}

TEST_CASE("the closed forms themselves") {
  CHECK(tube_pressure(1.5) == Approx(0.4282284090965022).epsilon(1e-14));
  CHECK(sphere_pressure(1.5) == Approx(0.7554331187123394).epsilon(1e-14));
}

TEST_CASE("volume control follows the sphere through its limit point") {
  Vessel v("thick_sphere", Element::tet10, CavityControl::volume_ratio);
  std::vector<double> pressure;
  for (const double stretch : {1.6, 1.828, 2.0, 2.4}) {
    REQUIRE(v.world.set_amount(v.chamber, std::pow(stretch, 3)).ok());
    must_advance(v.world);
    pressure.push_back(gauge(v.world, "pressure"));
    CHECK(pressure.back() == Approx(sphere_pressure(stretch)).epsilon(0.005));
  }
  CHECK(pressure[1] > pressure[0]);
  CHECK(pressure[2] < pressure[1]);
  CHECK(pressure[3] < pressure[2]);
}

TEST_CASE("a pressure that no equilibrium carries is rejected with a reason") {
  for (const auto& [shape, pressure] : {std::pair("thick_tube", 0.75), {"thick_sphere", 0.85}}) {
    INFO(shape);
    // Few and short attempts: the default would find the last equilibrium more closely, and take longer.
    WorldOptions options = static_options();
    options.max_iterations = 12;
    options.smallest_fraction = 1.0 / 8;
    Vessel v(shape, Element::tet4, CavityControl::pressure, options);
    REQUIRE(v.world.set_amount(v.chamber, pressure).ok());
    const StepReport r = v.world.advance(1);
    CHECK(r.status == StepStatus::rejected);
    INFO(r.reason);
    CHECK(r.reason.find("no equilibrium") != std::string::npos);
    CHECK(r.reason.find("limit point") != std::string::npos);
    CHECK(r.time < 1);
    CHECK(r.time > 0.3);
    // What is left is the last equilibrium: finite, with its volume.
    CHECK(v.world.measures(v.body).volume_error < 1e-9);
    CHECK(std::isfinite(gauge(v.world, "volume")));
  }
}
