// Worlds that change while they live. The judge: a world that is changed before it moves has the bits of one
// that was built that way; what a change does not touch keeps its bits; a change that fails leaves no trace.
#include <functional>
#include <random>

#include "engine/base/base.h"
#include "isochor/batch.h"
#include "support/worlds.h"

using namespace test;
using Catch::Matchers::WithinAbs;
using isochor::BodyId;
using isochor::CompileWork;
using isochor::EffectId;
using isochor::Element;
using isochor::norm;
using isochor::World;

namespace {

// Two blocks, one held, with rows, a support, a contact with the floor and a force.
struct Scene {
  double young = 1e5, density = 1000, friction = 0.3, compliance = 1e-8, force = 1;
  bool second = true, contact = true, spring = false;
  Element element = Element::tet4;
  isochor::SchemePtr scheme = isochor::implicit_euler();
};

isochor::EffectPtr floor_contact(BodyId body, const Scene& s) {
  isochor::ContactDef def;
  def.body = body;
  def.surfaces = {"z0"};
  def.obstacle.shape = isochor::ObstacleShape::plane;
  def.obstacle.position = {0, 0, -0.01};
  def.obstacle.axis = {0, 0, 1};
  def.friction = s.friction;
  def.compliance = s.compliance;
  return isochor::contact(def);
}

isochor::EffectPtr pull(BodyId body, double force) {
  isochor::PointForceDef def;
  def.where.body = body;
  def.where.surfaces = {"x1"};
  def.force = {force, 0, 0.5 * force};
  def.amount = isochor::Curve::constant(1);
  return isochor::point_force(def);
}

isochor::EffectPtr spring_at(BodyId body) {
  isochor::DirichletDef def;
  def.name = "spring";
  def.where.body = body;
  def.points = {{0.9, 0.4, 0.4}};
  def.treatment = isochor::SupportTreatment::stiffness;
  def.stiffness = 50;
  return isochor::dirichlet(def);
}

struct Built {
  World world;
  BodyId first{}, second{};
  EffectId held{}, contact{}, force{}, spring{};
};

BodyId add_second(World& world, const Scene& s) {
  return add_body(world, block({2, 0, 0}, {3, 1, 1}, {2, 2, 2}), s.element, neo_hookean(2e5, 0.3), 900,
                  "second");
}

Built build(const Scene& s) {
  isochor::WorldOptions options;
  options.scheme = s.scheme;
  options.threads = 1;
  options.gravity = {0, 0, -9.81};
  Built b{make_world(options)};
  b.first = add_body(b.world, box({2, 2, 2}), s.element, neo_hookean(s.young, 0.5), s.density, "first");
  add_volume(b.world, b.first);
  b.held = hold(b.world, b.first, {"x0"}, {}, {}, isochor::Curve::constant(1));
  b.force = value(b.world.add(pull(b.first, s.force)));
  if (s.second) b.second = add_second(b.world, s);
  if (s.contact && s.second) b.contact = value(b.world.add(floor_contact(b.second, s)));
  if (s.spring) b.spring = value(b.world.add(spring_at(b.first)));
  return b;
}

void run(World& world, int steps, double h = 0.01) {
  for (int k = 0; k < steps; ++k) must_advance(world, h);
}

// Positions and velocities of all bodies.
std::vector<double> motion(const World& world) {
  std::vector<double> all{world.time()};
  for (const BodyId b : world.bodies()) {
    for (const auto& list : {world.positions(b), world.velocities(b)}) {
      for (const Vec3& v : list) all.insert(all.end(), {v.x, v.y, v.z});
    }
  }
  return all;
}

void same_motion(const World& a, const World& b) {
  CHECK(motion(a) == motion(b));
}

template <class T>
std::string refusal(const isochor::Result<T>& result) {
  REQUIRE_FALSE(result.ok());
  return result.error();
}

}  // namespace

