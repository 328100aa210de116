// Supports in three treatments, on bones, at embedded points; ties between bodies.
#include <cmath>
#include <cstdio>
#include <fstream>
#include <numbers>

#include "isochor/poses.h"
#include "support/worlds.h"

using namespace isochor;
using namespace test;

namespace {

struct Block {
  World world = make_world(static_options());
  BodyId body =
      add_body(world, box({4, 2, 2}, {0.2, 0.1, 0.1}), Element::tet4_edge_smoothed, neo_hookean(1e5, 0.49));
  Block() { add_volume(world, body); }
};

double largest_difference(const World& a, BodyId i, const World& b, BodyId j) {
  double worst = 0;
  for (std::size_t n = 0; n < a.positions(i).size(); ++n) {
    const Vec3 d = a.positions(i)[n] - b.positions(j)[n];
    worst = std::max(worst, std::sqrt(dot(d, d)));
  }
  return worst;
}

PoseTrack quarter_turn() {
  const double h = std::sqrt(0.5);
  return {{{0, {0.2, 0.05, 0.05}, {1, 0, 0, 0}}, {1, {0.21, 0.05, 0.05}, {h, h, 0, 0}}}};
}

DirichletDef on_end(BodyId body, SupportTreatment treatment, double stiffness = 0) {
  DirichletDef def;
  def.name = "end";
  def.where.body = body;
  def.where.surfaces = {"x1"};
  def.bone = quarter_turn();
  def.treatment = treatment;
  def.stiffness = stiffness;
  return def;
}

Vec3 force_gauge(const World& world, const std::string& effect) {
  Vec3 f{};
  for (const Gauge& g : world.gauges()) {
    if (g.effect != effect) continue;
    if (g.quantity == "force_x") f.x = g.value;
    if (g.quantity == "force_y") f.y = g.value;
    if (g.quantity == "force_z") f.z = g.value;
  }
  return f;
}

}  // namespace

TEST_CASE("rotations between keyframes go at constant speed, the shorter way") {
  const double h = std::sqrt(0.5);
  PoseTrack track{
      {{1, {0, 0, 0}, {1, 0, 0, 0}}, {2, {0, 0, 0}, {h, 0, 0, h}}, {4, {2, 0, 0}, {0, 0, 0, -1}}}};
  REQUIRE(check_poses(track).ok());
  const auto angle = [&](double t) {
    const Vec3 x = carried(track, t, {1, 0, 0}) - pose_at(track, t).position;
    CHECK(std::sqrt(dot(x, x)) == Approx(1).epsilon(1e-14));
    return std::atan2(x.y, x.x);
  };
  CHECK(angle(0) == 0);
  for (const double s : {0.25, 0.5, 0.8}) {
    CHECK(angle(1 + s) == Approx(0.5 * std::numbers::pi * s).epsilon(1e-12));
    // Given as -q: the shorter way is another quarter turn, not three back.
    CHECK(angle(2 + 2 * s) == Approx(0.5 * std::numbers::pi * (1 + s)).epsilon(1e-12));
    CHECK(pose_at(track, 2 + 2 * s).position.x == Approx(2 * s));
  }
  CHECK(pose_at(track, 9).position.x == 2);
}

