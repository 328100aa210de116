// The constrained neo-Hookean method on a puck that is pressed in to half of its height: a zone of exact
// volume, the extended isochoric energy, the local penalty, and an epidermis.
#include <cmath>
#include <limits>

#include "numbers/cube.h"
#include "support/worlds.h"

using namespace isochor;
using test::value;

namespace {

// A cylinder of radius 1 and height 0.6: a box with its squares mapped to disks.
Mesh puck() {
  return test::mapped(test::box({6, 6, 3}), [](const Vec3& p) {
    const double x = 2 * p.x - 1, y = 2 * p.y - 1;
    return Vec3{x * std::sqrt(1 - y * y / 2), y * std::sqrt(1 - x * x / 2), 0.6 * p.z};
  });
}

struct Outcome {
  double volume_loss, min_J;
  int iterations;
};

Outcome press(double beta, bool skin) {
  constexpr double mu = 1e4;
  ElasticConstants c;
  c.mu = mu;
  c.bulk = std::numeric_limits<double>::infinity();
  const MaterialPtr base = value(isochoric_extended(c));
  WorldOptions options = test::static_options();
  options.smallest_fraction = 1.0 / 256;
  World world = test::make_world(options);
  const BodyId body =
      test::add_body(world, puck(), Element::tet4, value(with_compression_penalty(base, {25 * mu, beta})));
  VolumeDef zone;
  zone.space = VolumeSpace::body;
  value(world.add(volume(zone)));
  test::hold(world, body, {"z0"});
  DirichletDef press;
  press.name = "press";
  press.where.boxes = {{Vec3{-0.4, -0.4, 0.59}, Vec3{0.4, 0.4, 0.61}}};
  press.displacement = {0, 0, -0.3};
  press.amount = Curve::ramp(1);
  value(world.add(dirichlet(press)));
  if (skin) {
    EpidermisDef def;
    def.surfaces = {"z1", "x0", "x1", "y0", "y1"};
    def.stiffness = 25 * mu * 0.05;
    def.gamma = 1;
    value(world.add(epidermis(def)));
  }
  Outcome out{0, 1, 0};
  for (int step = 0; step < 50; ++step) {
    const StepReport report = world.advance(0.02);
    INFO(report.reason << ", step " << step);
    REQUIRE(report.status == StepStatus::converged);
    out.iterations += report.iterations;
    const BodyMeasures m = world.measures(body);
    out.min_J = std::min(out.min_J, m.min_J);
    out.volume_loss = std::max(out.volume_loss, std::abs(m.volume / m.rest_volume - 1));
  }
  return out;
}

}  // namespace

TEST_CASE("a puck pressed in by half keeps its volume and no element turns over") {
  const std::pair<double, bool> cases[] = {{0, false}, {9, false}, {9, true}};
  for (const auto& [beta, skin] : cases) {
    const Outcome o = press(beta, skin);
    // The table of docs/materials/compression_penalty.md.
    WARN("beta " << beta << (skin ? " and skin" : "") << ": iterations " << o.iterations << ", volume loss "
                 << o.volume_loss << ", smallest J " << o.min_J);
    CHECK(o.volume_loss <= 1e-8);
    CHECK(o.min_J > 0.3);
    CHECK(o.iterations < 200);
  }
}
