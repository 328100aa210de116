// Tractions per area as it is, and such that vary over a surface.
#include <cmath>

#include "engine/base/base.h"
#include "numbers/cube.h"

using namespace isochor;
using test::value;

namespace {

const std::vector<Element> kElements = {Element::tet4, Element::tet4_edge_smoothed, Element::tet10,
                                        Element::hex8};

CellType cells_of(Element e) {
  return e == Element::hex8 ? CellType::hex8 : e == Element::tet10 ? CellType::tet10 : CellType::tet4;
}

std::string refusal(const TractionDef& def) {
  World world = test::make_world(test::static_options());
  test::add_body(world, test::uneven_cube(), Element::tet4, test::neo_hookean(1e5, 0.4));
  test::hold(world, BodyId{0}, {"x0"});
  auto added = world.add(traction(def));
  if (!added) return added.error();
  const auto compiled = world.compile();
  return compiled ? "" : compiled.error();
}

}  // namespace

TEST_CASE("a traction on the area as it is gives a bar that true stress") {
  // nu = 0.5: mu (s^2 - 1/s) = t, where per area at rest it is mu (s - 1/s^2) = t.
  constexpr double mu = 1e5, t = 4e4;
  for (const Element element : kElements) {
    for (const bool lagged : {false, true}) {
      World world = test::make_world(test::static_options());
      const BodyId body = test::add_body(world, test::uneven_cube(cells_of(element)), element,
                                         test::neo_hookean(3 * mu, 0.5));
      test::add_volume(world, body);
      test::slide_on_axes(world, body);
      TractionDef def;
      def.body = body;
      def.surface = "x1";
      def.traction = {-t, 0, 0};
      def.current_area = true;
      def.lagged = lagged;
      def.amount = Curve::ramp(1);
      value(world.add(traction(def)));
      // By lagged areas slowly, so in steps.
      int iterations = 0;
      for (int k = 0; k < 4; ++k) iterations += test::must_advance(world, 0.25).iterations;
      CHECK(iterations <= (lagged ? 60 : 20));
      double low = 0.2, high = 1;
      for (int k = 0; k < 100; ++k) {
        const double s = 0.5 * (low + high);
        (mu * (s * s - 1 / s) + t < 0 ? low : high) = s;
      }
      INFO(test::name_of(element) << (lagged ? ", lagged" : ""));
      CHECK(test::distance_from(world, body, [&](const Vec3& p) {
              return Vec3{low * p.x, p.y / std::sqrt(low), p.z / std::sqrt(low)};
            }) < 1e-7);
      CHECK(test::stress_error(world.fields(body), 0, -t) < 1e-4 * t);
    }
  }
}

TEST_CASE("a field scales a traction over its surface, in sum and moment") {
  // (2 - z) over the unit square: force 1.5, about z = 0 the moment of the integral of z (2 - z) = 2/3.
  for (const Element element : kElements) {
    for (const bool current : {false, true}) {
      World world = test::make_world(test::static_options());
      Mesh mesh = test::block({0, 0, 0}, {1, 1, 1}, {2, 2, 2}, cells_of(element));
      MeshField paint;
      paint.name = "paint";
      for (const Vec3& X : mesh.nodes) paint.values.push_back(2 - X.z);
      mesh.fields.push_back(paint);
      const BodyId body = test::add_body(world, mesh, element, test::neo_hookean(1e9, 0.3));
      const EffectId foot = test::hold(world, body, {"x0"});
      TractionDef def;
      def.body = body;
      def.surface = "x1";
      def.traction = {10, 0, 0};
      def.field = "paint";
      def.current_area = current;
      value(world.add(traction(def)));
      test::must_advance(world);
      INFO(test::name_of(element) << (current ? ", current area" : ""));
      CHECK(world.reaction(foot)[0].x == Approx(-15).epsilon(1e-6));
      CHECK(world.reaction(foot)[1].y == Approx(-20.0 / 3).epsilon(1e-6));
    }
  }
}