TEST_CASE("poses are read from a table, and refused with line and remedy") {
  const std::string path = "poses_test.csv";
  const auto write = [&](const std::string& text) { std::ofstream(path) << text; };
  write(
      "t,x,y,z,qw,qx,qy,qz\n# a comment\n0,0,0,0,1,0,0,0\r\n\n0.5, 1, 2, 3, 0.70710678, 0, 0.70710678, 0\n");
  auto track = read_poses(path);
  REQUIRE(track.ok());
  REQUIRE(track.value().keys.size() == 2);
  CHECK(track.value().keys[1].position == Vec3{1, 2, 3});
  const auto& q = track.value().keys[1].rotation;
  CHECK(q[0] * q[0] + q[2] * q[2] == Approx(1).epsilon(1e-15));
  const auto refusal = [&](const std::string& text) {
    write(text);
    const auto r = read_poses(path);
    return r.ok() ? std::string() : r.error();
  };
  CHECK(refusal("0,0,0,0,1,0,0,0\n1,0,0\n").find("line 2: \"1,0,0\"; expected the eight numbers") !=
        std::string::npos);
  CHECK(refusal("0,0,0,0,1,0,0,0,9\n").find("line 1") != std::string::npos);
  CHECK(refusal("0,0,0,0,1,0,0,0\n0,0,0,0,1,0,0,0\n").find("list keyframes by ascending time") !=
        std::string::npos);
  CHECK(refusal("0,0,0,0,2,0,0,0\n").find("length 2") != std::string::npos);
  CHECK(refusal("0,0,0,0,nan,0,0,0\n").find("line 1") != std::string::npos);
  CHECK(refusal("t\n").find("no keyframe") != std::string::npos);
  std::remove(path.c_str());
  CHECK_FALSE(read_poses(path).ok());
}

TEST_CASE("multipliers hold like eliminated coordinates, springs approach them") {
  Block exact;
  hold(exact.world, exact.body, {"x0"});
  const EffectId end = value(exact.world.add(dirichlet(on_end(exact.body, SupportTreatment::eliminated))));
  must_advance(exact.world);
  const auto [force, moment] = exact.world.reaction(end);
  CHECK(std::abs(force.x) > 1);

  Block rows;
  hold(rows.world, rows.body, {"x0"});
  const EffectId by_multipliers =
      value(rows.world.add(dirichlet(on_end(rows.body, SupportTreatment::multiplier))));
  must_advance(rows.world);
  CHECK(largest_difference(exact.world, exact.body, rows.world, rows.body) < 1e-9);
  const Vec3 by_rows = force_gauge(rows.world, "end");
  for (int k = 0; k < 3; ++k) CHECK(by_rows[k] == Approx(force[k]).margin(1e-6 * std::abs(force.x)));
  // Whatever holds, it has a reaction.
  const auto same = rows.world.reaction(by_multipliers);
  for (int k = 0; k < 3; ++k) {
    CHECK(same[0][k] == Approx(force[k]).margin(1e-6 * std::abs(force.x)));
    CHECK(same[1][k] == Approx(moment[k]).margin(1e-6 * std::abs(force.x)));
  }

  double last = 1;
  for (const double stiffness : {1e5, 1e6, 1e7}) {
    Block soft;
    hold(soft.world, soft.body, {"x0"});
    const EffectId springs =
        value(soft.world.add(dirichlet(on_end(soft.body, SupportTreatment::stiffness, stiffness))));
    must_advance(soft.world);
    CHECK(soft.world.reaction(springs)[0].x == Approx(force.x).epsilon(0.3));
    const double away = largest_difference(exact.world, exact.body, soft.world, soft.body);
    CHECK(away < 0.2 * last);
    CHECK(away > 1e-9);
    last = away;
  }
  CHECK(last < 1e-4);
}

TEST_CASE("a support by rows may be all that holds a body, and a point may be anywhere in it") {
  Block b;
  DirichletDef def;
  def.name = "pins";
  def.where.body = b.body;
  def.points = {{0.03, 0.02, 0.07}, {0.11, 0.08, 0.02}, {0.17, 0.03, 0.05}};
  def.displacement = {0.01, 0, 0.02};
  def.amount = Curve::ramp(1);
  def.treatment = SupportTreatment::multiplier;
  value(b.world.add(dirichlet(def)));
  must_advance(b.world);
  // Three pins that move alike carry the body along unstrained.
  for (std::size_t i = 0; i < b.world.positions(b.body).size(); ++i) {
    const Vec3 d = b.world.positions(b.body)[i] - b.world.rest_positions(b.body)[i] - def.displacement;
    CHECK(std::sqrt(dot(d, d)) < 1e-9);
  }
}