TEST_CASE("a world that is changed before it moves is the world that was built that way", "[living]") {
  struct Case {
    const char* what;
    std::function<void(Scene&)> built;
    std::function<void(Built&, const Scene&)> changed;
    CompileWork work;
  };
  const Case cases[] = {
      {"material", [](Scene& s) { s.young = 3e4; },
       [](Built& b, const Scene& s) { value(b.world.set_material(b.first, "", neo_hookean(s.young, 0.5))); },
       CompileWork::numbers},
      {"density", [](Scene& s) { s.density = 1300; },
       [](Built& b, const Scene& s) { value(b.world.set_density(b.first, "", s.density)); },
       CompileWork::numbers},
      {"friction", [](Scene& s) { s.friction = 0.7; },
       [](Built& b, const Scene& s) { value(b.world.replace(b.contact, floor_contact(b.second, s))); },
       CompileWork::numbers},
      {"compliance of contact", [](Scene& s) { s.compliance = 1e-7; },
       [](Built& b, const Scene& s) { value(b.world.replace(b.contact, floor_contact(b.second, s))); },
       CompileWork::numbers},
      {"force", [](Scene& s) { s.force = -2; },
       [](Built& b, const Scene& s) { value(b.world.replace(b.force, pull(b.first, s.force))); },
       CompileWork::numbers},
      {"effect added", [](Scene& s) { s.spring = true; },
       [](Built& b, const Scene&) { b.spring = value(b.world.add(spring_at(b.first))); },
       CompileWork::structure},
      {"effect removed", [](Scene& s) { s.contact = false; },
       [](Built& b, const Scene&) { value(b.world.remove(b.contact)); }, CompileWork::structure},
      {"body removed", [](Scene& s) { s.second = false; },
       [](Built& b, const Scene&) {
         value(b.world.remove(b.contact));
         value(b.world.remove(b.second));
       },
       CompileWork::structure},
  };
  for (const Element element : {Element::tet4, Element::tet4_edge_smoothed, Element::tet10}) {
    for (const auto& scheme : {isochor::implicit_euler(), isochor::bdf2()}) {
      for (const Case& c : cases) {
        CAPTURE(c.what, static_cast<int>(element));
        Scene before;
        before.element = element;
        before.scheme = scheme;
        Scene after = before;
        c.built(after);
        Built changed = build(before), built = build(after);
        value(changed.world.compile());
        c.changed(changed, after);
        value(changed.world.compile());
        CHECK(changed.world.compile_report().work == c.work);
        run(changed.world, 3);
        run(built.world, 3);
        // Residuals too: they are relative to the stiffness of the scene as it is.
        CHECK(must_advance(changed.world, 0.01).force_residual ==
              must_advance(built.world, 0.01).force_residual);
        same_motion(changed.world, built.world);
        CHECK(changed.world.state_hash() == built.world.state_hash());
      }
    }
  }
}

TEST_CASE("what a change does not touch keeps its bits", "[living]") {
  for (const auto& scheme : {isochor::implicit_euler(), isochor::bdf2(), isochor::generalized_alpha()}) {
    Scene s;
    s.scheme = scheme;
    Built b = build(s), twin = build(s);
    run(b.world, 5);
    run(twin.world, 5);
    const std::vector<double> before = motion(b.world);
    const auto reaction = b.world.reaction(b.held);
    const double energy = b.world.elastic_energy();
    // A body and a support beside, and away again: nobody else may notice.
    const BodyId extra = add_body(b.world, block({5, 0, 0}, {6, 1, 1}, {1, 1, 1}), Element::tet4,
                                  neo_hookean(1e5, 0.3), 1000, "extra");
    const EffectId hold_extra = hold(b.world, extra, {"x0"}, {}, {}, isochor::Curve::constant(1));
    value(b.world.compile());
    CHECK(b.world.compile_report().work == CompileWork::structure);
    CHECK(b.world.compile_report().seconds > 0);
    std::vector<double> there = motion(b.world);
    there.resize(before.size());
    CHECK(there == before);
    CHECK(b.world.reaction(b.held) == reaction);
    CHECK(b.world.elastic_energy() == energy);
    value(b.world.remove(hold_extra));
    value(b.world.remove(extra));
    value(b.world.compile());
    CHECK(motion(b.world) == before);
    CHECK(b.world.state_hash() == twin.world.state_hash());
    run(b.world, 5);
    run(twin.world, 5);
    CHECK(b.world.state_hash() == twin.world.state_hash());
  }
}

