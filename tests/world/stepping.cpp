// Paths through limit points, jumps, steps within a budget, control of the time error, the mass matrices.
#include <algorithm>
#include <cmath>

#include "support/worlds.h"

namespace {

using namespace isochor;

constexpr double kPi = 3.14159265358979323846;

// A shallow arch, clamped at both ends, under its weight times the load factor.
struct Arch {
  World world;
  BodyId body{};
  explicit Arch(WorldOptions options, double gravity)
      : world(test::make_world([&] {
          options.gravity = {0, 0, -gravity};
          options.gravity_curve = Curve::ramp(10, 10);
          return options;
        }())) {
    BoxMeshDef def;
    def.upper = {1, 0.05, 0.03};
    def.divisions = {24, 1, 2};
    Mesh mesh = test::value(box_mesh(def));
    for (Vec3& x : mesh.nodes) x.z += 0.08 * std::sin(kPi * x.x);
    body = test::add_body(world, std::move(mesh), Element::tet4_edge_smoothed, test::neo_hookean(1e6, 0.5));
    test::add_volume(world, body);
    test::hold(world, body, {"x0", "x1"});
  }
  double crown() const {
    double sum = 0;
    int count = 0;
    const auto X = world.rest_positions(body), x = world.positions(body);
    for (std::size_t i = 0; i < X.size(); ++i) {
      if (std::abs(X[i].x - 0.5) > 1e-9) continue;
      sum += x[i].z - X[i].z;
      ++count;
    }
    REQUIRE(count > 0);
    return sum / count;
  }
};

constexpr double kArchGravity = 60;  // beyond the limit point at a load factor of 1

}  // namespace

TEST_CASE("a path of equilibria goes through two limit points of an arch") {
  WorldOptions options = test::static_options();
  options.scheme = continuation();
  Arch arch(options, kArchGravity);
  std::vector<double> t, crown;
  std::vector<Index> unstable;
  for (int k = 0; k < 60 && (t.empty() || t.back() < 1); ++k) {
    const StepReport r = arch.world.follow(0.01);
    INFO(k << ": " << r.reason);
    REQUIRE(r.status == StepStatus::converged);
    CHECK(r.force_residual < 1e-8);
    t.push_back(arch.world.time());
    crown.push_back(arch.crown());
    unstable.push_back(r.unstable_directions);
    INFO("t " << t.back() << " crown " << crown.back() << " unstable " << unstable.back() << " it "
              << r.iterations);
    CHECK(arch.world.measures(arch.body).volume_error < 1e-9);
  }
  const auto peak = std::max_element(t.begin(), t.end() - 1);
  const auto peak_at = static_cast<std::size_t>(
      std::find_if(t.begin() + 1, t.end(), [&](const double& v) { return v < *(&v - 1); }) - t.begin());
  REQUIRE(peak_at < t.size());
  const auto valley_at = static_cast<std::size_t>(
      std::min_element(t.begin() + static_cast<std::ptrdiff_t>(peak_at), t.end()) - t.begin());
  INFO("peak " << t[peak_at - 1] << " at " << crown[peak_at - 1] << ", valley " << t[valley_at] << " at "
               << crown[valley_at] << ", largest before the end " << *peak);
  CHECK(t.back() >= 1);
  CHECK(t[valley_at] < 0.8 * t[peak_at - 1]);
  // Stable up to the first limit point, unstable between, stable behind the second.
  for (std::size_t k = 0; k + 2 < peak_at; ++k) CHECK(unstable[k] == 0);
  for (std::size_t k = peak_at + 1; k + 1 < valley_at; ++k) CHECK(unstable[k] > 0);
  CHECK(unstable.back() == 0);
  // The crown goes down all the way.
  for (std::size_t k = 1; k < crown.size(); ++k) CHECK(crown[k] < crown[k - 1]);

  // Under fixed loads the arch jumps to the far branch, through a damped motion.
  Arch jump(test::static_options(), kArchGravity);
  const StepReport r = jump.world.advance(t.back());
  INFO(r.reason);
  REQUIRE(r.status == StepStatus::converged);
  INFO("rescues " << r.rescues << ", substeps " << r.substeps << ", iterations " << r.iterations);
  CHECK(jump.crown() == Approx(crown.back()).epsilon(1e-6));
}

