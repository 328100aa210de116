// Volume rows over rings and zones: bulk stiffness under overlap, volumes that stay, mixtures, refusals.
#include <cmath>
#include <limits>

#include "numbers/cube.h"
#include "support/compiled.h"
#include "support/worlds.h"

using namespace isochor;
using test::value;

namespace {

// Systems of a few unknowns.
WorldOptions small_system() {
  WorldOptions options = test::static_options();
  options.solver = Solver::eigen;
  return options;
}

constexpr double kInfinity = std::numeric_limits<double>::infinity();

VolumeDef rows(VolumeSpace space, int rings = 1) {
  VolumeDef def;
  def.space = space;
  def.rings = rings;
  return def;
}

VolumeZone half(const char* name, double from, double to, double compliance = 1) {
  VolumeZone z;
  z.name = name;
  z.boxes = {{Vec3{from, -1, -1}, Vec3{to, 2, 2}}};
  z.compliance = compliance;
  return z;
}

// Two zones that share the middle third of a unit box.
VolumeDef overlapping(double compliance) {
  VolumeDef def = rows(VolumeSpace::zone);
  def.zones = {half("low", -1, 0.6, compliance), half("high", 0.4, 2, compliance)};
  return def;
}

// Volume of the cells whose centers lie between two planes.
double slab_volume(const World& world, BodyId body, double from, double to) {
  const Mesh& mesh = world.mesh(body);
  double sum = 0;
  for (std::size_t c = 0; c < mesh.cells.size(); c += 4) {
    Vec3 center;
    std::array<Vec3, 4> p;
    for (std::size_t k = 0; k < 4; ++k) {
      const auto n = static_cast<std::size_t>(mesh.cells[c + k]);
      center += 0.25 * mesh.nodes[n];
      p[k] = world.positions(body)[n];
    }
    if (center.x < from || center.x > to) continue;
    sum += dot(p[1] - p[0], cross(p[2] - p[0], p[3] - p[0])) / 6;
  }
  return sum;
}

std::string refusal(const VolumeDef& def, bool two_regions = false) {
  World world = test::make_world(small_system());
  Mesh mesh = test::box({4, 2, 2});
  test::add_body(world, two_regions ? test::divided(mesh, 0.5) : mesh, Element::tet4,
                 test::neo_hookean(1e5, 0.4));
  test::hold(world, BodyId{0}, {"x0"});
  auto added = world.add(volume(def));
  if (!added) return added.error();
  auto compiled = world.compile();
  return compiled ? "" : compiled.error();
}

}  // namespace

TEST_CASE("overlapping compliant rows are as stiff in bulk as asked") {
  // All faces move with x -> (1 + s) x: stress 3 s K whatever the rows; inner nodes stay on the affine map.
  constexpr double s = 1e-5, young = 1e5, nu = 0.45;
  for (const Element element : {Element::tet4, Element::tet10}) {
    for (const VolumeDef& def : {rows(VolumeSpace::element), rows(VolumeSpace::ring, 1),
                                 rows(VolumeSpace::ring, 2), rows(VolumeSpace::ring, 4), overlapping(1)}) {
      World world = test::make_world(small_system());
      const CellType type = element == Element::tet10 ? CellType::tet10 : CellType::tet4;
      const BodyId body =
          test::add_body(world, test::box({3, 2, 2}, {1, 1, 1}, type), element, test::neo_hookean(young, nu));
      test::move_linearly(world, body, {"x0", "x1", "y0", "y1", "z0", "z1"}, {},
                          [](const Vec3& p) { return s * p; });
      value(world.add(volume(def)));
      test::must_advance(world);
      CHECK(test::distance_from(world, body, [](const Vec3& p) { return (1 + s) * p; }) < 1e-10);
      const BodyFields fields = world.fields(body);
      const double bulk = young / (3 * (1 - 2 * nu));
      for (const double p : fields.cell_pressure) CHECK(p == Approx(3 * s * bulk).epsilon(1e-4));
    }
  }
}

