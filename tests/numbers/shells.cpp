// Shells against plates, a pinched cylinder and a hemisphere: what they converge to, and how fast.
#include <cmath>
#include <numbers>

#include "support/sheets.h"

using namespace isochor;
using test::value;

namespace {

constexpr double kBig = 1e3, kNear = 1e-7;

World static_world() {
  WorldOptions options = test::static_options();
  options.row_tolerance = 1e-11;
  return test::make_world(options);
}

// Observed order between three levels that halve the spacing.
double order(double coarse, double fine, double exact) {
  return std::log2(std::abs(coarse - exact) / std::abs(fine - exact));
}

// Deflection of the middle of a unit plate under a uniform load, in units of q a^4 / D.
double plate(int n, bool clamped, double disorder) {
  World world = static_world();
  const BodyId body = test::add_sheet(world, test::unit_sheet(n, n, disorder));
  const double young = 1e6, nu = 0.3, thickness = 0.01;
  const double D = young * std::pow(thickness, 3) / (12 * (1 - nu * nu)), q = D * thickness;
  ShellDef def;
  def.young = young;
  def.poisson = nu;
  def.thickness = thickness;
  def.density = 1000;
  Selection rim;
  rim.body = body;
  rim.boxes = {{Vec3{-1, -1, -1}, Vec3{kNear, 2, 1}},
               {Vec3{1 - kNear, -1, -1}, Vec3{2, 2, 1}},
               {Vec3{-1, -1, -1}, Vec3{2, kNear, 1}},
               {Vec3{-1, 1 - kNear, -1}, Vec3{2, 2, 1}}};
  if (clamped) def.clamped = rim;
  value(world.add(shell(def)));
  test::hold_nodes(world, "rim", rim, {});
  TractionDef load;
  load.surface = "outer";
  load.traction = {0, 0, q};
  value(world.add(traction(load)));
  test::must_advance(world);
  return test::displacement_at(world, body, {0.5, 0.5, 0}).z * D / q;
}

struct Quarter {
  World world;
  BodyId body;
};

ShellDef sheet_of(double young, double nu, double thickness) {
  ShellDef def;
  def.young = young;
  def.poisson = nu;
  def.thickness = thickness;
  def.density = 1;
  return def;
}

// An octant of a cylinder between rigid diaphragms, pinched by two opposite unit forces: radius 300, length
// 600, thickness 3, E = 3e6, nu = 0.3. Deflection under the force.
double pinched_cylinder(int n, double disorder) {
  World world = static_world();
  constexpr double R = 300, scale = 100;  // of the force: still a deflection of a thousandth of the thickness
  const Mesh mesh = test::mapped(test::unit_sheet(n, n, disorder), [](const Vec3& p) {
    const double angle = 0.5 * std::numbers::pi * p.x;
    return Vec3{R * std::sin(angle), 300 * p.y, R * std::cos(angle)};
  });
  const BodyId body = test::add_sheet(world, mesh);
  ShellDef def = sheet_of(3e6, 0.3, 3);
  const auto plane = [&](int axis, double at_value) {
    Vec3 lower{-kBig, -kBig, -kBig}, upper{kBig, kBig, kBig};
    lower[axis] = at_value - 1e-6;
    upper[axis] = at_value + 1e-6;
    return test::in_box(body, lower, upper);
  };
  def.clamped.body = body;
  for (int axis = 0; axis < 3; ++axis) def.clamped.boxes.push_back(plane(axis, 0).boxes[0]);
  value(world.add(shell(def)));
  test::hold_nodes(world, "x", plane(0, 0), {{1, 0, 0}});
  test::hold_nodes(world, "y", plane(1, 0), {{0, 1, 0}});
  test::hold_nodes(world, "z", plane(2, 0), {{0, 0, 1}});
  test::hold_nodes(world, "diaphragm", plane(1, 300), {{1, 0, 0}, {0, 0, 1}});
  PointForceDef pinch;
  pinch.where.body = body;
  pinch.where.nearest = {{0, 0, R}};
  pinch.force = {0, 0, -0.25 * scale};
  value(world.add(point_force(pinch)));
  test::must_advance(world);
  return -test::displacement_at(world, body, {0, 0, R}).z / scale;
}

// A quarter of a hemisphere with a hole of 18 degrees around its pole, pulled and pushed at its equator by
// forces of 2: radius 10, thickness 0.04, E = 6.825e7, nu = 0.3. Deflection under a force.
double hemisphere(int n, double disorder) {
  World world = static_world();
  constexpr double R = 10, scale = 1e-3;
  const Mesh mesh = test::mapped(test::unit_sheet(n, n, disorder), [](const Vec3& p) {
    const double around = 0.5 * std::numbers::pi * p.x, down = std::numbers::pi / 180 * (90 - 72 * p.y);
    return Vec3{R * std::sin(down) * std::cos(around), R * std::sin(down) * std::sin(around),
                R * std::cos(down)};
  });
  const BodyId body = test::add_sheet(world, mesh);
  ShellDef def = sheet_of(6.825e7, 0.3, 0.04);
  const Selection x0 = test::in_box(body, {-1e-6, -kBig, -kBig}, {1e-6, kBig, kBig});
  const Selection y0 = test::in_box(body, {-kBig, -1e-6, -kBig}, {kBig, 1e-6, kBig});
  def.clamped.body = body;
  def.clamped.boxes = {x0.boxes[0], y0.boxes[0]};
  value(world.add(shell(def)));
  test::hold_nodes(world, "x", x0, {{1, 0, 0}});
  test::hold_nodes(world, "y", y0, {{0, 1, 0}});
  Selection point;
  point.body = body;
  point.nearest = {{R, 0, 0}};
  test::hold_nodes(world, "point", point, {{0, 0, 1}});
  PointForceDef out, in;
  out.where = point;
  out.force = {scale, 0, 0};
  in.name = "in";
  in.where = point;
  in.where.nearest = {{0, R, 0}};
  in.force = {0, -scale, 0};
  value(world.add(point_force(out)));
  value(world.add(point_force(in)));
  test::must_advance(world);
  return test::displacement_at(world, body, {R, 0, 0}).x / scale;
}

}  // namespace