TEST_CASE("a profile in space and time scales a traction, in sum and moment, at every time") {
  // (1 + t) (2 - z) over the unit square: force 1.5 (1 + t), about z = 0 the moment 2/3 (1 + t).
  for (const Element element : kElements) {
    for (const bool current : {false, true}) {
      World world = test::make_world(test::static_options());
      const Mesh mesh = test::block({0, 0, 0}, {1, 1, 1}, {2, 2, 2}, cells_of(element));
      const BodyId body = test::add_body(world, mesh, element, test::neo_hookean(1e9, 0.3));
      const EffectId foot = test::hold(world, body, {"x0"});
      TractionDef def;
      def.body = body;
      def.surface = "x1";
      def.traction = {10, 0, 0};
      def.profile = "(1 + t) * (2 - z)";
      def.current_area = current;
      value(world.add(traction(def)));
      for (const double t : {0.25, 0.5, 1.0}) {
        test::must_advance(world, t - world.time());
        INFO(test::name_of(element) << (current ? ", current area" : "") << ", t " << t);
        CHECK(world.reaction(foot)[0].x == Approx(-15 * (1 + t)).epsilon(1e-6));
        CHECK(world.reaction(foot)[1].y == Approx(-20.0 / 3 * (1 + t)).epsilon(1e-6));
      }
    }
  }
}

TEST_CASE("a profile and a field of the same values are the same load, and multiply") {
  Mesh mesh = test::uneven_cube();
  MeshField paint;
  paint.name = "paint";
  for (const Vec3& X : mesh.nodes) paint.values.push_back(1 + X.y * X.z);
  mesh.fields.push_back(paint);
  const auto run = [&](const std::string& field, const std::string& profile) {
    World world = test::make_world(test::static_options());
    const BodyId body = test::add_body(world, mesh, Element::tet4, test::neo_hookean(1e5, 0.4));
    test::hold(world, body, {"x0"});
    TractionDef def;
    def.body = body;
    def.surface = "x1";
    def.traction = {1e3, 2e3, 0};
    def.field = field;
    def.profile = profile;
    value(world.add(traction(def)));
    test::must_advance(world);
    return std::vector<Vec3>(world.positions(body).begin(), world.positions(body).end());
  };
  const auto by_field = run("paint", "");
  const auto by_profile = run("", "1 + y*z"), both = run("paint", "1 + 0*t");
  for (std::size_t i = 0; i < by_field.size(); ++i) {
    CHECK(norm(by_field[i] - by_profile[i]) < 1e-12);
    CHECK(norm(by_field[i] - both[i]) < 1e-12);
  }
}

TEST_CASE("a profile without a value stops the step and leaves the state") {
  World world = test::make_world(test::static_options());
  const BodyId body = test::add_body(world, test::uneven_cube(), Element::tet4, test::neo_hookean(1e5, 0.4));
  test::hold(world, body, {"x0"});
  TractionDef def;
  def.body = body;
  def.surface = "x1";
  def.traction = {1e3, 0, 0};
  for (const bool current : {false, true}) {
    def.current_area = current;
    def.name = current ? "second" : "first";
    def.profile = "sqrt(0.5 - t)";
    const EffectId id = value(world.add(traction(def)));
    test::must_advance(world, 0.25);
    const auto hash = world.state_hash();
    const double before = world.time();
    CHECK(world.step(10).status == StepStatus::rejected);
    CHECK(world.state_hash() == hash);
    CHECK(world.time() == before);
    value(world.remove(id));
  }
}

TEST_CASE("tractions refuse what they cannot mean, by name") {
  const auto says = [](const TractionDef& def, const std::string& what) {
    const std::string text = refusal(def);
    INFO(text);
    CHECK(text.find("traction \"traction\"") == 0);
    CHECK(text.find(what) != std::string::npos);
  };
  TractionDef def;
  def.surface = "x1";
  def.total_force = {1, 0, 0};
  def.current_area = true;
  says(def, "a total_force has no current_area and no field or profile");
  def.total_force = {};
  def.traction = {1, 0, 0};
  CHECK(refusal(def).empty());
  def.field = "paint";
  says(def, "field \"paint\" is none of the nodes of the mesh");
  def.field.clear();
  def.profile = "2 + r";
  says(def, "profile = '2 + r': \"r\" is not known");
  def.profile = std::string(100000, '(') + std::string(100000, 'q');
  says(def, "nested too deeply");
  CHECK(refusal(def).size() < 300);
  def.profile = std::string(100000, 'q');
  says(def, "is not known");
  CHECK(refusal(def).size() < 300);
  def.profile = "1/x - 1/(x - 1)";
  says(def, "is no finite number at (1, ");
  def.profile.clear();
  def.current_area = false;
  def.lagged = true;
  says(def, "lagged is for current_area");
}