namespace {

// A quarter of a shallow cap over a square, its rim clamped, under its weight times the load factor.
struct Cap {
  World world;
  BodyId body{};
  Cap() : world(test::make_world(options())) {
    BoxMeshDef def;
    def.upper = {0.5, 0.5, 0.02};
    def.divisions = {7, 7, 2};
    Mesh mesh = test::value(box_mesh(def));
    for (Vec3& x : mesh.nodes) x.z += 0.09 * std::sin(kPi * x.x) * std::sin(kPi * x.y);
    body = test::add_body(world, std::move(mesh), Element::tet4_edge_smoothed, test::neo_hookean(1e6, 0.5));
    test::add_volume(world, body);
    test::hold(world, body, {"x0", "y0"});
    test::hold(world, body, {"x1"}, {{1, 0, 0}});
    test::hold(world, body, {"y1"}, {{0, 1, 0}});
  }
  static WorldOptions options() {
    WorldOptions o = test::static_options();
    o.scheme = continuation();
    o.gravity = {0, 0, -10};
    o.gravity_curve = Curve::ramp(20, 20);
    return o;
  }
  double apex() const { return test::displacement_at(world, body, {0.5, 0.5, 0.11}).z; }
};

}  // namespace

TEST_CASE("a shallow shell snaps through, and every equilibrium of the path says whether it is stable") {
  Cap cap;
  std::vector<double> t, apex;
  std::vector<Index> unstable;
  // Until it has turned over and carries more again.
  for (int k = 0; k < 40 && (apex.empty() || apex.back() > -0.15); ++k) {
    const StepReport r = cap.world.follow(0.01);
    INFO(k << ": " << r.reason);
    REQUIRE(r.status == StepStatus::converged);
    t.push_back(cap.world.time());
    apex.push_back(cap.apex());
    unstable.push_back(r.unstable_directions);
    UNSCOPED_INFO("t " << t.back() << " apex " << apex.back() << " unstable " << unstable.back()
                       << " iterations " << r.iterations);
    CHECK(cap.world.measures(cap.body).volume_error < 1e-9);
  }
  const auto peak_at = static_cast<std::size_t>(
      std::find_if(t.begin() + 1, t.end(), [](const double& v) { return v < *(&v - 1); }) - t.begin());
  REQUIRE(peak_at < t.size());
  const auto valley_at = static_cast<std::size_t>(
      std::min_element(t.begin() + static_cast<std::ptrdiff_t>(peak_at), t.end()) - t.begin());
  REQUIRE(valley_at + 1 < t.size());
  CHECK(t[valley_at] < 0.6 * t[peak_at - 1]);
  CHECK(t.back() > 1.2 * t[valley_at]);
  // It snaps while the apex is above its support, and the valley comes behind the plane of the support.
  CHECK(apex[peak_at] > -0.06);
  CHECK(apex[valley_at] < -0.09);
  for (std::size_t k = 0; k + 2 < peak_at; ++k) CHECK(unstable[k] == 0);
  for (std::size_t k = peak_at + 1; k + 1 < valley_at; ++k) CHECK(unstable[k] > 0);
  CHECK(unstable.back() == 0);
}

TEST_CASE("without the damped motion the arch stops at its limit point, unchanged by what was tried") {
  WorldOptions options = test::static_options();
  options.transient_rescue = false;
  options.smallest_fraction = 1.0 / 16;
  options.max_iterations = 15;
  Arch arch(options, kArchGravity);
  const StepReport r = arch.world.advance(1);
  if (r.status == StepStatus::converged) {
    // Newton's line search may cross on its own.
    CHECK(arch.crown() < -0.1);
  } else {
    CHECK(r.status == StepStatus::rejected);
    CHECK(arch.world.time() < 1);
    CHECK(arch.crown() > -0.08);
  }
}

TEST_CASE("following needs its scheme and a length") {
  Arch plain(test::static_options(), 1);
  CHECK(plain.world.follow(0.01).status == StepStatus::invalid);
  CHECK(plain.world.follow(0.01).reason.find("continuation()") != std::string::npos);
  WorldOptions options = test::static_options();
  options.scheme = continuation();
  Arch arch(options, 1);
  CHECK(arch.world.follow(-1).status == StepStatus::invalid);
  options.method = Method::dual_ascent;
  Arch ascent(options, 1);
  CHECK(ascent.world.follow(0.01).reason.find("stable") != std::string::npos);
}