TEST_CASE("rings and zones with the logarithmic strain are as stiff in bulk as asked, at any strain") {
  // log J = 3 log(1 + s), so p = 3 K log(1 + s) / J: the multiplier is the Kirchhoff pressure.
  constexpr double s = 0.1, young = 1e5, nu = 0.45;
  ElasticConstants constants;
  constants.young = young;
  constants.poisson = nu;
  const MaterialPtr isochoric = value(isochoric_neo_hookean(constants));
  for (VolumeDef def : {rows(VolumeSpace::ring, 1), rows(VolumeSpace::ring, 2), overlapping(1)}) {
    def.strain = VolumeStrain::logarithmic;
    World world = test::make_world(small_system());
    const BodyId body = test::add_body(world, test::box({3, 2, 2}), Element::tet4, isochoric);
    test::move_linearly(world, body, {"x0", "x1", "y0", "y1", "z0", "z1"}, {},
                        [](const Vec3& p) { return s * p; });
    value(world.add(volume(def)));
    test::must_advance(world);
    const double bulk = young / (3 * (1 - 2 * nu)), J = std::pow(1 + s, 3);
    for (const double p : world.fields(body).cell_pressure)
      CHECK(p == Approx(bulk * std::log(J) / J).epsilon(1e-6));
  }
}

TEST_CASE("a hard zone with the logarithmic strain keeps the mean of log J") {
  World world = test::make_world(small_system());
  const BodyId body = test::add_body(world, test::box({4, 2, 2}), Element::tet4, test::neo_hookean(1e5, 0.4));
  test::hold(world, body, {"x0"});
  value(world.add(volume(rows(VolumeSpace::element))));
  VolumeDef zone = overlapping(0);
  zone.name = "zone";
  zone.zones.resize(1);
  zone.strain = VolumeStrain::logarithmic;
  zone.carries_bulk = false;
  value(world.add(volume(zone)));
  TractionDef pull;
  pull.body = body;
  pull.surface = "x1";
  pull.traction = {5e4, 0, 2e4};
  value(world.add(traction(pull)));
  test::must_advance(world);
  const std::vector<double> J = world.fields(body).cell_J;
  const Mesh& mesh = world.mesh(body);
  double inside = 0, outside = 0;
  for (std::size_t c = 0; c < J.size(); ++c) {
    double x = 0;
    for (std::size_t k = 0; k < 4; ++k)
      x += 0.25 * mesh.nodes[static_cast<std::size_t>(mesh.cells[4 * c + k])].x;
    (x < 0.6 ? inside : outside) += std::log(J[c]);  // cells of one size
  }
  CHECK(std::abs(inside) < 1e-8);
  CHECK(std::abs(outside) > 1e-2);
}