TEST_CASE("a plate under uniform load converges at second order on any triangulation") {
  // Timoshenko & Woinowsky-Krieger: Navier's series, and Taylor's and Evans's value for the clamped plate.
  for (const bool clamped : {false, true}) {
    const double exact = clamped ? 0.00126531908 : 0.00406235266;
    for (const double disorder : {0.0, 0.3}) {
      const double coarse = plate(8, clamped, disorder), middle = plate(16, clamped, disorder),
                   fine = plate(32, clamped, disorder);
      INFO("clamped " << clamped << ", disorder " << disorder << ": " << coarse / exact << " "
                      << middle / exact << " " << fine / exact);
      UNSCOPED_INFO("order " << order(coarse, middle, exact) << ", " << order(middle, fine, exact));
      CHECK(fine == Approx(exact).epsilon(clamped ? 0.03 : 0.006));
      CHECK(order(middle, fine, exact) > (disorder > 0 ? 1.6 : 1.85));
    }
  }
}

TEST_CASE("a pinched cylinder converges") {
  const double exact = 1.8248e-5;
  for (const double disorder : {0.0, 0.2}) {
    const double coarse = pinched_cylinder(16, disorder), fine = pinched_cylinder(32, disorder);
    INFO("disorder " << disorder << ": " << coarse / exact << " " << fine / exact);
    CHECK(fine == Approx(exact).epsilon(0.14));
    CHECK(order(coarse, fine, exact) > 1);
  }
}

TEST_CASE("a pinched hemisphere converges") {
  // 0.0940 is what MacNeal and Harder (1985) propose, 0.0930 what Simo, Fox and Rifai (1989) converge to.
  for (const double disorder : {0.0, 0.2}) {
    const double coarse = hemisphere(8, disorder), fine = hemisphere(24, disorder);
    INFO("disorder " << disorder << ": " << coarse << " " << fine);
    CHECK(fine == Approx(0.0935).epsilon(0.02));
    CHECK(std::abs(fine - 0.0935) < std::abs(coarse - 0.0935));
  }
}

TEST_CASE("a strip bends like an elastica") {
  // Mattiasson (1981): a cantilever under a force at its end, P L^2 / (E I) = 2: 0.49346 L down, 0.16064 L
  // back.
  World world = static_world();
  constexpr int n = 24;
  const Mesh mesh = test::mapped(test::unit_sheet(n, 2), [](const Vec3& p) {
    return Vec3{p.x, 0.1 * p.y, 0};
  });
  const BodyId body = test::add_sheet(world, mesh);
  ShellDef def = sheet_of(1.2e7, 0, 0.01);
  const double EI = 1.2e7 * 0.1 * 1e-6 / 12;
  def.clamped = test::in_box(body, {-1, -1, -1}, {kNear, 1, 1});
  value(world.add(shell(def)));
  test::hold_nodes(world, "root", def.clamped, {});
  PointForceDef force;
  force.where = test::in_box(body, {1 - kNear, -1, -1}, {2, 1, 1});
  force.force = {0, 0, -2 * EI};
  force.amount = Curve::ramp(1);
  value(world.add(point_force(force)));
  for (int k = 0; k < 4; ++k) test::must_advance(world, 0.25);
  const Vec3 u = test::displacement_at(world, body, {1, 0, 0});
  CHECK(-u.z == Approx(0.49346).epsilon(0.004));
  CHECK(-u.x == Approx(0.16064).epsilon(0.01));
}
