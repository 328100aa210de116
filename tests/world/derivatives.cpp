// Derivatives of equilibria. The judge solves the equilibrium again on both sides of every input and takes
// the difference.
#include "engine/base/base.h"
#include "support/worlds.h"

using namespace test;
using Catch::Matchers::WithinAbs;
using isochor::BodyId;
using isochor::EffectId;
using isochor::norm;
using isochor::Response;
using isochor::ResponseInput;
using isochor::World;

namespace {

isochor::WorldOptions tight(isochor::SchemePtr scheme = isochor::statics()) {
  isochor::WorldOptions options;
  options.scheme = std::move(scheme);
  options.threads = 1;
  options.force_tolerance = 1e-12;
  options.row_tolerance = 1e-13;
  return options;
}

struct Robot {
  World world;
  BodyId body{};
  EffectId clamp{}, air{}, tendon{}, pull{};
};

isochor::EffectPtr tendon(BodyId body) {
  isochor::CableDef def;
  def.name = "tendon";
  def.body = body;
  def.points = {{0.1, 0.5, 0.9}, {0.5, 0.5, 0.9}, {0.9, 0.5, 0.9}};
  def.control = isochor::CableControl::tension;
  def.amount = isochor::Curve::constant(30);
  return isochor::cable(def);
}

// A block that is clamped and pulled by a tendon, a force and a pressure on its end, with rows at nu = 0.5.
Robot robot(isochor::Element element) {
  Robot r{make_world(tight())};
  r.body = add_body(r.world, block({0, 0, 0}, {1, 1, 1}, {3, 2, 2}, cells_for(element)), element,
                    neo_hookean(1e4, 0.5), 1000);
  add_volume(r.world, r.body);
  r.clamp = hold(r.world, r.body, {"x0"}, {}, {0, 0.02, 0}, isochor::Curve::constant(1));
  r.tendon = value(r.world.add(tendon(r.body)));
  isochor::PressureDef press;
  press.body = r.body;
  press.surfaces = {"z0"};
  press.amount = isochor::Curve::constant(200);
  r.air = value(r.world.add(isochor::pressure(press)));
  isochor::PointForceDef force;
  force.where.body = r.body;
  force.where.surfaces = {"x1"};
  force.force = {0, 3, 10};
  force.amount = isochor::Curve::constant(1);
  r.pull = value(r.world.add(isochor::point_force(force)));
  must_advance(r.world);
  return r;
}

// Everything that a response has, in one list.
std::vector<double> flat(const World& world) {
  std::vector<double> all;
  for (const BodyId b : world.bodies()) {
    for (const Vec3& v : world.positions(b)) all.insert(all.end(), {v.x, v.y, v.z});
  }
  for (const auto& g : world.gauges()) all.push_back(g.value);
  for (const EffectId e : world.effects()) {
    for (const Vec3& v : world.reaction(e)) all.insert(all.end(), {v.x, v.y, v.z});
  }
  return all;
}
std::vector<double> flat(const Response& r) {
  std::vector<double> all;
  for (const auto& body : r.positions) {
    for (const Vec3& v : body) all.insert(all.end(), {v.x, v.y, v.z});
  }
  for (const auto& g : r.gauges) all.push_back(g.value);
  for (const auto& pair : r.reactions) {
    for (const Vec3& v : pair) all.insert(all.end(), {v.x, v.y, v.z});
  }
  return all;
}

template <class Change>
void against_differences(const World& world, const Response& response, double step, double tolerance,
                         Change&& change) {
  World up = value(world.clone()), down = value(world.clone());
  change(up, step);
  change(down, -step);
  must_advance(up, 0.1);
  must_advance(down, 0.1);
  const std::vector<double> a = flat(up), b = flat(down), d = flat(response);
  REQUIRE(a.size() == d.size());
  double largest_position = 0, largest_other = 0;
  const std::size_t positions = 3 * world.positions(world.bodies()[0]).size();
  for (std::size_t k = 0; k < d.size(); ++k) {
    double& largest = k < positions ? largest_position : largest_other;
    largest = std::max(largest, std::abs(d[k]));
  }
  CHECK(largest_position > 0);
  for (std::size_t k = 0; k < d.size(); ++k) {
    INFO("number " << k << " of " << d.size());
    const double scale = k < positions ? largest_position : largest_other;
    CHECK_THAT(d[k], WithinAbs((a[k] - b[k]) / (2 * step), tolerance * scale));
  }
}

template <class T>
std::string refusal(const isochor::Result<T>& result) {
  REQUIRE_FALSE(result.ok());
  return result.error();
}

}  // namespace