TEST_CASE("a direction by rows leaves the others free") {
  Block b;
  DirichletDef def;
  def.name = "plane";
  def.where.body = b.body;
  def.where.surfaces = {"z0"};
  def.directions = {{0, 0, 1}};
  def.treatment = SupportTreatment::multiplier;
  value(b.world.add(dirichlet(def)));
  hold(b.world, b.body, {"x0"}, {{1, 0, 0}});
  hold(b.world, b.body, {"y0"}, {{0, 1, 0}});
  hold(b.world, b.body, {"x1"}, {{1, 0, 0}}, {0.02, 0, 0});
  must_advance(b.world);
  const Vec3 u = displacement_at(b.world, b.body, {0.2, 0.1, 0});
  CHECK(std::abs(u.z) < 1e-12);
  CHECK(u.y < -1e-3);
}

TEST_CASE("two bodies tied together move as one") {
  // The second block sits in the middle of the first one's end face, on another mesh.
  const auto run = [](double stiffness, double& gap, Vec3& force) {
    World world = make_world(static_options());
    const auto material = neo_hookean(1e5, 0.45);
    const BodyId a = add_body(world, box({4, 3, 3}, {0.2, 0.1, 0.1}), Element::tet4, material, 1000, "a");
    const Mesh small = mapped(box({2, 2, 2}, {0.06, 0.06, 0.06}), [](const Vec3& p) {
      return p + Vec3{0.2, 0.017, 0.023};
    });
    const BodyId b = add_body(world, small, Element::tet4, material, 1000, "b");
    hold(world, a, {"x0"});
    TieDef def;
    def.where.body = b;
    def.where.surfaces = {"x0"};
    def.to = a;
    def.stiffness = stiffness;
    value(world.add(tie(def)));
    TractionDef pull;
    pull.body = b;
    pull.surface = "x1";
    pull.total_force = {3, 0, -2};
    pull.amount = Curve::ramp(1);
    value(world.add(traction(pull)));
    must_advance(world);
    force = force_gauge(world, "tie");
    // The node at the corner of the tied face moves with the face of the other body.
    gap = displacement_at(world, b, {0.2, 0.017, 0.023}).x;
    CHECK(displacement_at(world, b, {0.26, 0.05, 0.05}).z < -1e-3);
  };
  double hard = 0, soft = 0, softer = 0;
  Vec3 force{};
  run(0, hard, force);
  // All of the load goes through the tie.
  CHECK(force.x == Approx(-3).epsilon(1e-7));
  CHECK(force.z == Approx(2).epsilon(1e-7));
  run(1e5, soft, force);
  CHECK(force.x == Approx(-3).epsilon(1e-7));
  run(1e3, softer, force);
  CHECK(std::abs(soft - hard) < 0.1 * std::abs(softer - hard));
}

TEST_CASE("supports and ties that make no sense are refused in words") {
  const auto refusal = [](const DirichletDef& def, bool held = false) {
    Block b;
    if (held) hold(b.world, b.body, {"x1"});
    hold(b.world, b.body, {"x0"});
    const auto r = b.world.add(dirichlet(def));
    if (!r) return r.error();
    const auto compiled = b.world.compile();
    return compiled ? std::string() : compiled.error();
  };
  CHECK(refusal(on_end({}, SupportTreatment::stiffness)).find("stiffness = 0") != std::string::npos);
  CHECK(refusal(on_end({}, SupportTreatment::multiplier, 3)).find("leave it out") != std::string::npos);
  DirichletDef def = on_end({}, SupportTreatment::eliminated);
  def.points = {{0.1, 0.05, 0.05}};
  CHECK(refusal(def).find("points inside elements cannot be eliminated") != std::string::npos);
  def = on_end({}, SupportTreatment::eliminated);
  def.displacement = {1, 0, 0};
  CHECK(refusal(def).find("keep one of them") != std::string::npos);
  CHECK(refusal(on_end({}, SupportTreatment::multiplier), true)
            .find("is held by an eliminated support already") != std::string::npos);
  Block b;
  hold(b.world, b.body, {"x0"});
  TieDef self;
  self.where.surfaces = {"x1"};
  value(b.world.add(tie(self)));
  const auto compiled = b.world.compile();
  REQUIRE_FALSE(compiled.ok());
  CHECK(compiled.error().find("would be tied to itself") != std::string::npos);
}