TEST_CASE("ids of what is gone are refused by name, and what took its place is not it", "[living]") {
  Built b = build({});
  run(b.world, 1);
  CHECK_THAT(refusal(b.world.remove(b.second)), ContainsSubstring("named by effect"));
  value(b.world.remove(b.contact));
  value(b.world.remove(b.second));
  CHECK_THAT(refusal(b.world.check(b.second)), ContainsSubstring("was removed"));
  CHECK_THAT(refusal(b.world.remove(b.contact)), ContainsSubstring("was removed"));
  CHECK_THAT(refusal(b.world.set_amount(b.contact, 1)), ContainsSubstring("was removed"));
  CHECK(b.world.positions(b.second).empty());
  const BodyId again = add_second(b.world, {});
  CHECK(again.number() == b.second.number());
  CHECK_THAT(refusal(b.world.check(b.second)), ContainsSubstring("was removed"));
  CHECK(b.world.check(again));
  run(b.world, 1);
  CHECK_FALSE(b.world.positions(again).empty());
  CHECK(b.world.body_count() == 2);
  CHECK(b.world.bodies().size() == 2);
}

TEST_CASE("a change that fails is taken back and told once", "[living]") {
  Built b = build({}), twin = build({});
  run(b.world, 3);
  run(twin.world, 3);
  isochor::TractionDef wrong;
  wrong.body = b.first;
  wrong.surface = "no such surface";
  wrong.traction = {1, 0, 0};
  value(b.world.set_material(b.first, "", neo_hookean(1, 0.4)));
  const EffectId gone = value(b.world.add(isochor::traction(wrong)));
  const isochor::StepReport report = b.world.advance(0.01);
  CHECK(report.status == isochor::StepStatus::invalid);
  CHECK_THAT(report.reason, ContainsSubstring("no such surface"));
  CHECK_THAT(refusal(b.world.check(gone)), ContainsSubstring("effect number"));
  CHECK(b.world.state_hash() == twin.world.state_hash());
  run(b.world, 3);
  run(twin.world, 3);
  CHECK(b.world.state_hash() == twin.world.state_hash());
  // Refused at once: nothing waits.
  CHECK_THAT(refusal(b.world.set_density(b.first, "", -1)), ContainsSubstring("-1"));
  CHECK_THAT(refusal(b.world.set_density(b.first, "nowhere", 1)), ContainsSubstring("nowhere"));
  CHECK_THAT(refusal(b.world.set_material(b.first, "", nullptr)), ContainsSubstring("empty"));
  run(b.world, 1);
  run(twin.world, 1);
  CHECK(b.world.state_hash() == twin.world.state_hash());
}

TEST_CASE("a clone goes on with the same bits and leaves the original alone", "[living]") {
  for (const auto& scheme : {isochor::implicit_euler(), isochor::bdf2()}) {
    Scene s;
    s.scheme = scheme;
    Built b = build(s);
    run(b.world, 4);
    value(b.world.set_gravity({1, 0, -9}));
    value(b.world.add_force(b.first, 3, {0, 0.1, 0}));
    World copy = value(b.world.clone());
    CHECK(copy.state_hash() == b.world.state_hash());
    const std::uint64_t before = b.world.state_hash();
    run(copy, 4);
    CHECK(b.world.state_hash() == before);
    run(b.world, 4);
    CHECK(copy.state_hash() == b.world.state_hash());
    value(copy.set_material(b.first, "", neo_hookean(1e3, 0.5)));
    run(copy, 1);
    run(b.world, 1);
    CHECK(copy.state_hash() != b.world.state_hash());
    CHECK(copy.save().size() == b.world.save().size());
  }
}

