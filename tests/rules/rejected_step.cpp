// Rule: a rejected step leaves the state bit for bit, never throws, and lets no NaN in.
#include <cmath>
#include <limits>

#include "support/worlds.h"

using namespace isochor;
using namespace test;

namespace {

struct Beam {
  World world;
  BodyId body{};
  EffectId end{};

  explicit Beam(WorldOptions options, Curve amount = Curve::constant(1), double traction = 500,
                Element element = Element::tet4)
      : world(make_world(options)) {
    body = add_body(world, box({4, 1, 1}, {4, 1, 1}), element, neo_hookean(1e5, 0.5));
    add_volume(world, body);
    hold(world, body, {"x0"});
    TractionDef def;
    def.surface = "x1";
    def.traction = {0, traction, 0};
    def.amount = std::move(amount);
    end = value(world.add(isochor::traction(def)));
  }
  bool finite() const {
    bool all = true;
    for (const Vec3& p : world.positions(body)) all = all && std::isfinite(dot(p, p));
    for (const Vec3& v : world.velocities(body)) all = all && std::isfinite(dot(v, v));
    return all && std::isfinite(world.elastic_energy());
  }
};

// Takes good steps, then one that must be rejected, and looks at what it left behind.
void check_rejected(Beam& beam, double good, double bad) {
  for (int i = 0; i < 2; ++i) REQUIRE(beam.world.step(good).status == StepStatus::converged);
  const auto before = beam.world.save();
  const std::uint64_t hash = beam.world.state_hash();
  const StepReport r = beam.world.step(bad);
  CHECK(r.status == StepStatus::rejected);
  CHECK_FALSE(r.reason.empty());
  CHECK(beam.world.state_hash() == hash);
  CHECK(beam.world.save() == before);
  CHECK(r.time == beam.world.time());
  CHECK(beam.finite());
}

}  // namespace

TEST_CASE("a NaN or infinite load is rejected") {
  const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
  for (const bool dynamic : {true, false}) {
    for (const double bad : {nan, infinity, -infinity}) {
      Curve amount;
      amount.points = {{0, 0}, {0.2, 1}, {0.22, 1}, {0.23, bad}};
      Beam beam(dynamic ? dynamic_options() : static_options(), amount);
      check_rejected(beam, 0.1, 0.05);
      // The world goes on living.
      CHECK(beam.world.step(0.05).status == StepStatus::rejected);
      CHECK(beam.world.advance(0.05).status == StepStatus::rejected);
      CHECK(beam.finite());
    }
  }
}

TEST_CASE("an iteration limit of one is rejected") {
  WorldOptions options = static_options();
  options.max_iterations = 1;
  Curve amount;
  amount.points = {{0.2, 0}, {1, 1}};
  Beam beam(options, amount, 5000);
  check_rejected(beam, 0.1, 0.8);
}

TEST_CASE("a rejected step gives back what the host had asked for") {
  WorldOptions options = static_options();
  options.max_iterations = 1;
  Beam beam(options, Curve::constant(0), 5000);
  REQUIRE(beam.world.step(0.1).status == StepStatus::converged);
  REQUIRE(beam.world.set_amount(beam.end, 1).ok());
  const auto before = beam.world.save();
  CHECK(beam.world.step(0.1).status == StepStatus::rejected);
  CHECK(beam.world.save() == before);
  // A smaller request is met in its place.
  REQUIRE(beam.world.set_amount(beam.end, 1e-7).ok());
  CHECK(beam.world.step(0.1).status == StepStatus::converged);
}

TEST_CASE("an absurd load is rejected or carried, never half of it") {
  for (const bool dynamic : {true, false}) {
    for (const double load : {1e8, 1e14, 1e200, 1e308}) {
      INFO("load " << load << (dynamic ? ", dynamic" : ", static"));
      Curve amount;
      amount.points = {{0.22, 1e-6}, {0.3, load}};
      WorldOptions options = dynamic ? dynamic_options() : static_options();
      Beam beam(options, amount, 1);
      for (int i = 0; i < 2; ++i) {
        const StepReport first = beam.world.step(0.1);
        INFO(first.reason << ", residual " << first.force_residual << ", rows " << first.row_residual);
        REQUIRE(first.status == StepStatus::converged);
      }
      const auto before = beam.world.save();
      const StepReport r = beam.world.step(0.1);
      if (r.status != StepStatus::converged) CHECK(beam.world.save() == before);
      CHECK(beam.finite());
    }
  }
}

TEST_CASE("bad increments are invalid and change nothing") {
  Beam beam(static_options());
  REQUIRE(beam.world.step(0.1).status == StepStatus::converged);
  const auto before = beam.world.save();
  for (const double h : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    CHECK(beam.world.step(h).status == StepStatus::invalid);
    CHECK(beam.world.advance(h).status == StepStatus::invalid);
    CHECK_FALSE(beam.world.step(h).reason.empty());
  }
  CHECK(beam.world.save() == before);
}

TEST_CASE("a failed advance stops at the last equilibrium") {
  Curve amount;
  amount.points = {{0, 0}, {0.5, 1}, {0.6, 1}, {0.61, std::nan("")}};
  Beam beam(static_options(), amount);
  const StepReport first = beam.world.advance(0.5);
  REQUIRE(first.status == StepStatus::converged);
  const StepReport r = beam.world.advance(0.5);
  CHECK(r.status == StepStatus::rejected);
  CHECK(beam.world.time() >= 0.5);
  CHECK(beam.world.time() < 1);
  CHECK(beam.finite());
}
