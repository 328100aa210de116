// Muscles: the uniaxial balance in closed form, isometric force, fields of fibers, derivatives, refusals.
#include <functional>

#include "numbers/cube.h"

using namespace isochor;
using test::value;

namespace {

const std::vector<Element> kElements = {Element::tet4, Element::tet4_edge_smoothed, Element::tet10,
                                        Element::hex8};

CellType cells_of(Element e) {
  return e == Element::hex8 ? CellType::hex8 : e == Element::tet10 ? CellType::tet10 : CellType::tet4;
}

// Where an increasing function is zero.
double root(double low, double high, const std::function<double(double)>& f) {
  for (int k = 0; k < 200; ++k) {
    const double middle = 0.5 * (low + high);
    (f(middle) < 0 ? low : high) = middle;
  }
  return low;
}

std::string refusal(const MuscleDef& def) {
  World world = test::make_world(test::static_options());
  test::add_body(world, test::uneven_cube(), Element::tet4, test::neo_hookean(1e5, 0.4));
  auto added = world.add(muscle(def));
  if (!added) return added.error();
  const auto compiled = world.compile();
  return compiled ? "" : compiled.error();
}

}  // namespace

TEST_CASE("a muscle that is free shortens to where its law and its pull balance") {
  constexpr double mu = 1e5, T = 6e4;
  for (const Element element : kElements) {
    for (const auto tension : {MuscleTension::nominal, MuscleTension::current}) {
      for (const double width : {0.0, 0.5}) {
        World world = test::make_world(test::static_options());
        const BodyId body = test::add_body(world, test::uneven_cube(cells_of(element)), element,
                                           test::neo_hookean(3 * mu, 0.5));
        test::add_volume(world, body);
        test::slide_on_axes(world, body);
        MuscleDef def;
        def.direction = {-2, 0, 0};
        def.tension = tension;
        def.width = width;
        def.optimal_stretch = 1.1;
        def.amount = Curve::ramp(T);
        value(world.add(muscle(def)));
        test::must_advance(world);
        const double s = root(0.3, 2, [&](double v) {
          const double d = (v - 1.1) / 0.5;
          const double f = width == 0 ? 1 : std::max(0.0, 1 - d * d);
          return mu * (v - 1 / (v * v)) + T * f / (tension == MuscleTension::current ? v : 1);
        });
        INFO(test::name_of(element) << ", tension " << static_cast<int>(tension) << ", width " << width);
        CHECK(s < 0.95);
        CHECK(test::distance_from(world, body, [&](const Vec3& p) {
                return Vec3{s * p.x, p.y / std::sqrt(s), p.z / std::sqrt(s)};
              }) < 1e-8);
        CHECK(test::gauge(world, "active_stress") == T);
      }
    }
  }
}

TEST_CASE("a muscle between walls pulls with its tension, along any of them") {
  for (const Element element : kElements) {
    for (int axis = 0; axis < 3; ++axis) {
      World world = test::make_world(test::static_options());
      const Mesh mesh = test::uneven_cube(cells_of(element));
      const BodyId body = test::add_body(world, mesh, element, test::neo_hookean(3e5, 0.45));
      test::add_volume(world, body);
      test::slide_on_axes(world, body);
      std::vector<EffectId> walls;
      for (int k = 0; k < 3; ++k) {
        Vec3 normal{};
        normal[k] = 1;
        walls.push_back(test::hold(world, body, {std::string(1, "xyz"[k]) + "1"}, {normal}));
      }
      MuscleDef def;
      // Along one line, whatever the sign and the length of the vectors.
      for (Index c = 0; c < mesh.cell_count(); ++c) {
        Vec3 fiber{};
        fiber[axis] = c % 2 == 0 ? 1 : -3;
        def.directions.push_back(fiber);
      }
      def.amount = Curve::ramp(5e4);
      value(world.add(muscle(def)));
      test::must_advance(world);
      INFO(test::name_of(element) << ", axis " << axis);
      // Nothing moves: T a a^T.
      for (int k = 0; k < 3; ++k)
        CHECK(world.reaction(walls[static_cast<std::size_t>(k)])[0][k] ==
              Approx(k == axis ? 5e4 : 0).epsilon(1e-7).margin(1e-3));
    }
  }
}

TEST_CASE("derivatives know the tension of a muscle") {
  const auto run = [](double tension) {
    World world = test::make_world(test::static_options());
    const BodyId body =
        test::add_body(world, test::uneven_cube(), Element::tet4_edge_smoothed, test::neo_hookean(1e5, 0.5));
    test::add_volume(world, body);
    test::slide_on_axes(world, body);
    MuscleDef def;
    def.direction = {1, 1, 0};
    def.amount = Curve::constant(tension);
    const EffectId id = value(world.add(muscle(def)));
    test::must_advance(world);
    return std::tuple{std::move(world), body, id};
  };
  auto [world, body, id] = run(2e4);
  ResponseInput input;
  input.effect = id;
  const auto got = value(world.derivatives(std::span(&input, 1)));
  const auto tip = static_cast<std::size_t>(test::nearest_node(world.rest_positions(body), {1, 1, 1}));
  auto [up, b1, i1] = run(2e4 + 10);
  auto [down, b2, i2] = run(2e4 - 10);
  for (int k = 0; k < 3; ++k) {
    const double difference = (up.positions(b1)[tip][k] - down.positions(b2)[tip][k]) / 20;
    CHECK(got[0].positions[0][tip][k] == Approx(difference).epsilon(1e-5).margin(1e-12));
  }
}

TEST_CASE("muscles refuse what they cannot mean, by name") {
  const auto says = [](const MuscleDef& def, const std::string& what) {
    const std::string text = refusal(def);
    INFO(text);
    CHECK(text.find("muscle \"muscle\": ") != std::string::npos);
    CHECK(text.find(what) != std::string::npos);
  };
  MuscleDef def;
  def.direction = {0, 0, 0};
  says(def, "direction has no length");
  def.direction = {1, 0, 0};
  def.width = -1;
  says(def, "width = -1");
  def.width = 0;
  def.optimal_stretch = 0;
  says(def, "optimal_stretch = 0");
  def.optimal_stretch = 1;
  def.directions = {{1, 0, 0}};
  says(def, "directions has 1 entries, the mesh of the body");
  def.field = "fibers";
  says(def, "directions and a field are given");
  def.directions.clear();
  says(def, "field \"fibers\" is none of the cells");
  def.field.clear();
  def.amount = Curve{{{0, std::nan("")}}};
  says(def, "no finite number");
}
