// What must not change the answer: units, the orientation of the scene, numbers of nodes, order of cells,
// winding.
#include <cmath>

#include "numbers/cantilever.h"

using namespace isochor;
using namespace test;

namespace {

struct Answer {
  Vec3 tip;
  int iterations;
  double force;  // support force along gravity
};

// The short cantilever in a unit of length of 1/`per_meter` m and a unit of pressure of 1/`per_pascal` Pa,
// turned.
Answer solve(const Mesh& mesh, Element element, double per_meter, double per_pascal, double angle) {
  const auto turn = [&](const Vec3& p) {
    return Vec3{std::cos(angle) * p.x - std::sin(angle) * p.y, std::sin(angle) * p.x + std::cos(angle) * p.y,
                p.z};
  };
  WorldOptions options = static_options();
  options.gravity = turn({0, -0.98 * per_meter, 0});
  World world = make_world(options);
  const Mesh scaled = mapped(mesh, [&](const Vec3& p) { return per_meter * turn(p); });
  // A newton is Pa m^2, so a density is Pa s^2/m^2.
  const double density = 1070 * per_pascal / (per_meter * per_meter);
  const BodyId body = add_body(world, scaled, element, neo_hookean(266e3 * per_pascal, 0.5), density);
  add_volume(world, body);
  const EffectId clamp = hold(world, body, {"clamped"});
  const StepReport r = world.step(1);
  INFO(r.reason);
  REQUIRE(r.status == StepStatus::converged);
  const Vec3 u = (1 / per_meter) * displacement_at(world, body, per_meter * turn({1, 0.05, 0.05}));
  const Vec3 back{std::cos(angle) * u.x + std::sin(angle) * u.y,
                  -std::sin(angle) * u.x + std::cos(angle) * u.y, u.z};
  const Vec3 f = world.reaction(clamp)[0];
  return {back, r.iterations, std::sqrt(dot(f, f)) / (per_pascal * per_meter * per_meter)};
}

double distance(const Vec3& a, const Vec3& b) {
  return std::sqrt(dot(a - b, a - b));
}

}  // namespace

TEST_CASE("units of length and pressure change nothing but the units") {
  for (const Element element : kElements) {
    INFO(name_of(element));
    const Mesh mesh = beam(10, 2, 2);
    const Answer meters = solve(mesh, element, 1, 1, 0);
    CHECK(meters.force == Approx(1070 * 0.01 * 0.98).epsilon(1e-6));
    for (const auto& [length, pressure] : {std::pair(1000.0, 1e-6), {1.0, 1e-3}, {100.0, 1.0}}) {
      INFO(length << " per meter, " << pressure << " per pascal");
      const Answer other = solve(mesh, element, length, pressure, 0);
      CHECK(other.iterations == meters.iterations);
      CHECK(distance(other.tip, meters.tip) < 1e-8);
      CHECK(other.force == Approx(meters.force).epsilon(1e-6));
    }
  }
}

TEST_CASE("the orientation of the scene changes nothing") {
  for (const Element element : kElements) {
    INFO(name_of(element));
    const Mesh mesh = beam(10, 2, 2);
    const Answer straight = solve(mesh, element, 1, 1, 0);
    for (const double angle : {0.7, 2.5}) {
      const Answer turned = solve(mesh, element, 1, 1, angle);
      CHECK(distance(turned.tip, straight.tip) < 1e-7);
      CHECK(std::abs(turned.iterations - straight.iterations) <= 1);
    }
  }
}

TEST_CASE("numbers of nodes and order of cells change nothing") {
  for (const Element element : kElements) {
    INFO(name_of(element));
    const Mesh mesh = beam(10, 2, 2);
    const Answer plain = solve(mesh, element, 1, 1, 0);
    std::vector<Index> place;
    for (const unsigned seed : {1u, 2u}) {
      const Answer other = solve(shuffled(mesh, seed, place), element, 1, 1, 0);
      CHECK(distance(other.tip, plain.tip) < 1e-7);
      CHECK(std::abs(other.iterations - plain.iterations) <= 1);
    }
  }
}

TEST_CASE("the winding of surface faces changes nothing") {
  const auto inflate = [](bool turned) {
    Mesh mesh = hollow_box(false, CellType::tet4);
    for (auto& s : mesh.surfaces) {
      for (std::size_t f = 0; turned && f < s.faces.size(); f += 6) std::swap(s.faces[f], s.faces[f + 1]);
    }
    World world = make_world(static_options());
    const BodyId body = add_body(world, mesh, Element::tet4_edge_smoothed, neo_hookean(1e5, 0.5));
    add_volume(world, body);
    hold(world, body, {"z0"});
    CavityDef chamber;
    chamber.surfaces = {"chamber"};
    chamber.amount = Curve::ramp(5000);
    value(world.add(cavity(chamber)));
    must_advance(world);
    return gauge(world, "volume");
  };
  CHECK(inflate(false) > 1);
  CHECK(inflate(true) == Approx(inflate(false)).epsilon(1e-12));
}
