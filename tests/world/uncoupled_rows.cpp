// Volume rows of laws that name a volume part: which strain they measure, and that rows, one field and the
// closed form agree.
#include "numbers/cube.h"
#include "support/worlds.h"

using namespace isochor;
using test::value;

namespace {

// A cube with sides that grow at their own rates.
World homogeneous(const MaterialPtr& material, Element element, std::optional<VolumeSpace> space,
                  VolumeStrain strain, const Vec3& stretch) {
  World world = test::make_world(test::static_options());
  const CellType cells = element == Element::hex8 ? CellType::hex8 : CellType::tet4;
  const BodyId body = test::add_body(world, test::block({}, {1, 1, 1}, {2, 2, 2}, cells), element, material);
  if (space) {
    VolumeDef def;
    def.body = body;
    def.space = *space;
    def.strain = strain;
    value(world.add(volume(def)));
  }
  test::move_linearly(world, body, {"x0", "x1", "y0", "y1", "z0", "z1"}, {}, [&](const Vec3& p) {
    return Vec3{(stretch.x - 1) * p.x, (stretch.y - 1) * p.y, (stretch.z - 1) * p.z};
  });
  test::must_advance(world);
  return world;
}

}  // namespace

TEST_CASE("rows measure the strain of the law unless they are told, and make the pressure of its U(J)") {
  const double bulk = 4e5;
  const Vec3 stretch{1.1, 1.05, 0.98};
  const double J = stretch.x * stretch.y * stretch.z;
  for (const auto energy : {VolumeEnergy::quadratic, VolumeEnergy::logarithmic, VolumeEnergy::mixed}) {
    const MaterialPtr m = value(isochoric_mooney_rivlin({2e4, 1e4, 0.5, 0, 0, 0, {energy, bulk}}));
    const double p = energy == VolumeEnergy::quadratic     ? bulk * (J - 1)
                     : energy == VolumeEnergy::logarithmic ? bulk * std::log(J) / J
                                                           : bulk / 2 * (J - 1 / J);
    for (const Element element : {Element::tet4, Element::hex8}) {
      for (const auto space : {VolumeSpace::element, VolumeSpace::node, VolumeSpace::body}) {
        INFO(static_cast<int>(energy) << ", " << static_cast<int>(space));
        World world = homogeneous(m, element, space, VolumeStrain::by_law, stretch);
        for (const double found : world.fields(BodyId{0}).cell_pressure)
          CHECK(found == Approx(p).epsilon(1e-6));
      }
      World world = homogeneous(m, element, std::nullopt, VolumeStrain::by_law, stretch);
      for (const double found : world.fields(BodyId{0}).cell_pressure)
        CHECK(found == Approx(p).epsilon(1e-9));
    }
    World world = homogeneous(m, Element::hex8, VolumeSpace::element, VolumeStrain::linear, stretch);
    for (const double found : world.fields(BodyId{0}).cell_pressure)
      CHECK(found == Approx(bulk * (J - 1)).epsilon(1e-6));
  }
}

TEST_CASE("hexahedra with rows of the mean of J are those of three fields") {
  // One cell, twisted at its top: the work of pressure p on it is p d(v) with v its volume, so the row's
  // multiplier is kappa log(v/V) and the pressure kappa log(v/V) V/v.
  const double bulk = 3e4;
  const MaterialPtr m = value(isochoric_yeoh({{1e4}, 0.5, {VolumeEnergy::logarithmic, bulk}}));
  for (const bool mean : {true, false}) {
    World world = test::make_world(test::static_options());
    const BodyId body =
        test::add_body(world, test::block({}, {1, 1, 1}, {1, 1, 1}, CellType::hex8), Element::hex8, m);
    VolumeDef def;
    def.body = body;
    def.space = VolumeSpace::element;
    if (!mean) def.strain = VolumeStrain::logarithmic;
    value(world.add(volume(def)));
    test::move_linearly(world, body, {"z0"}, {}, [](const Vec3&) { return Vec3{}; });
    test::move_linearly(world, body, {"z1"}, {}, [](const Vec3& p) {
      return Vec3{0.4 * (0.5 - p.y), 0.5 * (p.x - 0.5), 0.3 * p.x};
    });
    test::must_advance(world);
    const BodyMeasures b = world.measures(body);
    const double v = b.volume / b.rest_volume;
    REQUIRE(std::abs(v - 1) > 0.05);
    const double p = bulk * std::log(v) / v;
    // One cell: its energy does not add to the mean of tr sigma.
    const double found = world.fields(body).cell_pressure.front();
    if (mean) {
      CHECK(found == Approx(p).epsilon(1e-9));
    } else {
      CHECK(std::abs(found - p) > 1e-4 * std::abs(p));
    }
  }
}

TEST_CASE("uncoupled laws at Poisson's ratio 0.5 keep the volume with every strain of their rows") {
  for (const auto energy : {VolumeEnergy::quadratic, VolumeEnergy::logarithmic, VolumeEnergy::mixed}) {
    World world = test::make_world(test::static_options());
    const BodyId body = test::add_body(world, test::block({}, {1, 0.2, 0.2}, {6, 2, 2}), Element::tet4,
                                       value(isochoric_gent({1e4, 30, 0.5, {energy, -1}})));
    VolumeDef rows;
    rows.body = body;
    value(world.add(volume(rows)));
    test::hold(world, body, {"x0"});
    TractionDef pull;
    pull.body = body;
    pull.surface = "x1";
    pull.traction = {8e3, 0, 2e2};
    value(world.add(traction(pull)));
    test::must_advance(world);
    const BodyMeasures b = world.measures(body);
    // Linear rows keep the volume; the others the mean of their strain.
    CHECK(b.volume_row_residual < 1e-9);
    CHECK(b.volume == Approx(b.rest_volume).epsilon(energy == VolumeEnergy::quadratic ? 1e-9 : 2e-2));
    CHECK(test::displacement_at(world, body, {1, 0.1, 0.1}).x > 0.1);
  }
}
