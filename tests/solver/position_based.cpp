// Position-based dynamics on the same stencils and rows: what it keeps exactly, and how far from the implicit
// step it ends.
#include "engine/solve/position_based.h"

#include <cmath>

#include "support/worlds.h"

namespace {

using namespace isochor;

struct Moved {
  StepReport report;
  std::vector<Vec3> x, v;
  std::uint64_t hash = 0;
};

struct Trial {
  Method method = Method::position_based;
  int sweeps = 20, threads = 1, steps = 10;
  double h = 1e-3, poisson = 0.49;
  bool held = true;
  Vec3 gravity{0, 0, -9.81};
};

Moved move(const Trial& trial) {
  BoxMeshDef box;
  box.upper = {0.2, 0.05, 0.05};
  box.divisions = {8, 2, 2};
  WorldOptions options = test::dynamic_options();
  options.method = trial.method;
  options.sweeps = trial.sweeps;
  options.threads = trial.threads;
  options.gravity = trial.gravity;
  World world = test::make_world(options);
  const BodyId body = test::add_body(world, test::value(box_mesh(box)), Element::tet4,
                                     test::neo_hookean(100e3, trial.poisson));
  VolumeDef rows;
  rows.body = body;
  test::value(world.add(volume(rows)));
  if (trial.held) {
    test::hold(world, body, {"x0"});
  } else {
    // Stretched by a tenth along x, to be let go.
    std::vector<Vec3> x(world.rest_positions(body).begin(), world.rest_positions(body).end());
    for (Vec3& p : x) p.x *= 1.1;
    REQUIRE(world.set_positions(body, x));
  }
  Moved out;
  for (int k = 0; k < trial.steps; ++k) {
    out.report = world.step(trial.h);
    INFO(out.report.reason);
    REQUIRE(out.report.status == StepStatus::converged);
  }
  out.x.assign(world.positions(body).begin(), world.positions(body).end());
  out.v.assign(world.velocities(body).begin(), world.velocities(body).end());
  out.hash = world.state_hash();
  return out;
}

double distance(const Moved& a, const Moved& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.x.size(); ++i) {
    const Vec3 d = a.x[i] - b.x[i];
    most = std::max(most, std::sqrt(dot(d, d)));
  }
  return most;
}

}  // namespace

TEST_CASE("more sweeps come closer to the implicit step") {
  Trial exact;
  exact.method = Method::saddle_point;
  const Moved reference = move(exact);
  Trial trial;
  std::vector<double> errors;
  for (const int sweeps : {5, 40, 320}) {
    trial.sweeps = sweeps;
    errors.push_back(distance(reference, move(trial)));
  }
  INFO(errors[0] << " " << errors[1] << " " << errors[2]);
  const double fallen = 0.5 * 9.81 * 0.01 * 0.01;  // what gravity does in that time
  CHECK(errors[1] < errors[0]);
  CHECK(errors[2] < 0.05 * fallen);
}

TEST_CASE("position-based steps carry a rigid body like any other") {
  Trial trial;
  trial.held = false;
  trial.gravity = {};
  const Moved moved = move(trial);
  // It starts stretched and springs back; what is inside cannot move its center, nor turn it.
  Vec3 sum{};
  double fastest = 0;
  for (const Vec3& v : moved.v) fastest = std::max(fastest, std::sqrt(dot(v, v)));
  BoxMeshDef box;
  box.upper = {0.2, 0.05, 0.05};
  box.divisions = {8, 2, 2};
  const Mesh mesh = test::value(box_mesh(box));
  for (Index c = 0; c < mesh.cell_count(); ++c) {
    std::array<Vec3, 4> p{};
    for (std::size_t a = 0; a < 4; ++a) {
      const auto n = static_cast<std::size_t>(mesh.cells[4 * static_cast<std::size_t>(c) + a]);
      p[a] = {mesh.nodes[n].x, mesh.nodes[n].y, mesh.nodes[n].z};
    }
    const Vec3 a = p[1] - p[0], b = p[2] - p[0], d = p[3] - p[0];
    const double volume =
        (a.x * (b.y * d.z - b.z * d.y) - a.y * (b.x * d.z - b.z * d.x) + a.z * (b.x * d.y - b.y * d.x)) / 6;
    for (std::size_t k = 0; k < 4; ++k)
      sum += (volume / 4 / 5e-4) *
             moved.v[static_cast<std::size_t>(mesh.cells[4 * static_cast<std::size_t>(c) + k])];
  }
  CHECK(fastest > 0.01);
  CHECK(std::sqrt(dot(sum, sum)) < 1e-10 * fastest);
}

TEST_CASE("position-based steps give the same bits at any thread count") {
  Trial trial;
  trial.poisson = 0.5;
  const Moved one = move(trial);
  for (const int threads : {2, 4}) {
    trial.threads = threads;
    CHECK(move(trial).hash == one.hash);
  }
}

TEST_CASE("what has no place in position-based steps is refused") {
  WorldOptions options = test::static_options();
  options.method = Method::position_based;
  World world = test::make_world(options);
  const BodyId body =
      test::add_body(world, test::value(box_mesh({})), Element::tet4, test::neo_hookean(100e3, 0.45));
  test::hold(world, body, {"x0"});
  const auto compiled = world.compile();
  REQUIRE_FALSE(compiled);
  CHECK(compiled.error().find("statics has none") != std::string::npos);

  options = test::dynamic_options();
  options.sweeps = 0;
  const auto none = World::create(options);
  REQUIRE_FALSE(none);
  CHECK(none.error().find("sweeps = 0") != std::string::npos);
}
