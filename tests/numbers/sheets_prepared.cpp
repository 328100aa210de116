// Sheets that are stretched where the body is at rest, and sheets with fibers: closed forms, stresses,
// refusals.
#include <cmath>

#include "engine/base/base.h"
#include "support/sheets.h"

using namespace isochor;
using test::value;

namespace {

constexpr double kMu = 1e5, kThickness = 0.01;

ShellDef sheet_of(BodyId body, double poisson = 0.5) {
  ShellDef def;
  def.body = body;
  def.young = 2 * (1 + poisson) * kMu;
  def.poisson = poisson;
  def.thickness = kThickness;
  def.density = 1000;
  return def;
}

double gauge(const World& world, const std::string& effect, const std::string& quantity) {
  for (const Gauge& g : world.gauges()) {
    if (g.effect == effect && g.quantity == quantity) return g.value;
  }
  FAIL("no gauge " << effect << " " << quantity);
  return 0;
}

struct Flat {
  World world;
  BodyId body{};

  explicit Flat(double disorder = 0.2) : world(test::make_world(test::static_options())) {
    body = test::add_sheet(world, test::unit_sheet(4, 3, disorder));
  }
  // In its plane everything is free but the rigid motions.
  void hold_loosely() {
    Selection all;
    all.body = body;
    all.everything = true;
    test::hold_nodes(world, "plane", all, {{0, 0, 1}});
    test::hold_nodes(world, "left", test::in_box(body, {-1, -1, -1}, {1e-9, 2, 1}), {{1, 0, 0}});
    test::hold_nodes(world, "low", test::in_box(body, {-1, -1, -1}, {2, 1e-9, 1}), {{0, 1, 0}});
  }
  double off(double sx, double sy) const {
    double worst = 0;
    for (std::size_t i = 0; i < world.positions(body).size(); ++i) {
      const Vec3& X = world.rest_positions(body)[i];
      worst = std::max(worst, norm(world.positions(body)[i] - Vec3{sx * X.x, sy * X.y, X.z}));
    }
    return worst;
  }
};

std::string refusal(const ShellDef& def) {
  World world = test::make_world(test::static_options());
  ShellDef own = def;
  own.body = test::add_sheet(world, test::unit_sheet(2, 2));
  Selection all;
  all.body = own.body;
  all.everything = true;
  test::hold_nodes(world, "all", all, {});
  auto added = world.add(shell(own));
  if (!added) return added.error();
  const auto compiled = world.compile();
  return compiled ? "" : compiled.error();
}

}  // namespace

TEST_CASE("a prestretched sheet that nothing holds takes its own size, free of stress") {
  for (const double poisson : {0.0, 0.3, 0.5}) {
    for (const auto& [along, across] : {std::pair(1.3, 1.3), {1.3, 0.8}, {0.9, 1.0}}) {
      Flat flat;
      flat.hold_loosely();
      ShellDef def = sheet_of(flat.body, poisson);
      def.prestretch.along = along;
      def.prestretch.across = across;
      def.prestretch.direction = {2, 0, 0};
      def.amount = Curve::ramp(1);
      value(flat.world.add(shell(def)));
      test::must_advance(flat.world);
      INFO("nu " << poisson << ", " << along << " along, " << across << " across");
      CHECK(flat.off(1 / along, 1 / across) < 1e-9);
      CHECK(gauge(flat.world, "shell", "largest_stress") < 1e-5 * kMu);
      CHECK(flat.world.elastic_energy() < 1e-12);
    }
  }
}