TEST_CASE("a path continues from a checkpoint with the same bits") {
  WorldOptions options = test::static_options();
  options.scheme = continuation();
  Arch a(options, kArchGravity), b(options, kArchGravity);
  for (int k = 0; k < 4; ++k) REQUIRE(a.world.follow(0.01).status == StepStatus::converged);
  REQUIRE(b.world.load(a.world.save()));
  for (int k = 0; k < 3; ++k) {
    REQUIRE(a.world.follow(0.01).status == StepStatus::converged);
    REQUIRE(b.world.follow(0.01).status == StepStatus::converged);
  }
  CHECK(a.world.state_hash() == b.world.state_hash());
}

namespace {

World dropped_beam(WorldOptions options, BodyId& body) {
  options.gravity = {0, 0, -9.81};
  World world = test::make_world(options);
  BoxMeshDef def;
  def.upper = {0.4, 0.05, 0.05};
  def.divisions = {8, 1, 1};
  body = test::add_body(world, test::value(box_mesh(def)), Element::tet4_edge_smoothed,
                        test::neo_hookean(50e3, 0.5));
  test::add_volume(world, body);
  test::hold(world, body, {"x0"});
  return world;
}

double tip(const World& world, BodyId body) {
  return test::displacement_at(world, body, {0.4, 0.05, 0.05}).z;
}

}  // namespace

TEST_CASE("a step within a budget keeps its best iterate and says what is left") {
  BodyId body;
  World world = dropped_beam(test::dynamic_options(), body);
  const StepReport one = world.step(0.1, {1, 0});
  CHECK(one.status == StepStatus::unfinished);
  CHECK(one.reason.find("budget") != std::string::npos);
  CHECK(world.time() == Approx(0.1));
  CHECK(one.iterations == 1);
  CHECK(one.force_residual > 1e-9);
  CHECK(tip(world, body) < 0);
  const StepReport enough = world.step(0.1, {40, 0});
  CHECK(enough.status == StepStatus::converged);
  CHECK(enough.force_residual < 1e-8);
  const StepReport no_time = world.step(0.1, {0, 1e-9});
  CHECK(no_time.iterations <= 1);
  CHECK((no_time.status == StepStatus::unfinished || no_time.status == StepStatus::rejected ||
         no_time.status == StepStatus::converged));
  CHECK(world.step(0.1, {-1, 0}).status == StepStatus::invalid);
  // A long run of meager steps stays finite and near the full one.
  BodyId whole;
  World meager = dropped_beam(test::dynamic_options(), body),
        full = dropped_beam(test::dynamic_options(), whole);
  for (int k = 0; k < 40; ++k) {
    const StepStatus status = meager.step(0.02, {2, 0}).status;
    REQUIRE((status == StepStatus::unfinished || status == StepStatus::converged));
    REQUIRE(full.step(0.02).status == StepStatus::converged);
  }
  CHECK(tip(meager, body) == Approx(tip(full, whole)).epsilon(0.02));
}

TEST_CASE("control of the time error makes no increments shorter than the smallest") {
  BodyId body;
  WorldOptions options = test::dynamic_options();
  options.time_error = 1e-12;
  options.smallest_fraction = 1.0 / 32;
  World world = dropped_beam(options, body);
  for (int step = 0; step < 2; ++step) {
    const StepReport r = world.advance(0.02);
    INFO(r.reason);
    REQUIRE(r.status == StepStatus::converged);
    CHECK(r.substeps <= 64);
    CHECK(r.time_error > 1e-12);
  }
}