TEST_CASE("reset begins again with the bits of a new world", "[living]") {
  for (const auto& scheme : {isochor::implicit_euler(), isochor::generalized_alpha(), isochor::bdf2()}) {
    Scene s;
    s.scheme = scheme;
    Built b = build(s), fresh = build(s);
    run(b.world, 4);
    value(b.world.set_gravity({5, 0, 0}));
    value(b.world.set_amount(b.force, 4));
    value(b.world.add_force(b.first, 3, {0, 1, 0}));
    run(b.world, 2);
    value(b.world.reset());
    CHECK(b.world.time() == 0);
    run(b.world, 4);
    run(fresh.world, 4);
    CHECK(b.world.state_hash() == fresh.world.state_hash());
  }
}

TEST_CASE("forces of the host are those of an effect", "[living]") {
  Scene s;
  s.force = 0;
  Built by_host = build(s), by_effect = build(s);
  std::vector<Vec3> forces(by_host.world.positions(by_host.first).size());
  for (std::size_t i = 0; i < forces.size(); ++i) forces[i] = {0.01 * static_cast<double>(i % 5), 0, 0.02};
  for (std::size_t i = 0; i < forces.size(); ++i) {
    isochor::PointForceDef one;
    one.where.body = by_effect.first;
    one.where.nodes = {static_cast<Index>(i)};
    one.force = forces[i];
    one.amount = isochor::Curve::constant(1);
    if (dot(one.force, one.force) > 0) value(by_effect.world.add(isochor::point_force(one)));
  }
  value(by_host.world.set_forces(by_host.first, forces));
  run(by_host.world, 3);
  run(by_effect.world, 3);
  const std::vector<double> a = motion(by_host.world), b = motion(by_effect.world);
  REQUIRE(a.size() == b.size());
  for (std::size_t i = 0; i < a.size(); ++i) CHECK_THAT(a[i], WithinAbs(b[i], 1e-12));
  CHECK_THAT(by_host.world.energies().loads, WithinAbs(by_effect.world.energies().loads, 1e-12));
  by_host.world.clear_forces();
  CHECK(by_host.world.energies().loads == 0);
  // At a point: the resultant is the force, at the place where it is.
  const Vec3 point{0.3, 0.6, 0.7};
  Scene plain;
  plain.force = 0;
  plain.second = false;
  Built held = build(plain);
  value(held.world.set_gravity({0, 0, 0}));
  value(held.world.add_force_at(held.first, point, {2, -1, 3}));
  run(held.world, 400, 0.05);
  const auto reaction = held.world.reaction(held.held);
  CHECK_THAT(reaction[0].x, WithinAbs(-2, 1e-6));
  CHECK_THAT(reaction[0].z, WithinAbs(-3, 1e-6));
  CHECK_THAT(refusal(held.world.add_force_at(held.first, {9, 9, 9}, {1, 0, 0})),
             ContainsSubstring("not in body"));
  CHECK_THAT(refusal(held.world.add_force(held.first, 4000, {1, 0, 0})), ContainsSubstring("4000"));
  CHECK_THAT(refusal(held.world.add_force(held.first, 0, {NAN, 0, 0})), ContainsSubstring("finite"));
  CHECK_THAT(refusal(held.world.set_forces(held.first, {})), ContainsSubstring("one a node"));
}