TEST_CASE("a prestretched sheet that is held pulls as the stretched sheet does") {
  // W = t/p^2 w(p) per area: force per length t/p mu (p - p^-5), Cauchy stress mu (p^2 - p^-4).
  constexpr double p = 1.4;
  for (const bool half : {false, true}) {
    Flat flat;
    Selection all;
    all.body = flat.body;
    all.everything = true;
    test::hold_nodes(flat.world, "plane", all, {{0, 0, 1}});
    test::hold_nodes(flat.world, "low", test::in_box(flat.body, {-1, -1, -1}, {2, 1e-9, 1}), {{0, 1, 0}});
    test::hold_nodes(flat.world, "high", test::in_box(flat.body, {-1, 1 - 1e-9, -1}, {2, 2, 1}), {{0, 1, 0}});
    test::hold_nodes(flat.world, "left", test::in_box(flat.body, {-1, -1, -1}, {1e-9, 2, 1}), {{1, 0, 0}});
    const EffectId right = test::hold_nodes(
        flat.world, "right", test::in_box(flat.body, {1 - 1e-9, -1, -1}, {2, 2, 1}), {{1, 0, 0}});
    ShellDef def = sheet_of(flat.body);
    // Half of twice as much is as much.
    def.prestretch.along = def.prestretch.across = half ? 1.8 : p;
    def.amount = Curve::ramp(half ? 0.5 : 1);
    value(flat.world.add(shell(def)));
    test::must_advance(flat.world);
    CHECK(flat.off(1, 1) < 1e-9);
    CHECK(flat.world.reaction(right)[0].x ==
          Approx(kThickness / p * kMu * (p - std::pow(p, -5))).epsilon(1e-8));
    CHECK(gauge(flat.world, "shell", "largest_stress") ==
          Approx(kMu * (p * p - std::pow(p, -4))).epsilon(1e-8));
  }
}

TEST_CASE("a sheet with fibers pulls as both do, and its fibers do not push") {
  // nu = 0.5, pulled along them: force per width t (mu (s - s^-2) + 2 psi'(s^2 - 1) s), sides free.
  FiberFamily fibers;
  fibers.k1 = 2e5;
  fibers.k2 = 0.7;
  for (const double s : {1.25, 0.9}) {
    for (const bool by_field : {false, true}) {
      World world = test::make_world(test::static_options());
      Mesh mesh = test::unit_sheet(4, 3, 0.2);
      MeshField field;
      field.name = "along";
      field.components = 3;
      for (Index c = 0; c < mesh.cell_count(); ++c) field.values.insert(field.values.end(), {-2, 0, 0.5});
      mesh.cell_fields = {field};
      const BodyId body = test::add_sheet(world, mesh);
      Selection all;
      all.body = body;
      all.everything = true;
      test::hold_nodes(world, "plane", all, {{0, 0, 1}});
      test::hold_nodes(world, "low", test::in_box(body, {-1, -1, -1}, {2, 1e-9, 1}), {{0, 1, 0}});
      test::hold_nodes(world, "left", test::in_box(body, {-1, -1, -1}, {1e-9, 2, 1}), {{1, 0, 0}});
      DirichletDef pull;
      pull.name = "pull";
      pull.where = test::in_box(body, {1 - 1e-9, -1, -1}, {2, 2, 1});
      pull.directions = {{1, 0, 0}};
      pull.displacement = {s - 1, 0, 0};
      pull.amount = Curve::ramp(1);
      const EffectId right = value(world.add(dirichlet(pull)));
      ShellDef def = sheet_of(body);
      def.fibers = {fibers};
      if (by_field) def.fiber_field = "along";
      value(world.add(shell(def)));
      test::must_advance(world);
      const double E = std::max(s * s - 1, 0.0), slope = fibers.k1 * E * std::exp(fibers.k2 * E * E);
      const double force = kThickness * (kMu * (s - 1 / (s * s)) + 2 * slope * s);
      INFO("stretch " << s << (by_field ? ", directions of a field" : ""));
      CHECK(world.reaction(right)[0].x == Approx(force).epsilon(1e-8));
      CHECK(gauge(world, "shell", "largest_stress") ==
            Approx(std::abs(s * force / kThickness)).epsilon(1e-7));
    }
  }
}

