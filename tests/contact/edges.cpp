// Edges that cross: their distance, and bodies that touch with nothing else.
#include <cmath>
#include <random>

#include "constraints/contact/surface/crossing.h"
#include "constraints/contact/surface/surface_edges.h"
#include "isochor/contact.h"
#include "support/hyper_dual.h"
#include "support/worlds.h"

namespace {

using namespace isochor;
using test::HyperDual;

using Pair = std::array<Vec3, kPairNodes>;

// Two ridges, the first above the second, `turn` [rad] between them. Their triangles fall away by `slope`;
// the second edge is shifted by `along` its own direction and that of the first.
Pair crossed(double turn, double slope, double gap, const Vec3& along = {}, unsigned seed = 0,
             double most = 0.02) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> noise(-most, most);
  const Vec3 e{std::cos(turn), std::sin(turn), 0}, side{-std::sin(turn), std::cos(turn), 0};
  Pair x{{{-0.5, 0, gap},
          {0.5, 0, gap},
          {0.1, -1, gap + slope},
          {0, 1, gap + slope},
          -0.5 * e,
          0.5 * e,
          side + Vec3{0, 0, -slope},
          Vec3{0.1, 0, -slope} - side}};
  for (std::size_t i = kEdgeNodes; i < kPairNodes; ++i) x[i] += along.x * Vec3{1, 0, 0} + along.y * e;
  if (seed > 0) {
    for (Vec3& p : x) p += Vec3{noise(random), noise(random), noise(random)};
  }
  return x;
}