TEST_CASE("a pose that a host sets carries supports and obstacles", "[living]") {
  for (const bool statics : {true, false}) {
    CAPTURE(statics);
    Scene s;
    s.second = false;
    s.force = 0;
    if (statics) s.scheme = isochor::statics();
    Built by_pose = build(s);
    isochor::WorldOptions options = statics ? static_options() : dynamic_options();
    options.gravity = {0, 0, -9.81};
    World by_curve = make_world(options);
    const BodyId body = add_body(by_curve, box({2, 2, 2}), s.element, neo_hookean(s.young, 0.5), 1000);
    add_volume(by_curve, body);
    const EffectId held = hold(by_curve, body, {"x0"}, {}, {0.2, 0, 0.1},
                               statics ? isochor::Curve::ramp(1) : isochor::Curve{{{0, 0}, {0.01, 1}}});
    value(by_pose.world.set_pose(by_pose.held, {.position = {0.2, 0, 0.1}}));
    const double h = statics ? 1 : 0.01;
    must_advance(by_pose.world, h);
    must_advance(by_curve, h);
    const auto a = by_pose.world.positions(by_pose.first), b = by_curve.positions(body);
    for (std::size_t i = 0; i < a.size(); ++i) CHECK_THAT(norm(a[i] - b[i]), WithinAbs(0, 1e-9));
    CHECK_THAT(norm(by_pose.world.reaction(by_pose.held)[0] - by_curve.reaction(held)[0]),
               WithinAbs(0, 1e-4));
  }
  // A floor that is raised lifts what stands on it.
  Scene s;
  Built b = build(s);
  run(b.world, 40);
  const double before = b.world.measures(b.second).center_of_mass.z;
  for (int k = 1; k <= 20; ++k) {
    value(b.world.set_pose(b.contact, {.position = {0, 0, 0.005 * k}}));
    run(b.world, 1);
  }
  run(b.world, 20);
  CHECK_THAT(b.world.measures(b.second).center_of_mass.z - before, WithinAbs(0.1, 0.01));
  CHECK_THAT(refusal(b.world.set_pose(b.force, {})), ContainsSubstring("has no pose"));
  CHECK_THAT(refusal(b.world.set_pose(b.held, {.rotation = {2, 0, 0, 0}})), ContainsSubstring("length 2"));
}

TEST_CASE("what a host has set survives saving, and a loaded world goes on with the same bits", "[living]") {
  Built a = build({}), b = build({});
  run(a.world, 2);
  value(a.world.set_gravity({0, 3, -9}));
  value(a.world.set_pose(a.held, {.position = {0.01, 0, 0}}));
  value(a.world.add_force(a.first, 7, {0, 0, 1}));
  run(a.world, 2);
  value(b.world.load(a.world.save()));
  CHECK(a.world.state_hash() == b.world.state_hash());
  run(a.world, 3);
  run(b.world, 3);
  CHECK(a.world.state_hash() == b.world.state_hash());
}

TEST_CASE("views of positions stay good while only numbers change", "[living]") {
  Built b = build({});
  run(b.world, 2);
  const auto view = b.world.positions(b.first);
  value(b.world.set_material(b.first, "", neo_hookean(5e4, 0.5)));
  run(b.world, 2);
  CHECK(view.data() == b.world.positions(b.first).data());
  CHECK(b.world.step(1e30).status != isochor::StepStatus::converged);
  CHECK(view.data() == b.world.positions(b.first).data());
  value(b.world.reset());
  CHECK(view.data() == b.world.positions(b.first).data());
  (void)b.world.save();
  value(b.world.load(b.world.save()));
  CHECK(view.data() == b.world.positions(b.first).data());
}