TEST_CASE("a prestretched layer bends the strip that it is bonded to") {
  // With P = E_s t/(E H): k = 6 P e/(H (1 + 4 P)) for a small prestretch e, Poisson's ratios of zero.
  constexpr double H = 0.002, L = 0.04, E = 1e6, sheet = 2e7, t = 1e-4, e = 2e-3;
  for (const bool as_shell : {false, true}) {
    World world = test::make_world(test::static_options());
    const BodyId body =
        test::add_body(world, test::block({0, 0, 0}, {L, 0.004, H}, {16, 1, 1}, CellType::tet10),
                       Element::tet10, test::neo_hookean(E, 0.0));
    test::hold(world, body, {"x0"}, {{1, 0, 0}});
    test::hold_nodes(world, "point", test::in_box(body, {-1, -1, -1}, {1e-9, 1e-9, 1e-9}),
                     {{0, 1, 0}, {0, 0, 1}});
    test::hold_nodes(world, "side", test::in_box(body, {-1, 0.004 - 1e-9, -1}, {1e-9, 1, 1e-9}), {{0, 0, 1}});
    Prestretch prestretch;
    prestretch.along = 1 + e;
    if (as_shell) {
      ShellDef def;
      def.body = body;
      def.surfaces = {"z0"};
      def.young = sheet;
      def.poisson = 0;
      def.thickness = t;
      def.prestretch = prestretch;
      def.amount = Curve::ramp(1);
      // Next to nothing beside the strip, as the formula has it.
      def.bending = 1e-9;
      value(world.add(shell(def)));
    } else {
      MembraneDef def;
      def.body = body;
      def.surfaces = {"z0"};
      def.young = sheet;
      def.poisson = 0;
      def.thickness = t;
      def.prestretch = prestretch;
      def.amount = Curve::ramp(1);
      value(world.add(membrane(def)));
    }
    test::must_advance(world);
    const double P = sheet * t / (E * H), k = 6 * P * e / (H * (1 + 4 * P));
    double tip = 0;
    for (std::size_t i = 0; i < world.positions(body).size(); ++i) {
      const Vec3& X = world.rest_positions(body)[i];
      if (X.x > L - 1e-9 && X.z < 1e-9) tip = world.positions(body)[i].z;
    }
    INFO((as_shell ? "shell" : "membrane") << ", tip " << tip << " m");
    // The side that pulls becomes the hollow one.
    CHECK(-tip == Approx(0.5 * k * L * L).epsilon(0.02));
  }
}

TEST_CASE("the stress of a bent sheet is that of its moment") {
  // A strip clamped at one end: 6 F (L - x)/(b t^2) on its faces.
  constexpr double L = 1, force = 1e-4;
  World world = test::make_world(test::static_options());
  const int n = 24;
  const BodyId body = test::add_sheet(world, test::unit_sheet(n, 4));
  const Selection root = test::in_box(body, {-1, -1, -1}, {1e-9, 2, 1});
  test::hold_nodes(world, "root", root, {});
  ShellDef def = sheet_of(body, 0.0);
  def.clamped = root;
  value(world.add(shell(def)));
  PointForceDef load;
  load.where = test::in_box(body, {1 - 1e-9, -1, -1}, {2, 2, 1});
  load.force = {0, 0, force};
  value(world.add(point_force(load)));
  test::must_advance(world);
  const double exact = 6 * force * L / (kThickness * kThickness);
  CHECK(gauge(world, "shell", "largest_stress") == Approx(exact).epsilon(0.06));
}

TEST_CASE("prestretch and fibers of sheets that mean nothing are refused by name") {
  const auto says = [](const ShellDef& def, const std::string& what) {
    const std::string text = refusal(def);
    INFO(text);
    CHECK(text.find("shell \"shell\": ") == 0);
    CHECK(text.find(what) != std::string::npos);
  };
  ShellDef def = sheet_of({});
  CHECK(refusal(def).empty());
  def.prestretch.along = 0;
  says(def, "prestretch.along = 0; a stretch is positive");
  def.prestretch.along = 1.5;
  def.amount = Curve::constant(-3);
  says(def, "at amount -3 the prestretch along is -0.5");
  def.amount = Curve::constant(1);
  def.prestretch.direction = {};
  says(def, "prestretch.direction has no direction");
  def.prestretch.direction = {0, 0, 1};
  says(def, "the direction of its prestretch stands across one of its faces");
  def.prestretch = {};
  def.fiber_field = "along";
  says(def, "fiber_field is given without fibers");
  def.fibers.resize(1);
  def.fibers[0].k1 = 1;
  says(def, "field \"along\" is none of the cells of the mesh");
  def.fiber_field.clear();
  def.fibers[0].directions.resize(3, {1, 0, 0});
  says(def, "fibers[0]: directions has 3 entries; it takes one a cell of the thin body, which has 8 cells");
  def.fibers[0].directions.clear();
  def.fibers[0].dispersion = 0.1;
  says(def, "fibers[0]: dispersion and isochoric strains are of solids");
  def.fibers[0].dispersion = 0;
  def.fibers[0].direction = {0, 0, 2};
  says(def, "the direction of its fibers stands across one of its faces");
}
