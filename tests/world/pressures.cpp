// Pressure on faces that need not enclose anything: resultants, the way it turns, and how Newton's method
// takes it.
#include <cmath>
#include <map>

#include "engine/base/base.h"
#include "isochor/mesh_select.h"
#include "support/worlds.h"

using namespace isochor;
using namespace test;

namespace {

struct Pressed {
  World world;
  BodyId body{};
  EffectId base{}, load{};
  StepReport report;

  Pressed(Mesh mesh, Element element, double amount, bool lagged = false,
          std::vector<std::string> surfaces = {"z1"}, double poisson = 0.45)
      : world(make_world(static_options())) {
    body = add_body(world, std::move(mesh), element, neo_hookean(1e5, poisson));
    add_volume(world, body);
    base = hold(world, body, {"z0"});
    PressureDef def;
    def.body = body;
    def.surfaces = std::move(surfaces);
    def.amount = Curve::ramp(amount);
    def.lagged = lagged;
    load = value(world.add(pressure(def)));
  }
  void solve() { report = must_advance(world); }
  Vec3 reaction() const { return world.reaction(base)[0]; }
};

Mesh slab(Element element) {
  return block({0, 0, 0}, {0.04, 0.04, 0.02}, {4, 3, 2}, cells_for(element));
}

// 1/2 of the integral of x cross dx along the rim of faces: what their area vectors add up to, whatever is
// inside. `faces` are wound outward.
Vec3 area_by_rim(const Mesh& mesh, std::span<const Vec3> x, const std::vector<Index>& faces) {
  const auto per = static_cast<std::size_t>(nodes_per_face(mesh.cell_type));
  const std::size_t corners = per == 4 ? 4 : 3;
  std::map<std::pair<Index, Index>, Index> open;
  for (std::size_t f = 0; f < faces.size(); f += per) {
    for (std::size_t k = 0; k < corners; ++k) {
      const Index a = faces[f + k], b = faces[f + (k + 1) % corners];
      if (open.erase({b, a}) == 0) open[{a, b}] = per == 6 ? faces[f + 3 + k] : -1;
    }
  }
  Vec3 sum{};
  const auto at_node = [&](Index n) { return x[static_cast<std::size_t>(n)]; };
  for (const auto& [ends, middle] : open) {
    const Vec3 a = at_node(ends.first), b = at_node(ends.second);
    if (middle < 0) {
      sum += 0.5 * cross(a, b);
      continue;
    }
    // The quadratic edge is the chord and a parabola over it of height h: 2/3 of the triangle a, m, b twice.
    const Vec3 h = at_node(middle) - 0.5 * (a + b);
    sum += 0.5 * cross(a, b) + (2.0 / 3) * cross(h, b - a);
  }
  return sum;
}

std::vector<Index> outward(const Mesh& mesh, const std::string& name) {
  MeshSelection s;
  s.of = {name};
  return value(select_faces(mesh, s));
}

double largest_difference(std::span<const Vec3> a, std::span<const Vec3> b) {
  double worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    worst = std::max(worst, std::sqrt(dot(a[i] - b[i], a[i] - b[i])));
  return worst;
}

}  // namespace

TEST_CASE("pressure on an open patch: the supports carry pressure times area") {
  for (const Element element : kAllElements) {
    INFO(name_of(element));
    Pressed small(slab(element), element, 2e-3);
    small.solve();
    // 0.04 m x 0.04 m; the load pushes down, the base up.
    CHECK(small.reaction().z == Approx(2e-3 * 0.0016).epsilon(1e-6));
    Pressed large(slab(element), element, 2e4);
    large.solve();
    const Mesh& mesh = large.world.mesh(large.body);
    const Vec3 area = area_by_rim(mesh, large.world.positions(large.body), outward(mesh, "z1"));
    CHECK(large.reaction().z == Approx(2e4 * area.z).epsilon(1e-8));
    CHECK(std::abs(large.reaction().x - 2e4 * area.x) < 1e-7);
    // The patch has grown by more than a percent: a dead load would not know.
    CHECK(area.z > 1.01 * 0.0016);
  }
}

