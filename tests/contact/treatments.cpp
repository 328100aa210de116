// Soft contact in the saddle point and condensed into the stiffness: one answer.
#include <cmath>

#include "isochor/contact.h"
#include "support/worlds.h"

using namespace isochor;

namespace {

// A block that is thrown on the floor with a slant, bounces and turns.
struct Drop {
  World world;
  BodyId body{};
};

Drop drop(Method method, double compliance, double friction) {
  WorldOptions options = test::dynamic_options();
  options.method = method;
  options.gravity = {0, 0, -9.81};
  Drop d{test::make_world(options), {}};
  Mesh mesh = test::box({3, 3, 3}, {0.1, 0.1, 0.1});
  for (Vec3& x : mesh.nodes) x = {x.x, 0.96 * x.y - 0.28 * x.z, 0.28 * x.y + 0.96 * x.z + 0.01};
  d.body = test::add_body(d.world, mesh, Element::tet4, test::neo_hookean(30e3, 0.5));
  test::add_volume(d.world, d.body);
  ContactDef floor;
  floor.body = d.body;
  floor.compliance = compliance;
  floor.friction = friction;
  test::value(d.world.add(contact(floor)));
  return d;
}

double lowest(const World& world, BodyId body) {
  double z = 1;
  for (const Vec3& x : world.positions(body)) z = std::min(z, x.z);
  return z;
}

}  // namespace

TEST_CASE("soft contact is condensed by default, with the answer of the saddle point") {
  for (const double friction : {0.0, 0.4}) {
    Drop kept = drop(Method::saddle_point, 1e-6, friction);
    Drop condensed = drop(Method::automatic, 1e-6, friction);
    bool touched = false;
    for (int k = 0; k < 30; ++k) {
      REQUIRE(kept.world.step(0.005).status == StepStatus::converged);
      REQUIRE(condensed.world.step(0.005).status == StepStatus::converged);
      const auto a = kept.world.positions(kept.body), b = condensed.world.positions(condensed.body);
      double away = 0;
      for (std::size_t i = 0; i < a.size(); ++i)
        away = std::max(away, std::sqrt(dot(a[i] - b[i], a[i] - b[i])));
      INFO("step " << k << ", friction " << friction);
      CHECK(away < 1e-8 * 0.1);
      touched = touched || lowest(kept.world, kept.body) < 0;
    }
    CHECK(touched);
    // What is condensed is no unknown of the matrix.
    const Index rows = kept.world.size().matrix_size - condensed.world.size().matrix_size;
    CHECK(rows == 56);
    CHECK(condensed.world.size().multipliers == kept.world.size().multipliers);
  }
}

TEST_CASE("hard contact stays in the saddle point") {
  Drop a = drop(Method::saddle_point, 0, 0), b = drop(Method::automatic, 0, 0);
  REQUIRE(a.world.compile());
  REQUIRE(b.world.compile());
  CHECK(a.world.size().matrix_size == b.world.size().matrix_size);
}

TEST_CASE("projected dual steps end where the active set does") {
  for (const double compliance : {0.0, 1e-6}) {
    Drop active = drop(Method::saddle_point, compliance, 0),
         dual = drop(Method::augmented_ascent, compliance, 0);
    bool touched = false;
    for (int k = 0; k < 16; ++k) {
      REQUIRE(active.world.step(0.01).status == StepStatus::converged);
      const StepReport report = dual.world.step(0.01);
      INFO("compliance " << compliance << ", step " << k << ": " << report.reason);
      REQUIRE(report.status == StepStatus::converged);
      CHECK(report.row_residual <= 1e-10);
      const auto a = active.world.positions(active.body), b = dual.world.positions(dual.body);
      double away = 0;
      for (std::size_t i = 0; i < a.size(); ++i)
        away = std::max(away, std::sqrt(dot(a[i] - b[i], a[i] - b[i])));
      CHECK(away < 1e-8 * 0.1);
      touched = touched || lowest(active.world, active.body) < 1e-9;
    }
    CHECK(touched);
  }
}