TEST_CASE("zones and bodies may span regions") {
  const auto scene = [](const VolumeDef& on_top, std::string* refused = nullptr) {
    World world = test::make_world(small_system());
    BodyDef def;
    def.mesh = test::divided(test::box({4, 2, 2}), 0.5);
    def.element = Element::tet4;
    def.materials = {{"low", test::neo_hookean(1e5, 0.3), 1000},
                     {"high", test::neo_hookean(3e5, 0.45), 1000}};
    const BodyId body = value(world.add_body(def));
    test::hold(world, body, {"x0"});
    VolumeDef base;
    base.space = VolumeSpace::element;
    base.carries_bulk = on_top.carries_bulk ? false : true;
    if (!on_top.carries_bulk) value(world.add(volume(base)));
    value(world.add(volume(on_top)));
    TractionDef pull;
    pull.body = body;
    pull.surface = "x1";
    pull.traction = {2e4, 0, 0};
    value(world.add(traction(pull)));
    if (refused) {
      const auto compiled = world.compile();
      *refused = compiled ? "" : compiled.error();
      return world;
    }
    test::must_advance(world);
    return world;
  };
  SECTION("a hard row over both keeps the sum, not the parts") {
    VolumeDef whole = rows(VolumeSpace::body);
    whole.name = "whole";
    whole.across_regions = true;
    whole.hard = true;
    whole.carries_bulk = false;
    const World world = scene(whole);
    CHECK(world.measures(BodyId{0}).volume == Approx(1).epsilon(1e-9));
    CHECK(world.measures(BodyId{0}).volume_error < 1e-9);
    CHECK(std::abs(slab_volume(world, BodyId{0}, -1, 0.5) - 0.5) > 1e-4);
  }
  SECTION("a compliant row over both has one pressure and the compliance of both") {
    VolumeDef zone = rows(VolumeSpace::zone);
    zone.zones = {half("all", -1, 2)};
    zone.across_regions = true;
    const World world = scene(zone);
    // The neo-Hookean row carries lambda; softness V/lambda adds up over the regions.
    const auto lambda = [](double E, double nu) { return E * nu / ((1 + nu) * (1 - 2 * nu)); };
    const double compliance = 0.5 / lambda(1e5, 0.3) + 0.5 / lambda(3e5, 0.45);
    const double grown = world.measures(BodyId{0}).volume - 1;
    CHECK(world.measures(BodyId{0}).volume_error < 1e-9);
    CHECK(grown > 1e-3);
    // One multiplier everywhere, grown / compliance: pressures less their distortional part.
    const Mesh& mesh = world.mesh(BodyId{0});
    const BodyFields fields = world.fields(BodyId{0});
    const double shear[2] = {1e5 / 2.6, 3e5 / 2.9};
    for (std::size_t c = 0; c < fields.cell_pressure.size(); ++c) {
      // Distortional neo-Hookean: tr sigma = mu (|F|^2 - 3) / J.
      std::array<Vec3, 3> d, D;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto n = static_cast<std::size_t>(mesh.cells[4 * c + k + 1]);
        const auto o = static_cast<std::size_t>(mesh.cells[4 * c]);
        d[k] = world.positions(BodyId{0})[n] - world.positions(BodyId{0})[o];
        D[k] = mesh.nodes[n] - mesh.nodes[o];
      }
      const double det = dot(D[0], cross(D[1], D[2]));
      const std::array<Vec3, 3> inverse{(1 / det) * cross(D[1], D[2]), (1 / det) * cross(D[2], D[0]),
                                        (1 / det) * cross(D[0], D[1])};
      double squares = 0;
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
          double f = 0;
          for (std::size_t k = 0; k < 3; ++k) f += d[k][i] * inverse[k][j];
          squares += f * f;
        }
      }
      const double mu = shear[static_cast<std::size_t>(mesh.cell_region[c])];
      const double rest = mu * (squares - 3) / 3 / fields.cell_J[c];
      CHECK(fields.cell_pressure[c] - rest == Approx(grown / compliance).epsilon(1e-7));
    }
  }
  SECTION("without leave it is refused, and so is a hard row that repeats those of the regions") {
    VolumeDef zone = rows(VolumeSpace::zone);
    zone.zones = {half("all", -1, 2)};
    std::string refused;
    scene(zone, &refused);
    CHECK_THAT(refused, ContainsSubstring("across_regions = true"));
    World world = test::make_world(small_system());
    const BodyId body = test::add_body(world, test::divided(test::box({4, 2, 2}), 0.5), Element::tet4,
                                       test::neo_hookean(1e5, 0.5));
    test::hold(world, body, {"x0"});
    test::add_volume(world, body);
    VolumeDef whole = rows(VolumeSpace::body);
    whole.name = "whole";
    whole.across_regions = true;
    whole.carries_bulk = false;
    value(world.add(volume(whole)));
    const auto compiled = world.compile();
    REQUIRE_FALSE(compiled.ok());
    CHECK_THAT(compiled.error(), ContainsSubstring("\"whole\"") && ContainsSubstring("repeat") &&
                                     ContainsSubstring("drop one"));
  }
}