TEST_CASE("pressure on an open patch turns with it") {
  // A slender arm under pressure on one side bends; its tip ends beyond where a load that keeps its direction
  // could bring it, and turning the scene turns the answer.
  for (const Element element : {Element::tet4_edge_smoothed, Element::tet10, Element::hex8}) {
    INFO(name_of(element));
    const auto arm = [&](bool turned) {
      Mesh mesh = block({0, 0, 0}, {0.01, 0.01, 0.08}, {2, 2, 10}, cells_for(element));
      return turned ? mapped(mesh, [](const Vec3& x) { return Vec3{x.z, x.x, x.y}; }) : mesh;
    };
    Pressed one(arm(false), element, 300, false, {"x0"});
    one.solve();
    Pressed other(arm(true), element, 300, false, {"x0"});
    other.solve();
    std::vector<Vec3> back;
    for (const Vec3& x : other.world.positions(other.body)) back.push_back({x.y, x.z, x.x});
    CHECK(largest_difference(one.world.positions(one.body), back) < 1e-8);
    // It has curled so far that most of the load no longer points where it did, and is still pressure times
    // the area of the rim.
    const Vec3 tip = displacement_at(one.world, one.body, {0.005, 0.005, 0.08});
    CHECK(tip.x > 0.02);
    const Mesh& mesh = one.world.mesh(one.body);
    const Vec3 sum = 300 * area_by_rim(mesh, one.world.positions(one.body), outward(mesh, "x0"));
    CHECK(std::abs(sum.z) > 0.2 * std::abs(sum.x));
    const Vec3 difference = one.reaction() - sum;
    CHECK(std::sqrt(dot(difference, difference)) < 1e-8);
  }
}

TEST_CASE(
    "pressure at a free rim: Newton converges quadratically, with the lagged rim linearly to the same") {
  for (const Element element : kAllElements) {
    INFO(name_of(element));
    Pressed large(slab(element), element, 2e4);
    large.solve();
    CHECK(large.report.iterations <= 4);
    Pressed coupled(slab(element), element, 1e4), lagged(slab(element), element, 1e4, true);
    coupled.solve();
    lagged.solve();
    CHECK(coupled.report.iterations <= 3);
    CHECK(largest_difference(coupled.world.positions(coupled.body), lagged.world.positions(lagged.body)) <
          1e-8);
    CHECK(coupled.reaction().z == Approx(lagged.reaction().z).epsilon(1e-6));
  }
}

TEST_CASE("pressure on a closed surface, or one whose rim is held, is that of a cavity") {
  for (const CellType type : {CellType::tet4, CellType::tet10, CellType::hex8}) {
    const Element element = type == CellType::tet4    ? Element::tet4_edge_smoothed
                            : type == CellType::tet10 ? Element::tet10
                                                      : Element::hex8;
    INFO(name_of(element));
    const auto solve = [&](bool as_cavity, bool closed) {
      World world = make_world(static_options());
      const Mesh mesh =
          closed ? mapped(hollow_box(false, type), [](const Vec3& p) { return 0.01 * p; }) : slab(element);
      const BodyId body = add_body(world, mesh, element, neo_hookean(1e5, 0.45));
      add_volume(world, body);
      hold(world, body,
           closed ? std::vector<std::string>{"z0"} : std::vector<std::string>{"x0", "x1", "y0", "y1"});
      if (as_cavity) {
        CavityDef def;
        def.surfaces = {closed ? "chamber 1" : "z1"};
        def.amount = Curve::ramp(3000);
        value(world.add(cavity(def)));
      } else {
        PressureDef def;
        def.surfaces = {closed ? "chamber 1" : "z1"};
        def.amount = Curve::ramp(3000);
        value(world.add(pressure(def)));
      }
      must_advance(world);
      const auto x = world.positions(body);
      return std::vector<Vec3>(x.begin(), x.end());
    };
    for (const bool closed : {true, false}) {
      INFO((closed ? "closed" : "rim held"));
      CHECK(largest_difference(solve(true, closed), solve(false, closed)) < 1e-10);
    }
  }
}