TEST_CASE("worlds of a batch have the bits that they have alone", "[living][batch]") {
  Built b = build({});
  run(b.world, 2);
  isochor::WorldBatch batch = value(isochor::WorldBatch::create(b.world, 5, 2));
  std::vector<World> alone;
  std::vector<double> amounts;
  for (int w = 0; w < 5; ++w) {
    alone.push_back(value(b.world.clone()));
    amounts.push_back(0.5 * w);
  }
  value(batch.set_amounts(b.force, amounts));
  value(batch[3].set_material(b.first, "", neo_hookean(4e4, 0.5)));
  value(alone[3].set_material(b.first, "", neo_hookean(4e4, 0.5)));
  for (std::size_t w = 0; w < 5; ++w) value(alone[w].set_amount(b.force, amounts[w]));
  for (int k = 0; k < 3; ++k) {
    const auto reports = batch.advance(0.01);
    REQUIRE(reports.size() == 5);
    for (std::size_t w = 0; w < 5; ++w) {
      CHECK(reports[w].status == isochor::StepStatus::converged);
      must_advance(alone[w], 0.01);
    }
  }
  for (std::size_t w = 0; w < 5; ++w)
    CHECK(batch[static_cast<Index>(w)].state_hash() == alone[w].state_hash());
  // All at once.
  const std::size_t nodes = b.world.positions(b.first).size();
  std::vector<Vec3> x(5 * nodes);
  value(batch.positions(b.first, x));
  for (std::size_t w = 0; w < 5; ++w) CHECK(x[w * nodes + 7] == alone[w].positions(b.first)[7]);
  CHECK_THAT(refusal(batch.velocities(b.first, std::span(x).first(3))), ContainsSubstring("room for 3"));
  CHECK_THAT(refusal(batch.set_amounts(b.force, std::vector<double>{1})), ContainsSubstring("one a world"));
  CHECK_THAT(refusal(batch.set_amounts(b.contact, amounts)), ContainsSubstring("no amount"));
  CHECK_THAT(refusal(isochor::WorldBatch::create(b.world, 0)), ContainsSubstring("0 worlds"));
  // One begins again, the others go on.
  const std::uint64_t before = batch[1].state_hash();
  value(batch.reset(std::vector<std::uint8_t>{1, 0, 0, 0, 0}));
  CHECK(batch[0].time() == 0);
  CHECK(batch[1].state_hash() == before);
  const auto memory = batch.memory();
  CHECK(memory.each > 1000);
  CHECK(memory.shared > 1000);
}

// Changes in any order, made of a seed: the world is asked after each for what must hold whatever they are.
TEST_CASE("random changes leave worlds whole", "[living]") {
  for (unsigned seed = 1; seed <= 24; ++seed) {
    CAPTURE(seed);
    std::mt19937 random(seed);
    const auto pick = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
    const std::array<Element, 3> elements{Element::tet4, Element::tet4_edge_smoothed, Element::tet10};
    const std::array<isochor::SchemePtr, 4> schemes{isochor::implicit_euler(), isochor::bdf2(),
                                                    isochor::generalized_alpha(), isochor::statics()};
    Scene s;
    s.element = elements[static_cast<std::size_t>(pick(3))];
    s.scheme = schemes[static_cast<std::size_t>(pick(4))];
    s.second = false;
    Built b = build(s);
    std::vector<BodyId> guests;
    std::vector<EffectId> springs, floors;
    for (int k = 0; k < 14; ++k) {
      switch (pick(8)) {
        case 0: {
          const double x = 3.0 + 2 * k;
          const BodyId guest = add_body(b.world, block({x, 0, 0}, {x + 1, 1, 1}, {1, 1, 2}), s.element,
                                        neo_hookean(1e5, 0.4), 900, "guest " + std::to_string(k));
          // Whatever the scheme, something holds it.
          springs.push_back(hold(b.world, guest, {"x0"}, {}, {}, isochor::Curve::constant(1)));
          guests.push_back(guest);
          break;
        }
        case 1:
          if (!guests.empty()) {
            value(b.world.remove(springs.back()));
            if (!floors.empty()) value(b.world.remove(floors.back()));
            value(b.world.remove(guests.back()));
            floors.clear();
            springs.pop_back();
            guests.pop_back();
          }
          break;
        case 2:
          if (floors.empty() && !guests.empty())
            floors.push_back(value(b.world.add(floor_contact(guests.back(), s))));
          break;
        case 3:
          value(b.world.set_material(b.first, "", neo_hookean(2e4 * (1 + pick(5)), 0.5)));
          break;
        case 4:
          value(b.world.set_gravity({0.1 * pick(5), 0, -1.0 * pick(10)}));
          break;
        case 5:
          value(b.world.replace(b.force, pull(b.first, pick(7) - 3)));
          break;
        case 6:
          value(b.world.add_force(b.first, pick(8), {0, 0.1 * pick(4), 0}));
          break;
        default:
          value(b.world.set_pose(b.held, {.position = {0.001 * pick(9), 0, 0}}));
      }
      if (pick(3) == 0) continue;  // several changes at once
      must_advance(b.world, 0.01);
      for (const double v : motion(b.world)) REQUIRE(std::isfinite(v));
      // A clone, and a state that is saved and loaded, are this world.
      World copy = value(b.world.clone());
      REQUIRE(copy.state_hash() == b.world.state_hash());
      value(copy.load(b.world.save()));
      must_advance(copy, 0.01);
      must_advance(b.world, 0.01);
      REQUIRE(copy.state_hash() == b.world.state_hash());
      REQUIRE(b.world.body_count() == 1 + static_cast<Index>(guests.size()));
    }
    value(b.world.reset());
    for (const double v : motion(b.world)) REQUIRE(std::isfinite(v));
  }
}