TEST_CASE("control of the time error takes as many increments as the tolerance asks") {
  BodyId body;
  const auto run = [&](const SchemePtr& scheme, double tolerance, StepReport& report) {
    WorldOptions options = test::dynamic_options();
    options.scheme = scheme;
    options.time_error = tolerance;
    options.smallest_fraction = 1.0 / 4096;
    World world = dropped_beam(options, body);
    report = world.advance(0.2);
    INFO(report.reason);
    REQUIRE(report.status == StepStatus::converged);
    CHECK(world.time() == Approx(0.2));
    return tip(world, body);
  };
  World even = dropped_beam(
      [] {
        WorldOptions options = test::dynamic_options();
        options.scheme = generalized_alpha(1);
        return options;
      }(),
      body);
  for (int k = 0; k < 1000; ++k) REQUIRE(even.step(0.0002).status == StepStatus::converged);
  const double reference = tip(even, body);
  for (const SchemePtr& scheme : {generalized_alpha(0.8), bdf2()}) {
    StepReport coarse, fine, finest;
    const double a = run(scheme, 1e-3, coarse), b = run(scheme, 1e-5, fine), c = run(scheme, 1e-7, finest);
    INFO("increments " << coarse.substeps << " " << fine.substeps << " " << finest.substeps << ", tips " << a
                       << " " << b << " " << c << " of " << reference);
    CHECK(coarse.substeps < fine.substeps);
    CHECK(fine.substeps < finest.substeps);
    CHECK(finest.time_error <= 1e-7);
    CHECK(std::abs(a - reference) < 2e-2 * std::abs(reference));
    CHECK(std::abs(b - reference) < 5e-3 * std::abs(reference));
    CHECK(std::abs(c - reference) < 5e-4 * std::abs(reference));
  }
}

TEST_CASE("both mass matrices hold the same mass, and waves bracket the exact frequency") {
  // Axial vibration of a bar without lateral strain: lumped mass is too slow, consistent too fast.
  const auto period = [](bool consistent, Element element) {
    WorldOptions options = test::dynamic_options();
    options.scheme = generalized_alpha(1);
    options.consistent_mass = consistent;
    World world = test::make_world(options);
    BoxMeshDef def;
    def.upper = {0.4, 0.1, 0.1};
    def.divisions = {4, 1, 1};
    const BodyId body =
        test::add_body(world, test::value(box_mesh(def)), element, test::neo_hookean(1e4, 0), 1000);
    test::add_volume(world, body);
    test::hold(world, body, {"x0"});
    test::hold(world, body, {"y0", "y1", "z0", "z1"}, {{0, 1, 0}, {0, 0, 1}});
    TractionDef push;
    push.body = body;
    push.surface = "x1";
    push.traction = {1, 0, 0};
    push.amount = Curve::constant(1);
    test::value(world.add(traction(push)));
    // The tip starts at rest and comes back to where it began after one period: the time of its turning
    // point.
    double before = -1, here = 0, h = 0.004;
    for (int k = 1; k < 400; ++k) {
      REQUIRE(world.step(h).status == StepStatus::converged);
      const double next = test::displacement_at(world, body, {0.4, 0.1, 0.1}).x;
      if (here > before && next < here && k > 3) {
        const double curvature = before - 2 * here + next;
        return 2 * h * (k - 1 + 0.5 * (before - next) / curvature);
      }
      before = here;
      here = next;
    }
    FAIL("no turning point");
    return 0.0;
  };
  const double exact = 4 * 0.4 / std::sqrt(1e4 / 1000.0);  // quarter wave in the bar
  const double lumped = period(false, Element::tet4), consistent = period(true, Element::tet4);
  INFO("lumped " << lumped << ", consistent " << consistent << ", exact " << exact);
  CHECK(lumped != consistent);
  CHECK(std::abs(lumped / exact - 1) < 0.1);
  CHECK(std::abs(consistent / exact - 1) < 0.1);
}

TEST_CASE("free fall with a consistent mass is rigid, of every element") {
  for (const Element element : {Element::tet4, Element::tet4_edge_smoothed, Element::tet10}) {
    WorldOptions options = test::dynamic_options();
    options.gravity = {0, 0, -10};
    options.consistent_mass = true;
    World world = test::make_world(options);
    const BodyId body =
        test::add_body(world, test::value(box_mesh({})), element, test::neo_hookean(1e4, 0.5), 1000);
    test::add_volume(world, body);
    for (int k = 0; k < 10; ++k) REQUIRE(world.step(0.01).status == StepStatus::converged);
    for (const Vec3& v : world.velocities(body)) {
      CHECK(v.z == Approx(-1).epsilon(1e-7));
      CHECK(std::abs(v.x) < 1e-8);
    }
    CHECK(world.kinetic_energy() == Approx(0.5 * 1000 * 1).epsilon(1e-7));
  }
}