TEST_CASE("derivatives of an equilibrium are those that differences of equilibria have", "[derivatives]") {
  for (const auto element : {isochor::Element::tet4, isochor::Element::tet4_edge_smoothed,
                             isochor::Element::tet10, isochor::Element::hex8}) {
    CAPTURE(name_of(element));
    Robot r = robot(element);
    const Vec3 tip{0.95, 0.45, 0.4};
    const std::vector<ResponseInput> inputs = {
        ResponseInput::amount_of(r.tendon), ResponseInput::amount_of(r.air),
        ResponseInput::amount_of(r.clamp), ResponseInput::amount_of(r.pull),
        ResponseInput::force_at(r.body, tip, {0, 0, 1})};
    const std::uint64_t before = r.world.state_hash();
    const std::vector<Response> d = value(r.world.derivatives(inputs));
    CHECK(r.world.state_hash() == before);
    REQUIRE(d.size() == inputs.size());
    for (std::size_t i = 0; i < 4; ++i) {
      CAPTURE(i);
      const EffectId effect = inputs[i].effect;
      const double amount = i == 0 ? 30 : i == 1 ? 200 : 1;
      against_differences(r.world, d[i], 1e-3 * amount, 2e-5,
                          [&](World& w, double by) { value(w.set_amount(effect, amount + by)); });
      CHECK(d[i].unstable_directions == 0);
    }
    against_differences(r.world, d[4], 1e-2, 2e-5, [&](World& w, double by) {
      value(w.add_force_at(r.body, tip, {0, 0, by}));
    });
    // The work of one force on the way of another is the same the other way round.
    const std::vector<Response> both = value(r.world.derivatives(std::vector{
        ResponseInput::force_at(r.body, tip, {0, 1, 0}), ResponseInput::force_at(r.body, tip, {1, 0, 0})}));
    Vec3 a{}, b{};
    const Index node = nearest_node(r.world.rest_positions(r.body), tip);
    a = both[0].of_node(0, node);
    b = both[1].of_node(0, node);
    CHECK(norm(a) > 0);
    CHECK(norm(b) > 0);
    // Steps afterwards go on as if nobody had asked.
    World twin = robot(element).world;
    must_advance(r.world, 0.1);
    must_advance(twin, 0.1);
    CHECK(r.world.state_hash() == twin.state_hash());
  }
}

TEST_CASE("a chamber with gas and a contact answer to what is supplied and to what presses",
          "[derivatives]") {
  World world = make_world(tight());
  const BodyId body = add_body(world, scene_mesh("finger_small"), isochor::Element::tet4_edge_smoothed,
                               neo_hookean(1e5, 0.5), 1070);
  add_volume(world, body);
  hold(world, body, {"clamped"}, {}, {}, isochor::Curve::constant(1));
  isochor::CavityDef def;
  def.body = body;
  def.surfaces = {"chamber"};
  def.control = isochor::CavityControl::gas;
  def.amount = isochor::Curve::constant(1);
  const EffectId gas = value(world.add(isochor::cavity(def)));
  value(world.set_amount(gas, 1.02));
  must_advance(world);
  const std::vector<Response> d = value(world.derivatives(std::vector{ResponseInput::amount_of(gas)}));
  CHECK(d[0].regular);
  against_differences(world, d[0], 1e-5, 1e-4,
                      [&](World& w, double by) { value(w.set_amount(gas, 1.02 + by)); });
}

TEST_CASE("what has no derivative says so", "[derivatives]") {
  // A body that nothing holds.
  World loose = make_world(tight(isochor::implicit_euler()));
  const BodyId free = add_body(loose, box({1, 1, 1}), isochor::Element::tet4, neo_hookean(1e4, 0.3));
  must_advance(loose, 0.1);
  CHECK_THAT(
      refusal(loose.derivatives(std::vector{ResponseInput::force_at(free, {0.5, 0.5, 0.5}, {1, 0, 0})})),
      ContainsSubstring("singular"));
  Robot r = robot(isochor::Element::tet4);
  CHECK_THAT(refusal(r.world.derivatives(std::vector{ResponseInput::force_at(r.body, {9, 0, 0}, {1, 0, 0})})),
             ContainsSubstring("not in body"));
  CHECK_THAT(refusal(r.world.derivatives(std::vector{ResponseInput::amount_of(EffectId{77})})),
             ContainsSubstring("no effect number 77"));
  CHECK(value(r.world.derivatives({})).empty());
  // A block that stands on a floor with friction, held from the side.
  World pressed = make_world(tight());
  const BodyId body = add_body(pressed, box({2, 2, 2}), isochor::Element::tet4, neo_hookean(1e4, 0.4), 1000);
  add_volume(pressed, body, isochor::VolumeSpace::element);
  const EffectId top = hold(pressed, body, {"z1"}, {}, {0, 0, -0.05}, isochor::Curve::constant(1));
  isochor::ContactDef floor;
  floor.body = body;
  floor.surfaces = {"z0"};
  floor.obstacle.shape = isochor::ObstacleShape::plane;
  floor.obstacle.position = {0, 0, -0.001};
  floor.obstacle.axis = {0, 0, 1};
  floor.friction = 0.5;
  value(pressed.add(isochor::contact(floor)));
  must_advance(pressed);
  const Response d = value(pressed.derivatives(std::vector{ResponseInput::amount_of(top)})).front();
  CHECK_FALSE(d.regular);
  CHECK_THAT(d.note, ContainsSubstring("friction"));
}