TEST_CASE("pressure on one side of a free body speeds it up, whatever the scheme says of energies") {
  for (const bool lagged : {false, true}) {
    World world = make_world(dynamic_options());
    const BodyId body = add_body(world, slab(Element::tet4), Element::tet4, neo_hookean(1e6, 0.45));
    PressureDef def;
    def.surfaces = {"z1"};
    def.amount = Curve::constant(100);
    def.lagged = lagged;
    value(world.add(pressure(def)));
    const Vec3 start = world.measures(body).center_of_mass;
    for (int k = 0; k < 20; ++k) must_advance(world, 0.005);
    // p A / m = 100 * 0.0016 / 0.032 = 5 m/s^2; implicit Euler is t h / 2 * 5 ahead of 5 t^2 / 2.
    const double fallen = start.z - world.measures(body).center_of_mass.z;
    CHECK(fallen == Approx(0.5 * 5 * 0.1 * (0.1 + 0.005)).epsilon(5e-3));
  }
}

TEST_CASE("a cavity over an open patch points to pressures, and its cap to what it cancels") {
  const auto draft = [](bool capped) {
    World world = make_world(static_options());
    const BodyId body = add_body(world, slab(Element::tet4), Element::tet4, neo_hookean(1e5, 0.45));
    hold(world, body, {"z0"});
    CavityDef def;
    def.surfaces = {"z1"};
    def.cap_free_openings = capped;
    value(world.add(cavity(def)));
    auto r = world.compile();
    if (!r) return r.error();
    return world.warnings().empty() ? std::string() : world.warnings().back();
  };
  CHECK_THAT(draft(false), ContainsSubstring("pressure") && ContainsSubstring("traction") &&
                               ContainsSubstring("cap_free_openings"));
  CHECK_THAT(draft(true), ContainsSubstring("cancels the load") && ContainsSubstring("0.0016 m^2"));
}

TEST_CASE("a pressure with a profile of one is the pressure, on open and on closed faces") {
  for (const Element element : {Element::tet4, Element::tet4_edge_smoothed, Element::tet10, Element::hex8}) {
    for (const bool lagged : {false, true}) {
      const double amount = lagged ? 3e3 : 2e4;
      Pressed plain(slab(element), element, amount, lagged), varying(slab(element), element, amount, lagged);
      PressureDef def;
      def.body = varying.body;
      def.surfaces = {"z1"};
      def.amount = Curve::ramp(amount);
      def.lagged = lagged;
      def.profile = "1 + 0*x";
      value(varying.world.replace(varying.load, pressure(def)));
      plain.solve();
      varying.solve();
      INFO(name_of(element) << (lagged ? ", lagged" : ""));
      // Unsymmetric systems converge as Newton's method does.
      if (!lagged) CHECK(varying.report.iterations <= plain.report.iterations + 2);
      double worst = 0;
      for (std::size_t i = 0; i < plain.world.positions(plain.body).size(); ++i)
        worst = std::max(
            worst, norm(plain.world.positions(plain.body)[i] - varying.world.positions(varying.body)[i]));
      CHECK(worst < 1e-8 * 0.04);
    }
  }
}

TEST_CASE("a pressure that varies in space and time has the resultant of its integral") {
  // Over the flat top of a stiff slab, a by b: the integral of 1 + x/a is 1.5 a b; times 1 + t.
  for (const Element element : {Element::tet4, Element::tet10, Element::hex8}) {
    World world = make_world(static_options());
    const BodyId body = add_body(world, slab(element), element, neo_hookean(1e11, 0.3));
    const EffectId base = hold(world, body, {"z0"});
    PressureDef def;
    def.body = body;
    def.surfaces = {"z1"};
    def.amount = Curve::constant(1e3);
    def.profile = "(1 + t) * (1 + x/0.04)";
    value(world.add(pressure(def)));
    for (const double t : {0.5, 1.0}) {
      must_advance(world, 0.5);
      const double force = 1e3 * (1 + t) * 1.5 * 0.04 * 0.04;
      INFO(name_of(element) << ", t " << t);
      CHECK(world.reaction(base)[0].z == Approx(force).epsilon(1e-6));
      // About the origin: the integral of -x p, p = 1 + x/a, is -(a^2/2 + a^2/3) b.
      CHECK(world.reaction(base)[1].y == Approx(-1e3 * (1 + t) * 0.04 * 0.04 * 0.04 * 5 / 6).epsilon(1e-5));
    }
  }
}