TEST_CASE("hard rings that depend on each other or on other hard rows are named before the solve") {
  // On a box of Kuhn cells the rings of each color of nodes add up to the body.
  VolumeDef rings = rows(VolumeSpace::ring);
  rings.hard = true;
  CHECK_THAT(refusal(rings), ContainsSubstring("repeat") && ContainsSubstring("of its"));
  // One zone over the body beside rows per node that add up to it.
  World world = test::make_world(small_system());
  const BodyId body = test::add_body(world, test::box({3, 2, 2}), Element::tet4, test::neo_hookean(1e5, 0.5));
  test::hold(world, body, {"x0"});
  test::add_volume(world, body);
  VolumeDef whole = rows(VolumeSpace::zone);
  whole.name = "whole zone";
  whole.carries_bulk = false;
  whole.zones = {half("all", -1, 2)};
  value(world.add(volume(whole)));
  const auto compiled = world.compile();
  REQUIRE_FALSE(compiled.ok());
  CHECK_THAT(compiled.error(), ContainsSubstring("\"whole zone\"") && ContainsSubstring("repeat"));
  // Half of a body that is enclosed may be hard; both halves say what the supports say.
  for (const bool both : {false, true}) {
    World closed = test::make_world(small_system());
    const BodyId box =
        test::add_body(closed, test::box({4, 2, 2}), Element::tet4, test::neo_hookean(1e5, 0.4));
    test::hold(closed, box, {"x0", "x1", "y0", "y1", "z0", "z1"});
    value(closed.add(volume(rows(VolumeSpace::element))));
    VolumeDef halves = rows(VolumeSpace::zone);
    halves.name = "halves";
    halves.carries_bulk = false;
    halves.zones = {half("left", -1, 0.5, 0)};
    if (both) halves.zones.push_back(half("right", 0.5, 2, 0));
    value(closed.add(volume(halves)));
    const auto result = closed.compile();
    CHECK(result.ok() != both);
    if (both) CHECK_THAT(result.error(), ContainsSubstring("enclosed"));
  }
}

TEST_CASE("hard zones keep their volumes, also where they overlap") {
  World world = test::make_world(small_system());
  const BodyId body = test::add_body(world, test::box({5, 2, 2}), Element::tet4, test::neo_hookean(1e5, 0.4));
  test::hold(world, body, {"x0"});
  value(world.add(volume(rows(VolumeSpace::element))));
  VolumeDef zones = overlapping(0);
  zones.name = "zones";
  zones.carries_bulk = false;
  value(world.add(volume(zones)));
  TractionDef pull;
  pull.body = body;
  pull.surface = "x1";
  pull.traction = {5e4, 0, 2e4};
  value(world.add(traction(pull)));
  test::must_advance(world);
  CHECK(slab_volume(world, body, -1, 0.6) == Approx(0.6).epsilon(1e-9));
  CHECK(slab_volume(world, body, 0.4, 2) == Approx(0.6).epsilon(1e-9));
  CHECK(std::abs(slab_volume(world, body, -1, 0.2) - 0.2) > 1e-4);  // no zone of its own
}

TEST_CASE("pressures at nodes with nu = 0.45 go along with a hard zone over the whole body") {
  double volume_now[2];
  for (int k = 0; k < 2; ++k) {
    World world = test::make_world(small_system());
    const BodyId body = test::add_body(world, test::box({3, 2, 2}), Element::tet4_edge_smoothed,
                                       test::neo_hookean(1e5, 0.45));
    test::hold(world, body, {"x0"});
    test::add_volume(world, body);
    if (k == 1) {
      VolumeDef whole = rows(VolumeSpace::body);
      whole.name = "whole";
      whole.hard = true;
      whole.carries_bulk = false;
      value(world.add(volume(whole)));
    }
    TractionDef pull;
    pull.body = body;
    pull.surface = "x1";
    pull.traction = {5e4, 0, 0};
    value(world.add(traction(pull)));
    test::must_advance(world);
    volume_now[k] = world.measures(body).volume;
  }
  CHECK(volume_now[0] > 1.01);
  CHECK(volume_now[1] == Approx(1).epsilon(1e-9));
}

