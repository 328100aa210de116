// Ids of bodies and effects: whose they are, and what is said about one that leads nowhere.
#include "engine/scene/ids.h"

#include "support/worlds.h"

using namespace test;
using isochor::BodyId;
using isochor::EffectId;
using isochor::World;

namespace {

struct Pair {
  World world = make_world(static_options());
  BodyId first = add_body(world, box({1, 1, 1}), isochor::Element::tet4, neo_hookean(1e5, 0.3));
  BodyId second = add_body(world, block({2, 0, 0}, {3, 1, 1}, {2, 2, 2}), isochor::Element::tet4,
                           neo_hookean(1e5, 0.3), 1000, "other");
};

template <class T>
std::string refusal(const isochor::Result<T>& result) {
  REQUIRE_FALSE(result.ok());
  return result.error();
}

}  // namespace

TEST_CASE("an id of another world is refused by all that take one") {
  std::vector<std::string> log;
  isochor::WorldOptions options = static_options();
  options.log = [&](const std::string& line) { log.push_back(line); };
  World world = make_world(options);
  const BodyId own = add_body(world, box({1, 1, 1}), isochor::Element::tet4, neo_hookean(1e5, 0.3));
  hold(world, own, {"x0"});
  Pair others;
  const EffectId effect = hold(others.world, others.first, {"x0"});

  CHECK_THAT(refusal(world.check(others.first)), ContainsSubstring("body number 0 belongs to another world"));
  CHECK_THAT(refusal(world.check(effect)), ContainsSubstring("effect number 0 belongs to another world"));
  CHECK(world.check(own));
  value(world.compile());
  const std::vector<isochor::Vec3> x(world.positions(own).begin(), world.positions(own).end());
  CHECK_THAT(refusal(world.set_positions(others.first, x)), ContainsSubstring("another world"));
  CHECK_THAT(refusal(world.set_amount(effect, 1)), ContainsSubstring("another world"));

  // Calls that return a value return nothing and say why in the log.
  log.clear();
  CHECK(world.positions(others.first).empty());
  CHECK(world.velocities(others.first).empty());
  CHECK(world.rest_positions(others.first).empty());
  CHECK(world.mesh(others.first).nodes.empty());
  CHECK(world.body_name(others.first).empty());
  CHECK(world.measures(others.first).mass == 0);
  CHECK(world.fields(others.first).cell_J.empty());
  CHECK(world.reaction(effect)[0] == isochor::Vec3{});
  CHECK(world.effect_name(effect).empty());
  CHECK(log.size() == 9);
  for (const std::string& line : log) CHECK_THAT(line, ContainsSubstring("another world"));
}

TEST_CASE("an effect about a body of another world does not compile") {
  Pair mine, others;
  isochor::VolumeDef rows;
  rows.name = "rows";
  rows.body = others.second;
  value(mine.world.add(isochor::volume(rows)));
  CHECK_THAT(refusal(mine.world.compile()),
             ContainsSubstring("rows") && ContainsSubstring("body number 1 belongs to another world"));
}

TEST_CASE(
    "an id that says nothing stands for the only body, and is refused by calls where there are several") {
  World one = make_world(static_options());
  const BodyId only = add_body(one, box({1, 1, 1}), isochor::Element::tet4, neo_hookean(1e5, 0.3));
  hold(one, {}, {"x0"});
  value(one.compile());
  CHECK(one.positions({}).data() == one.positions(only).data());

  // Of several: a definition that names none is about the first, a call must say.
  Pair two;
  hold(two.world, {}, {"x0"});
  hold(two.world, two.second, {"x0"});
  value(two.world.compile());
  CHECK_THAT(refusal(two.world.check(BodyId{})),
             ContainsSubstring("no body is named") && ContainsSubstring("2 in this world"));
  CHECK_THAT(refusal(two.world.check(EffectId{})), ContainsSubstring("no effect is named"));
  CHECK(two.world.positions({}).empty());
  CHECK_THAT(refusal(two.world.set_amount({}, 1)), ContainsSubstring("no effect is named"));
}

TEST_CASE("bodies can be given by number before there is a world") {
  Pair two;
  hold(two.world, BodyId{0}, {"x0"});
  hold(two.world, BodyId{1}, {"y0"});
  value(two.world.compile());
  CHECK(two.world.positions(BodyId{1}).data() == two.world.positions(two.second).data());
  CHECK_THAT(refusal(two.world.check(BodyId{2})), ContainsSubstring("there is no body number 2"));
  CHECK_THAT(refusal(two.world.check(BodyId{-1})), ContainsSubstring("there is no body number -1"));
  // Numbers order ids, whoever they came from.
  CHECK(BodyId{1} == two.second);
  CHECK(BodyId{0} < two.second);
}

TEST_CASE("a place that was given away again is not the old thing") {
  using isochor::WorldNumbers;
  const std::uint64_t world = WorldNumbers::next_world();
  isochor::Slots places;
  for (int k = 0; k < 3; ++k) places.take();
  const BodyId old = WorldNumbers::make<isochor::BodyTag>(2, world, places.generation(2));
  CHECK(WorldNumbers::look_up(old, places, world) == WorldNumbers::Found::here);
  places.release(2);
  CHECK(WorldNumbers::look_up(old, places, world) == WorldNumbers::Found::removed);
  CHECK(WorldNumbers::look_up(BodyId{2}, places, world) == WorldNumbers::Found::removed);
  CHECK(places.take() == 2);
  CHECK(WorldNumbers::look_up(BodyId{2}, places, world) == WorldNumbers::Found::here);
  const auto found = WorldNumbers::look_up(old, places, world);
  CHECK(found == WorldNumbers::Found::removed);
  CHECK(isochor::why_not(found, "body", old.number(), 3) == "body number 2 was removed");
}