HyperDual dual_dot(const std::array<HyperDual, 3>& a, const std::array<HyperDual, 3>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
std::array<HyperDual, 3> dual_cross(const std::array<HyperDual, 3>& a, const std::array<HyperDual, 3>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
HyperDual smooth_step(const HyperDual& v, double from, double length) {
  const double t = std::clamp((v.a - from) / length, 0.0, 1.0);
  return v.chain(t * t * t * (10 - 15 * t + 6 * t * t), 30 * t * t * (1 - t) * (1 - t) / length,
                 60 * t * (1 - t) * (1 - 2 * t) / (length * length));
}

// The formula of docs/effects/contact.md once more.
HyperDual value_again(const std::array<std::array<HyperDual, 3>, kPairNodes>& x, double offset) {
  const auto minus = [](const std::array<HyperDual, 3>& a, const std::array<HyperDual, 3>& b) {
    return std::array<HyperDual, 3>{a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  };
  const auto p = minus(x[1], x[0]), q = minus(x[5], x[4]), r = minus(x[0], x[4]), c = dual_cross(p, q);
  const HyperDual square = dual_dot(c, c), length = sqrt(square);
  // The first body is above.
  const double sign = c[2].a > 0 ? 1 : -1;
  HyperDual value = sign * (dual_dot(c, r) / length) - offset;
  value = value * smooth_step(square / (dual_dot(p, p) * dual_dot(q, q)), 0, 0.05);
  for (const auto& across : {q, p}) {
    const HyperDual place = -(dual_dot(dual_cross(r, across), c) / square);
    value = value * smooth_step(place, 0, 0.2) * smooth_step(1.0 - place, 0, 0.2);
  }
  for (const std::size_t k : {2u, 3u, 6u, 7u}) {
    const bool first = k < 4;
    const auto &edge = first ? p : q, side = minus(x[k], first ? x[0] : x[4]);
    const auto area = dual_cross(edge, side);
    const HyperDual height = sqrt(dual_dot(area, area) / dual_dot(edge, edge));
    value = value * smooth_step((first ? sign : -sign) * (dual_dot(c, side) / length / height), 0.03, 0.1);
  }
  return value;
}

HyperDual value_of(const Pair& x, double offset, std::size_t first, std::size_t second) {
  std::array<std::array<HyperDual, 3>, kPairNodes> dual;
  for (std::size_t i = 0; i < 3 * kPairNodes; ++i)
    dual[i / 3][i % 3] = {x[i / 3][static_cast<int>(i % 3)], i == first ? 1.0 : 0.0, i == second ? 1.0 : 0.0,
                          0};
  return value_again(dual, offset);
}

}  // namespace

TEST_CASE("distances of crossed edges: value, gradient and curvature against automatic differentiation") {
  struct Place {
    const char* what;
    double turn, slope, gap;
    Vec3 along;
    bool plain;
    double noise = 0.02;
  };
  const Place places[] = {{"crossing in the middle", 1.2, 0.6, -0.03, {}, true},
                          {"apart", 1.9, 0.6, 0.2, {0.1, 0.1, 0}, true},
                          {"near the end of one", 1.4, 0.8, -0.03, {0.4, 0, 0}, false},
                          {"near the ends of both", 1.1, 0.8, -0.02, {0.38, 0.41, 0}, false},
                          {"almost parallel", 0.15, 0.7, -0.02, {0, 0, 0}, false},
                          {"almost flat", 1.3, 0.09, -0.04, {}, false},
                          {"all of that", 0.18, 0.09, 0.03, {0.39, 0, 0}, false, 0.002}};
  for (const Place& place : places) {
    for (unsigned seed = 1; seed < 6; ++seed) {
      INFO(place.what << ", seed " << seed);
      const Pair x = crossed(place.turn, place.slope, place.gap, place.along, seed, place.noise);
      const double offset = 0.01;
      const EdgeGap gap = edge_gap(x, offset);
      CHECK(gap.weight > 0);
      CHECK(gap.plain == place.plain);
      const auto slope = edge_slopes(x, gap, offset);
      std::array<Mat3, kPairNodes*(kPairNodes + 1) / 2> blocks{};
      constexpr double factor = -1.7;
      add_edge_curvature(x, gap, offset, factor, blocks.data());
      CHECK(gap.value == Approx(value_of(x, offset, 0, 0).a));
      double wrong_slope = 0, wrong_curvature = 0, size = 1;
      for (std::size_t i = 0; i < 3 * kPairNodes; ++i) {
        for (std::size_t j = 0; j < 3 * kPairNodes; ++j) {
          const HyperDual v = value_of(x, offset, i, j);
          const std::size_t k = i / 3, l = j / 3;
          wrong_slope = std::max(wrong_slope, std::abs(slope[k][static_cast<int>(i % 3)] - v.b));
          if (l > k) continue;
          const double found = blocks[k * (k + 1) / 2 + l](static_cast<int>(i % 3), static_cast<int>(j % 3));
          wrong_curvature = std::max(wrong_curvature, std::abs(found - factor * v.d));
          size = std::max(size, std::abs(factor * v.d));
        }
      }
      CHECK(wrong_slope < 1e-10);
      CHECK(wrong_curvature < 1e-9 * size);
      // And against differences, along a line.
      std::mt19937 random(seed);
      std::uniform_real_distribution<double> unit(-1, 1);
      Pair up = x, down = x;
      double expected = 0;
      const double h = 1e-6;
      for (std::size_t i = 0; i < kPairNodes; ++i) {
        const Vec3 d{unit(random), unit(random), unit(random)};
        up[i] += h * d;
        down[i] -= h * d;
        expected += dot(slope[i], d);
      }
      const double difference = (edge_gap(up, offset).value - edge_gap(down, offset).value) / (2 * h);
      CHECK(difference == Approx(expected).margin(1e-7));
    }
  }
}

TEST_CASE("edges count where they would meet, and fade out smoothly where they would not") {
  const auto weight = [](double turn, double slope, const Vec3& along = {}) {
    return edge_gap(crossed(turn, slope, -0.02, along), 0).weight;
  };
  CHECK(weight(1.2, 0.6) == 1);
  CHECK(weight(0.0, 0.6) == 0);                // parallel
  CHECK(weight(1.2, 0.0) == 0);                // flat on each other
  CHECK(weight(1.2, -0.6) == 0);               // grooves
  CHECK(weight(1.2, 0.6, {0.55, 0, 0}) == 0);  // beyond an end
  // The sign is that of the sides that the surfaces turn to each other, whichever way edges run.
  Pair x = crossed(1.2, 0.6, 0.1);
  CHECK(edge_gap(x, 0).distance == Approx(0.1));
  std::swap(x[0], x[1]);
  std::swap(x[2], x[3]);
  CHECK(edge_gap(x, 0).distance == Approx(0.1));
  CHECK(edge_gap(x, 0).normal.z == Approx(1));
  // Through parallel, along an edge and over flat: forces (slopes of the value) without a jump.
  struct Sweep {
    const char* what;
    std::function<Pair(double)> at;
  };
  const Sweep sweeps[] = {{"turn",
                           [](double t) {
                             return crossed(0.6 * t, 0.6, -0.02, {0.02, 0.01, 0});
                           }},
                          {"slide",
                           [](double t) {
                             return crossed(1.2, 0.6, -0.02, {0.8 * t, 0.1, 0});
                           }},
                          {"flatten", [](double t) { return crossed(1.2, 0.3 * t, -0.02); }}};
  for (const Sweep& sweep : sweeps) {
    INFO(sweep.what);
    const int steps = 4000;
    double jump = 0, most = 0;
    std::array<Vec3, kPairNodes> before{};
    for (int k = -steps; k <= steps; ++k) {
      const Pair now = sweep.at(static_cast<double>(k) / steps);
      const EdgeGap gap = edge_gap(now, 0);
      const auto slope = edge_slopes(now, gap, 0);
      REQUIRE(std::isfinite(gap.value));
      for (std::size_t i = 0; i < kPairNodes; ++i) {
        REQUIRE(std::isfinite(dot(slope[i], slope[i])));
        const Vec3 d = slope[i] - before[i];
        if (k > -steps) jump = std::max(jump, std::sqrt(dot(d, d)));
        most = std::max(most, std::sqrt(dot(slope[i], slope[i])));
      }
      before = slope;
    }
    CHECK(most > 0.2);
    CHECK(jump < 0.01 * most);
  }
  // Parallel to the last bit, without length, without triangles.
  Pair none{};
  CHECK(edge_gap(none, 0).value == 0);
  none[1] = none[5] = {1, 0, 0};
  CHECK(edge_gap(none, 0).value == 0);
}

TEST_CASE("edges go through each other from outside when they do") {
  const auto time = [](const Pair& start, const Pair& end) { return edge_crossing_time(start, end); };
  CHECK(time(crossed(1.2, 0.6, 1), crossed(1.2, 0.6, -3)) == Approx(0.25));
  CHECK(time(crossed(2.2, 0.6, 0.5), crossed(2.2, 0.6, -100)) == Approx(0.5 / 100.5));
  CHECK(time(crossed(1.2, 0.6, 1), crossed(1.2, 0.6, 0.1)) == kNever);   // stay apart
  CHECK(time(crossed(1.2, 0.6, -1), crossed(1.2, 0.6, 2)) == kNever);    // from inside
  CHECK(time(crossed(1.2, -0.6, 1), crossed(1.2, -0.6, -2)) == kNever);  // grooves
  CHECK(time(crossed(1.2, 0.6, 1, {0.6, 0, 0}), crossed(1.2, 0.6, -3, {0.6, 0, 0})) == kNever);  // beside
  // The place counts at the time of crossing, not before or after.
  CHECK(time(crossed(1.2, 0.6, 1, {-4, 0, 0}), crossed(1.2, 0.6, -1, {4, 0, 0})) == Approx(0.5));
}

namespace {

// A bar of square cross-section that stands on edge: a ridge along x at z = 0, up, or, `upper`, along y and
// down.
Mesh bar(double length, double width, std::array<int, 2> cells, bool upper, const Vec3& shift = {}) {
  return test::mapped(test::box({cells[0], cells[1], cells[1]}), [&](const Vec3& p) {
    const double w = width / std::sqrt(2.0), x = (p.x - 0.5) * length;
    const Vec3 ridge{x, w * (p.y - p.z), w * (p.y + p.z - 2)};
    return upper ? Vec3{ridge.y, ridge.x, -ridge.z} + shift : ridge;
  });
}

double of(const World& world, const std::string& quantity) {
  return test::gauge(world, quantity);
}

EffectId touch(World& world, BodyId body, BodyId against, double friction = 0,
               std::optional<double> compliance = {}, FrictionCoupling coupling = FrictionCoupling::lagged) {
  SurfaceContactDef def;
  def.body = body;
  def.against = against;
  def.friction = friction;
  def.compliance = compliance;
  def.coupling = coupling;
  return test::value(world.add(surface_contact(def)));
}

// Ridges that cross between the points of both: at a quarter of an edge.
constexpr double kWidth = 0.3, kLength = 1;
constexpr int kCells = 5;
constexpr Vec3 kQuarter{0.05, 0.05, 0};

struct Crossing {
  World world;
  BodyId lower{}, upper{};
};
Crossing pressed(double depth, double compliance, double friction = 0, const Vec3& slide = {},
                 FrictionCoupling coupling = FrictionCoupling::lagged) {
  Crossing s{test::make_world(test::static_options()), {}, {}};
  const auto material = test::neo_hookean(1e5, 0.3);
  s.lower = test::add_body(s.world, bar(kLength, kWidth, {kCells, 2}, false), Element::tet4, material, 1000,
                           "lower");
  s.upper = test::add_body(s.world, bar(kLength, kWidth, {kCells, 2}, true, kQuarter + Vec3{0, 0, 1e-4}),
                           Element::tet4, material, 1000, "upper");
  test::hold(s.world, s.lower, {"y0", "z0"});
  test::hold(s.world, s.upper, {"y0", "z0"}, {}, Vec3{0, 0, -depth} + slide);
  touch(s.world, s.lower, s.upper, friction, compliance, coupling);
  return s;
}

}  // namespace

TEST_CASE("two bars pressed together edge on edge hold a force, as deep as their layer is soft") {
  const double compliance = 2e-8;
  Crossing s = pressed(0.01, compliance);
  for (int step = 0; step < 4; ++step) {
    test::must_advance(s.world, 0.25);
    const double force = of(s.world, "normal_force"), depth = -of(s.world, "smallest_gap");
    INFO("force " << force << " N, depth " << depth << " m");
    CHECK(force > 1 * (step + 1));
    CHECK(of(s.world, "force_z") == Approx(-force).epsilon(0.03));
    CHECK(of(s.world, "contact_area") == 0);  // no point of either touches
    // A third of the two triangles at an edge, each a half of a rectangle of the surface.
    const double area = kLength / kCells * kWidth / 2 / 3;
    CHECK(depth == Approx(force / area * compliance).epsilon(0.02));
    // A quarter of an edge deep without rows of their own.
    CHECK(depth < 0.1 * 0.25 * kLength / kCells);
  }
}

TEST_CASE("edges that cross rub") {
  const double mu = 0.3;
  for (const double slide : {0.0005, 0.02}) {
    Crossing s = pressed(0.01, 2e-8, mu, {slide, 0, 0});
    for (int step = 0; step < 4; ++step) test::must_advance(s.world, 0.25);
    const double normal = of(s.world, "normal_force"), rub = of(s.world, "friction_force");
    INFO("slide " << slide << ", normal " << normal << ", friction " << rub);
    CHECK(normal > 4);
    CHECK(rub <= mu * normal * (1 + 1e-6));
    if (slide > 0.01)
      CHECK(rub == Approx(mu * normal).epsilon(0.01));
    else
      CHECK(rub < 0.9 * mu * normal);
    // The upper bar drags the lower one along; the normal is not quite upright.
    CHECK(of(s.world, "force_x") == Approx(rub).margin(0.03 * normal));
  }
}

TEST_CASE("coupled friction of edges ends where lagged friction does") {
  for (const double slide : {0.0005, 0.02}) {
    Crossing lagged = pressed(0.01, 2e-8, 0.3, {slide, 0, 0}),
             coupled = pressed(0.01, 2e-8, 0.3, {slide, 0, 0}, FrictionCoupling::coupled);
    int lagged_work = 0, coupled_work = 0;
    for (int step = 0; step < 4; ++step) {
      const StepReport a = test::must_advance(lagged.world, 0.25),
                       b = test::must_advance(coupled.world, 0.25);
      lagged_work += a.iterations + a.corrections;
      coupled_work += b.iterations + b.corrections;
      double apart = 0;
      for (const BodyId body : {lagged.lower, lagged.upper}) {
        const auto x = lagged.world.positions(body), y = coupled.world.positions(BodyId{body.number()});
        for (std::size_t i = 0; i < x.size(); ++i) {
          const Vec3 d = x[i] - y[i];
          apart = std::max(apart, std::sqrt(dot(d, d)));
        }
      }
      CHECK(apart < 1e-8 * kLength);
    }
    INFO("slide " << slide << ": " << lagged_work << " solves lagged, " << coupled_work << " coupled");
    // 38 where the edges do not say how their friction changes.
    CHECK(coupled_work < 33);
    CHECK(lagged_work < 50);
  }
}

namespace {

// The lower one at rest, the upper one on its way down.
struct Flight {
  double speed = 1, young = 5e4, density = 100, width = kWidth;
  int across = 2, threads = 1;
  double friction = 0;
  Vec3 shift = kQuarter + Vec3{0, 0, 0.01};
  bool held = false;  // the ends of the lower one; those of the upper one come straight down
};
constexpr double kSoft = 1e-7;  // compliance of bars of 50 kPa [m/Pa]
Crossing flying(const Flight& f) {
  WorldOptions options = test::dynamic_options();
  options.threads = f.threads;
  Crossing s{test::make_world(options), {}, {}};
  const auto material = test::neo_hookean(f.young, 0.45);
  s.lower = test::add_body(s.world, bar(kLength, f.width, {kCells, f.across}, false), Element::tet4, material,
                           f.density, "lower");
  s.upper = test::add_body(s.world, bar(kLength, f.width, {kCells, f.across}, true, f.shift), Element::tet4,
                           material, f.density, "upper");
  if (f.held) {
    test::hold(s.world, s.lower, {"x0", "x1"});
    test::hold(s.world, s.upper, {"x0", "x1"}, {{1, 0, 0}, {0, 1, 0}});
  }
  touch(s.world, s.lower, s.upper, f.friction, kSoft * 5e4 / f.young);
  const std::vector<Vec3> v(s.world.rest_positions(s.upper).size(), Vec3{0, 0, -f.speed});
  REQUIRE(s.world.set_velocities(s.upper, v));
  return s;
}

double height(const Crossing& s) {
  return s.world.measures(s.upper).center_of_mass.z - s.world.measures(s.lower).center_of_mass.z;
}

}  // namespace

TEST_CASE("bars that collide edge on edge keep momentum, gain no energy and part again") {
  for (const double friction : {0.0, 0.4}) {
    Flight flight;
    flight.friction = friction;
    Crossing s = flying(flight);
    const auto center = [&] {
      return 0.5 * (s.world.measures(s.lower).center_of_mass + s.world.measures(s.upper).center_of_mass);
    };
    const Vec3 before = center();
    const double h = 2e-3, apart = height(s);
    // Depth over force of a pair of edges, as above.
    const double area = kLength / kCells * kWidth / 2 / 3;
    double energy = s.world.kinetic_energy(), largest = 0;
    for (int step = 0; step < 60; ++step) {
      test::must_advance(s.world, h);
      const double now = s.world.kinetic_energy() + s.world.elastic_energy();
      INFO("friction " << friction << ", step " << step);
      CHECK(now <= energy * (1 + 1e-6));
      energy = now;
      const double force = of(s.world, "normal_force"), gap = of(s.world, "smallest_gap");
      if (std::isfinite(gap)) CHECK(gap >= -1.02 * force / area * kSoft - 1e-9);
      largest = std::max(largest, force);
    }
    CHECK(largest > 5);
    CHECK(of(s.world, "normal_force") == 0);
    CHECK(height(s) > 0.5 * apart);
    const Vec3 drift = center() - before + Vec3{0, 0, 0.5 * 60 * h};
    CHECK(std::sqrt(dot(drift, drift)) < 1e-7);
  }
}

TEST_CASE("edges that cross stop each other at a hundred elements a step") {
  // So thin, and crossing at such a place, that no point of the one meets a face of the other.
  Flight flight;
  flight.speed = 2000;
  flight.young = 1e9;  // the bars are thin
  flight.density = 0.01;
  flight.width = 0.03;
  flight.across = 1;
  flight.shift = {0.07, 0.07, 0.3};
  flight.held = true;
  Crossing s = flying(flight);
  for (int step = 0; step < 5; ++step) {
    test::must_advance(s.world, 0.01);
    CHECK(height(s) > 0);
    CHECK(of(s.world, "smallest_gap") > -0.02);
  }
}

TEST_CASE("edges: the same bits on any number of threads, after a checkpoint, and after a rejected step") {
  Flight flight;
  flight.friction = 0.3;
  Crossing one = flying(flight), other = flying(flight);
  flight.threads = 2;
  Crossing two = flying(flight);
  std::vector<std::byte> saved;
  bool touched = false;
  for (int step = 0; step < 20; ++step) {
    if (step == 8) saved = one.world.save();
    if (step == 12) {
      const std::uint64_t hash = two.world.state_hash();
      two.world.on_progress([&](const ProgressInfo&) { two.world.cancel(); });
      CHECK(two.world.step(0.05).status == StepStatus::cancelled);
      two.world.on_progress(nullptr);
      CHECK(two.world.state_hash() == hash);
    }
    one.world.advance(2e-3);
    two.world.advance(2e-3);
    touched = touched || (step >= 7 && step <= 12 && of(one.world, "friction_force") > 0);
    REQUIRE(one.world.state_hash() == two.world.state_hash());
  }
  CHECK(touched);
  REQUIRE(other.world.load(saved));
  for (int step = 8; step < 20; ++step) other.world.advance(2e-3);
  CHECK(other.world.state_hash() == one.world.state_hash());
}

TEST_CASE("edges that are past each other at the start are refused, or pushed apart") {
  const auto make = [](InitialOverlap choice) {
    World world = test::make_world(test::dynamic_options());
    const auto material = test::neo_hookean(5e4, 0.3);
    const BodyId a = test::add_body(world, bar(kLength, kWidth, {kCells, 2}, false), Element::tet4, material,
                                    1000, "lower");
    const BodyId b =
        test::add_body(world, bar(kLength, kWidth, {kCells, 2}, true, kQuarter + Vec3{0, 0, -0.02}),
                       Element::tet4, material, 1000, "upper");
    SurfaceContactDef def;
    def.body = a;
    def.against = b;
    def.initial_overlap = choice;
    def.resolve_time = 0.2;
    test::value(world.add(surface_contact(def)));
    return world;
  };
  World refused = make(InitialOverlap::report);
  const auto compiled = refused.compile();
  REQUIRE(!compiled);
  INFO(compiled.error());
  CHECK(compiled.error().find("edges are past others that they cross") != std::string::npos);
  CHECK(compiled.error().find("of body \"lower\"") != std::string::npos);
  CHECK(compiled.error().find("set initial_overlap to resolve") != std::string::npos);
  World resolved = make(InitialOverlap::resolve);
  test::must_advance(resolved, 0.01);
  CHECK(of(resolved, "smallest_gap") < -0.015);
  for (int step = 0; step < 25; ++step) test::must_advance(resolved, 0.01);
  CHECK(of(resolved, "smallest_gap") > -1e-3);
}

TEST_CASE("edges of a surface are those that bulge between faces, on both sides") {
  BoxMeshDef def;
  def.divisions = {2, 2, 2};
  const Mesh cube = test::value(box_mesh(def));
  std::array<SurfaceFaces, 2> sides;
  for (const auto& surface : cube.surfaces) {
    for (std::size_t f = 0; f < surface.faces.size(); f += 3) {
      std::array<Index, 3> c{surface.faces[f], surface.faces[f + 1], surface.faces[f + 2]};
      const Vec3 a = cube.nodes[at(c[0])];
      const Vec3 n = cross(cube.nodes[at(c[1])] - a, cube.nodes[at(c[2])] - a);
      if (dot(n, a - Vec3{0.5, 0.5, 0.5}) < 0) std::swap(c[1], c[2]);
      sides[0].faces.insert(sides[0].faces.end(), c.begin(), c.end());
    }
  }
  const auto flat = [&](double z) {
    std::vector<Vec3> x = cube.nodes;
    for (Vec3& p : x) p.z *= z;
    return x;
  };
  const ContactSurface surface(sides, cube.nodes);
  const SurfaceEdges edges(surface, cube.nodes);
  CHECK(edges.count() == 24);
  double area = 0;
  for (Index e = 0; e < edges.count(); ++e) area += edges[e].area;
  CHECK(area == Approx(24.0 * 2 * 0.125 / 3));
  // Twelve bars meet at no place of a single cube.
  std::vector<SurfaceEdges::Finding> found(24);
  const std::vector<Index> none(24, -1);
  edges.search(cube.nodes, flat(0.9), 0.3, 0, none, nullptr, found);
  for (const auto& f : found) CHECK((f.deepest < 0 && f.crossed < 0));
}