TEST_CASE("a factor on the compliance softens a zone, infinity takes its row away") {
  double grown[3];
  const double factors[] = {1, 5, kInfinity};
  for (int k = 0; k < 3; ++k) {
    World world = test::make_world(small_system());
    const BodyId body =
        test::add_body(world, test::box({4, 2, 2}), Element::tet4, test::neo_hookean(1e5, 0.45));
    test::slide_on_axes(world, body);
    VolumeDef zones = rows(VolumeSpace::zone);
    zones.carries_bulk = true;
    zones.zones = {half("low", -1, 0.5), half("high", 0.5, 2, factors[k])};
    if (factors[k] == kInfinity) {
      CHECK_THAT(refusal(zones), ContainsSubstring("no compliant zone"));
      zones.zones[0].compliance = 0;
      zones.hard = true;
      zones.zones.pop_back();
    }
    value(world.add(volume(zones)));
    TractionDef pull;
    pull.body = body;
    pull.surface = "x1";
    pull.traction = {1e3, 0, 0};
    value(world.add(traction(pull)));
    test::must_advance(world);
    grown[k] = slab_volume(world, body, 0.5, 2) - 0.5;
  }
  CHECK(grown[1] > 2 * grown[0]);
  CHECK(grown[2] > grown[1]);
}

TEST_CASE("zones and rings that mean nothing are refused") {
  VolumeDef def = rows(VolumeSpace::ring, 0);
  CHECK_THAT(refusal(def), ContainsSubstring("rings = 0"));
  def = rows(VolumeSpace::zone);
  CHECK_THAT(refusal(def), ContainsSubstring("zones is empty"));
  def.zones = {half("all", -1, 2)};
  CHECK(refusal(def).empty());
  CHECK_THAT(refusal(def, true), ContainsSubstring("not in one region"));
  def.space = VolumeSpace::node;
  CHECK_THAT(refusal(def), ContainsSubstring("change space"));
  def.space = VolumeSpace::zone;
  def.zones[0].compliance = -1;
  CHECK_THAT(refusal(def), ContainsSubstring("compliance = -1"));
  def.zones = {half("nothing", 3, 4)};
  CHECK_THAT(refusal(def), ContainsSubstring("it has no cells"));
  def.zones = {half("left", -1, 0.5)};
  CHECK_THAT(refusal(def), ContainsSubstring("no compliant zone"));
  def.zones[0].cells = {5000};
  CHECK_THAT(refusal(def), ContainsSubstring("cell 5000"));
  // The same cells twice with zero compliance say the same thing twice.
  def.zones = {half("left", -1, 0.5, 0), half("left again", -1, 0.5, 0)};
  def.carries_bulk = false;
  CHECK_THAT(refusal(def), ContainsSubstring("\"left again\" repeats"));
  def.zones = {half("left", -1, 0.5, 0), half("right", 0.5, 2, 0), half("both", -1, 2, 0)};
  CHECK_THAT(refusal(def), ContainsSubstring("\"both\" repeats"));
}

TEST_CASE("rows without compliance keep the whole volume, whatever the law calls its volume part") {
  const MaterialPtr law = value(isochoric_ogden({{{1e5, 2}, {-2e4, -2}}, 0.5, {VolumeEnergy::logarithmic}}));
  for (const bool field : {false, true}) {
    for (const Element element : {Element::tet4, Element::tet4_edge_smoothed, Element::tet10}) {
      World world = test::make_world(small_system());
      const Mesh mesh = test::block({0, 0, 0}, {1, 1, 1}, {2, 2, 2});
      std::vector<double> factor(mesh.cells.size() / 4, 1);
      for (std::size_t c = 0; c < factor.size(); ++c) factor[c] = 0.2 + static_cast<double>(c % 7);
      const BodyId body =
          test::add_body(world, mesh, element, field ? value(with_stiffness_field(law, factor)) : law);
      test::add_volume(world, body);
      test::hold(world, body, {"z0"});
      TractionDef pull;
      pull.surface = "z1";
      pull.traction = {3e4, 0, 4e4};
      value(world.add(traction(pull)));
      test::must_advance(world, 1);
      const BodyMeasures m = world.measures(body);
      INFO("field " << field << ", element " << static_cast<int>(element));
      CHECK(m.max_J > 1.001);
      CHECK(m.volume == Approx(m.rest_volume).epsilon(1e-9));
    }
  }
}