TEST_CASE("what comes into a moving world is at rest there, whatever the time scheme remembers", "[living]") {
  for (const auto& scheme :
       {isochor::implicit_euler(), isochor::bdf2(), isochor::generalized_alpha(), isochor::newmark()}) {
    Scene s;
    s.scheme = scheme;
    s.second = false;
    Built b = build(s);
    run(b.world, 4);
    value(b.world.set_gravity({}));
    const BodyId guest = add_second(b.world, s);
    run(b.world, 4);
    const auto x = b.world.positions(guest), rest = b.world.rest_positions(guest);
    for (std::size_t i = 0; i < x.size(); ++i) CHECK(norm(x[i] - rest[i]) < 1e-12);
  }
}

TEST_CASE("what a host has set survives a change of something else", "[living]") {
  Built b = build({}), twin = build({});
  for (Built* w : {&b, &twin}) {
    value(w->world.set_amount(w->force, 3));
    value(w->world.set_pose(w->held, {.position = {0.02, 0, 0}}));
    run(w->world, 2);
  }
  value(b.world.set_density(b.second, "", 950));
  value(b.world.compile());
  value(b.world.set_density(b.second, "", 900));
  value(b.world.compile());
  CHECK(b.world.state_hash() == twin.world.state_hash());
  run(b.world, 3);
  run(twin.world, 3);
  CHECK(b.world.state_hash() == twin.world.state_hash());
}

TEST_CASE("a step reports what was compiled since the last one, for whichever call") {
  World world = make_world(static_options());
  const BodyId body = add_body(world, box({1, 1, 1}), Element::tet4, neo_hookean(1e5, 0.3));
  hold(world, body, {"x0"});
  value(world.compile());
  const isochor::StepReport first = world.step(0.5);
  CHECK(first.compiled.work == CompileWork::structure);
  CHECK(first.compiled.seconds > 0);
  CHECK(world.step(0.1).compiled.work == CompileWork::nothing);

  // Readers compile changes that wait; the next step tells of both.
  hold(world, body, {"y0"}, {{0, 1, 0}});
  CHECK(world.elastic_energy() == 0);
  CHECK(world.compile_report().work == CompileWork::structure);
  value(world.set_density(body, "", 500));
  CHECK(world.measures(body).mass > 0);
  CHECK(world.compile_report().work == CompileWork::numbers);
  CHECK(world.step(0.1).compiled.work == CompileWork::structure);
  const isochor::StepReport last = world.step(0.1);
  CHECK(last.compiled.work == CompileWork::nothing);
  CHECK(last.compiled.seconds == 0);
}
