// A world that people play with: sliders, hands, failures, recordings.
#include "live/simulation.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>

#include "catch.h"
#include "scene/small_scene.h"
#include "scenes/library.h"

using namespace isochor;
using namespace isochor::live;

namespace {

const Overrides kMoving = {"analysis.type=dynamic", "analysis.steps=10", "analysis.duration=0.2"};

std::unique_ptr<Simulation> make(const Overrides& overrides = {}, SimulationOptions options = {}) {
  auto s = Simulation::make(test::small_scene(overrides), std::move(options));
  if (!s) FAIL(s.error());
  return std::move(s).value();
}

std::size_t dial(const Simulation& s, const std::string& name) {
  for (std::size_t i = 0; i < s.dials().size(); ++i) {
    if (s.dials()[i].name.find(name) != std::string::npos) return i;
  }
  FAIL("there is no control " << name);
  return 0;
}

Result<void> set(Simulation& s, const std::string& name, double value) {
  Command c;
  c.action = Action::set;
  c.control = static_cast<int>(dial(s, name));
  c.value = value;
  return s.apply(c);
}

Command on_triangle(Action action, Index triangle) {
  Command c;
  c.action = action;
  c.triangle = triangle;
  c.weights = {1.0 / 3, 1.0 / 3, 1.0 / 3};
  return c;
}

// A triangle of the face x = 2.
Index far_triangle(const Simulation& s) {
  const PageScene& shape = s.shape();
  for (std::size_t t = 0; t < shape.triangles.size() / 3; ++t) {
    double least = 1e9;
    for (std::size_t k = 0; k < 3; ++k)
      least = std::min(least, shape.rest[static_cast<std::size_t>(shape.triangles[3 * t + k])].x);
    if (least > 1.99) return static_cast<Index>(t);
  }
  FAIL("no such triangle");
  return 0;
}

double tip(const Simulation& s, std::size_t axis) {
  return s.picture(false).measures[axis];
}

Command plain(Action action) {
  Command c;
  c.action = action;
  return c;
}

}  // namespace

TEST_CASE("nothing touched, a live scene has the bits of a run; so has one that was reset") {
  for (const Overrides& overrides : {Overrides{}, kMoving}) {
    const SceneDef scene = test::small_scene(overrides);
    const RunResult run = run_scene(scene, {});
    auto s = make(overrides);
    const std::uint64_t beginning = s->picture(false).hash;
    const auto all = [&] {
      for (int i = 0; i < run.steps_asked; ++i) REQUIRE(s->advance() == StepEnd::done);
      (void)s->picture(true);
      return s->picture(false).hash;
    };
    CHECK(all() == run.state_hash);
    REQUIRE(set(*s, "Young", 700).ok());
    REQUIRE(set(*s, "pull, times", 0.5).ok());
    REQUIRE(s->apply(on_triangle(Action::pull, far_triangle(*s))).ok());
    s->advance();
    CHECK(s->picture(false).hash != run.state_hash);
    REQUIRE(s->apply(plain(Action::reset)).ok());
    CHECK(s->picture(false).hash == beginning);
    CHECK(s->picture(false).handles.empty());
    CHECK(all() == run.state_hash);
  }
}

TEST_CASE("sliders begin where the scene is, and move it") {
  auto s = make();
  const Picture first = s->picture(false);
  CHECK(first.dials[dial(*s, "Young")] == 1000);
  CHECK(first.dials[dial(*s, "Poisson")] == 0.5);
  for (int i = 0; i < 3; ++i) s->advance();
  const double at_one = tip(*s, 0);
  CHECK(at_one > 0.1);
  CHECK(s->settled());
  REQUIRE(set(*s, "pull, times", 0.5).ok());
  CHECK_FALSE(s->settled());
  REQUIRE(s->advance() == StepEnd::done);
  CHECK(tip(*s, 0) < 0.8 * at_one);
  REQUIRE(set(*s, "Young", 2000).ok());
  const double before = tip(*s, 0);
  REQUIRE(s->advance() == StepEnd::done);
  CHECK(tip(*s, 0) < 0.8 * before);
  REQUIRE(set(*s, "Poisson", 0.3).ok());
  REQUIRE(s->advance() == StepEnd::done);
  REQUIRE(set(*s, "Poisson", 0.5).ok());
  REQUIRE(s->advance() == StepEnd::done);
}

TEST_CASE("a support is moved and turned by hand, little by little, and a reset puts it back") {
  for (const Overrides& kind : {Overrides{}, kMoving}) {
    Overrides overrides = kind;
    overrides.insert(overrides.end(), {"tractions=[]", "metrics=[]"});
    auto s = make(overrides);
    const auto at = [&](const char* name) { return s->picture(false).dials[dial(*s, name)]; };
    const std::uint64_t beginning = s->picture(false).hash;
    CHECK(at("along z") == 0);
    CHECK(at("turned about x") == 0);
    REQUIRE(set(*s, "along z", 0.5).ok());
    CHECK(at("along z") == 0.5);
    for (int i = 0; i < 3; ++i) s->advance();
    CHECK_FALSE(s->settled());
    CHECK(tip(*s, 2) < 0.4);
    for (int i = 0; i < 60; ++i) REQUIRE(s->advance() == StepEnd::done);
    // The face x = 0 is where it is wanted, whatever the rest of a block in motion does.
    const PageScene& shape = s->shape();
    const PageFrame lifted = s->picture(false).frame;
    for (std::size_t v = 0; v < shape.rest.size(); ++v) {
      const Vec3 d = lifted.positions[v] - shape.rest[v] - Vec3{0, 0, 0.5};
      if (shape.rest[v].x == 0) CHECK(dot(d, d) < 1e-18);
    }
    if (!s->dynamic()) {
      CHECK(s->settled());
      CHECK(tip(*s, 2) == Approx(0.5).margin(1e-6));
      // About the middle of the face x = 0.
      REQUIRE(set(*s, "turned about x", 90).ok());
      for (int i = 0; i < 60; ++i) REQUIRE(s->advance() == StepEnd::done);
      CHECK(s->settled());
      CHECK(at("along z") == 0.5);
      const PageFrame turned = s->picture(false).frame;
      for (std::size_t v = 0; v < shape.rest.size(); ++v) {
        const Vec3 r = shape.rest[v] - Vec3{0, 0.5, 0.5};
        const Vec3 d = turned.positions[v] - (Vec3{0, 0.5, 1} + Vec3{r.x, -r.z, r.y});
        CHECK(dot(d, d) < 1e-10);
      }
    }
    REQUIRE(s->apply(plain(Action::reset)).ok());
    CHECK(s->picture(false).hash == beginning);
    CHECK(at("along z") == 0);
  }
}

namespace {

struct HeldEnd {
  std::string text;            // of the directions, for the scene
  std::vector<Vec3> given;     // as they are
  std::vector<Vec3> measured;  // orthonormal, of what they span
};

Vec3 unit(const Vec3& v) {
  return (1 / std::sqrt(dot(v, v))) * v;
}

// One to three directions of any lengths, with more of them than are needed now and then.
HeldEnd random_end(std::mt19937& random, int rank) {
  std::uniform_real_distribution<double> number(-1, 1);
  const auto vector = [&] { return Vec3{number(random), number(random), number(random)}; };
  HeldEnd end;
  const Vec3 a = vector(), b = vector();
  const Vec3 normal = unit(cross(a, b));
  if (rank == 1) end.measured = {unit(a)};
  if (rank == 2) end.measured = {unit(a), cross(normal, unit(a))};
  if (rank == 3) end.measured = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  end.given = {3.0 * a};
  if (rank > 1) end.given.push_back(b);
  if (rank > 2) end.given.push_back(0.5 * normal + 0.2 * a);
  if (number(random) > 0) end.given.push_back(end.given.front() + (rank > 1 ? b : Vec3{}));
  for (const Vec3& d : end.given) {
    end.text += (end.text.empty() ? "[[" : ", [") + std::to_string(d.x) + ", " + std::to_string(d.y) + ", " +
                std::to_string(d.z) + "]";
  }
  end.text += "]";
  return end;
}

// Of the dials of its pose, in their order.
std::vector<std::size_t> pose_of(const Simulation& s, const std::string& name, const std::string& begins) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < s.dials().size(); ++i) {
    const Dial& d = s.dials()[i];
    if (d.group == "Pose of " + name && d.name.rfind(begins, 0) == 0) out.push_back(i);
  }
  return out;
}

// What the name of a dial says: "along z", "turned about (0.6, 0, 0.8)".
Vec3 direction_in(const std::string& name) {
  if (name.back() != ')')
    return {name.back() == 'x' ? 1.0 : 0, name.back() == 'y' ? 1.0 : 0, name.back() == 'z' ? 1.0 : 0};
  Vec3 d{};
  REQUIRE(std::sscanf(name.c_str() + name.find('('), "(%lf, %lf, %lf)", &d.x, &d.y, &d.z) == 3);
  return unit(d);
}

}  // namespace

TEST_CASE("a support that holds single directions is moved along them, and turned in the plane of two") {
  std::mt19937 random(20);
  for (int trial = 0; trial < 9; ++trial) {
    const int rank = 1 + trial % 3;
    const HeldEnd end = random_end(random, rank);
    INFO(end.text);
    // The other end is held by springs: it follows, and no direction is free.
    auto s = make(
        {"tractions=[]", "metrics=[]",
         R"(dirichlet=[{"name": "wall", "where": {"surfaces": "x0"}, "treatment": "stiffness", "stiffness": 50},
                       {"name": "end", "where": {"surfaces": "x1"}, "directions": )" +
             end.text + "}]"});
    const std::uint64_t beginning = s->picture(false).hash;
    const auto ways = pose_of(*s, "support end", "along"), turns = pose_of(*s, "support end", "turned about");
    REQUIRE(ways.size() == static_cast<std::size_t>(rank));
    REQUIRE(turns.size() == (rank == 1 ? 0U : rank == 2 ? 1U : 3U));
    std::vector<double> wanted;
    const auto put = [&](std::size_t dial, double value) {
      Command c = plain(Action::set);
      c.control = static_cast<int>(dial);
      c.value = value;
      REQUIRE(s->apply(c).ok());
      for (int i = 0; i < 60; ++i) REQUIRE(s->advance() == StepEnd::done);
      CHECK(s->settled());
    };
    // The face x = 2 is where a pose has it, in the directions that are held.
    const auto check_face = [&](const Vec3& shift, const Vec3& axis, double angle) {
      const PageFrame frame = s->picture(false).frame;
      for (std::size_t v = 0; v < s->shape().rest.size(); ++v) {
        const Vec3 X = s->shape().rest[v];
        if (X.x != 2) continue;
        const Vec3 r = X - Vec3{2, 0.5, 0.5};
        const Vec3 to = Vec3{2, 0.5, 0.5} + shift + std::cos(angle) * r + std::sin(angle) * cross(axis, r) +
                        ((1 - std::cos(angle)) * dot(axis, r)) * axis;
        for (const Vec3& d : end.measured) CHECK(dot(d, frame.positions[v] - to) == Approx(0).margin(1e-3));
      }
    };
    Vec3 shift{};
    for (std::size_t k = 0; k < ways.size(); ++k) {
      const double way = 0.2 - 0.07 * static_cast<double>(k);
      put(ways[k], way);
      shift += way * direction_in(s->dials()[ways[k]].name);
      CHECK(s->picture(false).dials[ways[k]] == way);
      check_face(shift, {}, 0);
    }
    for (const std::size_t turn : turns) {
      for (const Vec3& d : end.measured)
        CHECK((rank == 3 || std::abs(dot(d, direction_in(s->dials()[turn].name))) < 2e-3));
      put(turn, 25);
      check_face(shift, direction_in(s->dials()[turn].name), 25 * std::numbers::pi / 180);
      put(turn, 0);
    }
    REQUIRE(s->apply(plain(Action::reset)).ok());
    CHECK(s->picture(false).hash == beginning);
    CHECK(s->picture(false).dials[ways[0]] == 0);
  }
}

TEST_CASE("dials of a pose are named after the axes that are held, and after the amount where there is one") {
  const auto names = [](const std::string& rest) {
    auto s = make({"metrics=[]", R"(dirichlet=[{"name": "wall", "where": {"surfaces": "x0"}},
      {"name": "end", "where": {"surfaces": "x1"}, )" +
                                     rest + "}]"});
    std::string out;
    for (const Dial& d : s->dials()) {
      if (d.group == "Pose of support end" || d.group == "Supports") out += d.name + "; ";
    }
    return out;
  };
  CHECK(names(R"("directions": "x")") == "along x; ");
  CHECK(names(R"("directions": [[0, 0, -2], [1, 0, -1]])") == "along x; along z; turned about y; ");
  CHECK(names(R"("directions": [[-3, 0, -4]])") == "along (0.6, 0, 0.8); ");
  CHECK(names(R"("directions": "yx")") == "along x; along y; turned about z; ");
  CHECK(names(R"("directions": "xyz")") ==
        "along x; along y; along z; turned about x; turned about y; turned about z; ");
  CHECK(names(R"("directions": "x", "displacement": [0.1, 0, 0])") == "end; ");
}

TEST_CASE("an obstacle is moved by hand, also one that moves by itself; the picture follows the world") {
  for (const bool moving : {false, true}) {
    const std::string motion =
        moving ? R"(, "keyframes": [{"t": 0}, {"t": 1, "position": [0, 0, -0.3]}])" : std::string();
    auto s =
        make({"tractions=[]", "metrics=[]",
              R"(contacts=[{"name": "table", "obstacle": {"position": [1, 0.5, -0.2])" + motion + "}}]"});
    const auto& shape = s->shape();
    const auto height = [&] {
      double z = 0, count = 0;
      const PageFrame frame = s->picture(false).frame;
      for (std::size_t t = 0; t < shape.triangles.size() / 3; ++t) {
        if (!shape.parts[static_cast<std::size_t>(shape.triangle_part[t])].obstacle) continue;
        z += frame.positions[static_cast<std::size_t>(shape.triangles[3 * t])].z;
        ++count;
      }
      return z / count;
    };
    std::size_t along = 0;
    while (along < s->dials().size() &&
           !(s->dials()[along].group == "Pose of obstacle of table" && s->dials()[along].name == "along z"))
      ++along;
    REQUIRE(along < s->dials().size());
    CHECK(height() == Approx(-0.2));
    REQUIRE(s->advance() == StepEnd::done);
    CHECK(height() == Approx(moving ? -0.3 : -0.2));
    CHECK(s->picture(false).dials[along] == Approx(moving ? -0.1 : 0).margin(1e-12));
    Command c = plain(Action::set);
    c.control = static_cast<int>(along);
    c.value = 0.4;
    REQUIRE(s->apply(c).ok());
    REQUIRE(s->advance() == StepEnd::done);
    // On its way: not where it was, not yet where it is wanted.
    CHECK(height() > (moving ? -0.3 : -0.2) + 1e-3);
    CHECK(height() < 0.1);
    for (int i = 0; i < 40; ++i) REQUIRE(s->advance() == StepEnd::done);
    CHECK(height() == Approx(0.2));
    CHECK(s->settled());
    // It has lifted the free end; contact is where the table is drawn.
    CHECK(tip(*s, 2) > 0.1);
    const PageFrame frame = s->picture(false).frame;
    REQUIRE_FALSE(frame.forces.empty());
    for (const PageForce& f : frame.forces) CHECK(f.at.z == Approx(0.2).margin(1e-4));
    CHECK_FALSE(frame.contacts.empty());
    REQUIRE(s->apply(plain(Action::reset)).ok());
    CHECK(height() == Approx(-0.2));
  }
}

TEST_CASE("what is out of bounds is refused, and nothing has changed") {
  auto s = make();
  s->advance();
  const std::uint64_t hash = s->picture(false).hash;
  const std::vector<double> dials = s->picture(false).dials;
  CHECK(set(*s, "Young", -1).error().find("is not between") != std::string::npos);
  CHECK_FALSE(set(*s, "Poisson", 0.51).ok());
  Command c;
  c.action = Action::set;
  c.control = 1000;
  CHECK(s->apply(c).error().find("control 1000 is not there") != std::string::npos);
  CHECK(s->apply(on_triangle(Action::pull, 100000)).error().find("triangle") != std::string::npos);
  c = plain(Action::release);
  c.handle = 3;
  CHECK(s->apply(c).error().find("handle 3 is not there") != std::string::npos);
  CHECK(s->picture(false).hash == hash);
  CHECK(s->picture(false).dials == dials);
  CHECK_FALSE(s->picture(false).message.empty());
  REQUIRE(s->advance() == StepEnd::done);
  CHECK(s->picture(false).message.empty());
}

TEST_CASE(
    "laws with constants of their own have one slider for all of them; refined bodies keep their numbers") {
  for (const std::string& refine : {std::string(), std::string(R"("refine": 1, )")}) {
    const auto block = [&](const std::string& material) {
      return make({"metrics=[]",
                   R"(bodies=[{"name": "block", )" + refine +
                       R"("mesh": {"box": {"upper": [2, 1, 1], "divisions": [2, 1, 1]}}, "materials": [)" +
                       material + "]}]"});
    };
    const auto pulled = [](Simulation& s) {
      for (int i = 0; i < 4; ++i) REQUIRE(s.advance() == StepEnd::done);
      return tip(s, 0);
    };
    // Half the stiffness is that of a scene that has it from the start.
    auto set_here = block(R"({"law": "mooney_rivlin", "c1": 150, "c2": 50, "poisson": 0.5})");
    auto from_start = block(R"({"law": "mooney_rivlin", "c1": 75, "c2": 25, "poisson": 0.5})");
    CHECK(set_here->picture(false).dials[dial(*set_here, "Stiffness, times")] == 1);
    REQUIRE(set(*set_here, "Stiffness, times", 0.5).ok());
    CHECK(pulled(*set_here) == Approx(pulled(*from_start)).epsilon(1e-6));
    // A list cell by cell is of the mesh as the scene has it.
    const char* factors = "[1, 2, 1, 2, 1, 2, 1, 2, 1, 2, 1, 2]";
    auto listed = block(std::string(R"({"young": 1000, "poisson": 0.4, "stiffness_field": {"values": )") +
                        factors + "}}");
    auto softer = block(std::string(R"({"young": 600, "poisson": 0.4, "stiffness_field": {"values": )") +
                        factors + "}}");
    REQUIRE(set(*listed, "Young", 600).ok());
    CHECK(pulled(*listed) == Approx(pulled(*softer)).epsilon(1e-6));
  }
}

TEST_CASE("volume rows that are not there: a Poisson's ratio of one half is refused by the world") {
  auto s = make({"volumes=[]", "bodies[0].materials[0].poisson=0.4"});
  s->advance();
  const std::uint64_t hash = s->picture(false).hash;
  const auto refused = set(*s, "Poisson", 0.5);
  REQUIRE_FALSE(refused.ok());
  CHECK(refused.error().find("Material of block") != std::string::npos);
  CHECK(s->picture(false).dials[dial(*s, "Poisson")] == 0.4);
  CHECK(s->picture(false).hash == hash);
  // What was refused is not brought along by the next change.
  REQUIRE(set(*s, "Young", 900).ok());
  REQUIRE(set(*s, "Poisson", 0.45).ok());
  REQUIRE(s->advance() == StepEnd::done);
}

TEST_CASE("a spring pulls where it is led, tells its force, and lets go") {
  for (const Overrides& overrides : {Overrides{"tractions=[]", "metrics=[]"},
                                     Overrides{"tractions=[]", "metrics=[]", "analysis.type=dynamic",
                                               "analysis.steps=20", "analysis.duration=1"}}) {
    auto s = make(overrides);
    s->advance();
    REQUIRE(s->apply(on_triangle(Action::pull, far_triangle(*s))).ok());
    REQUIRE(s->advance() == StepEnd::done);
    Picture p = s->picture(false);
    REQUIRE(p.handles.size() == 1);
    // Holding alone moves nothing.
    CHECK(p.handles[0].force < 1e-6);
    CHECK(std::abs(tip(*s, 1)) < 1e-6);
    Command move = plain(Action::move);
    move.handle = p.handles[0].id;
    move.to = p.handles[0].at + Vec3{0, 0.5, 0};
    REQUIRE(s->apply(move).ok());
    for (int i = 0; i < 40; ++i) REQUIRE(s->advance() == StepEnd::done);
    p = s->picture(false);
    CHECK(tip(*s, 1) > 0.01);
    CHECK(p.handles[0].force > 0.1);
    CHECK(p.handles[0].to == move.to);
    Command release = plain(Action::release);
    release.handle = move.handle;
    REQUIRE(s->apply(release).ok());
    for (int i = 0; i < 80; ++i) REQUIRE(s->advance() == StepEnd::done);
    CHECK(s->picture(false).handles.empty());
    // What moves goes on swinging.
    if (!s->dynamic()) CHECK(std::abs(tip(*s, 1)) < 1e-6);
  }
}

TEST_CASE("a pin holds where it is put, a sphere pushes") {
  auto s = make({"metrics=[]"});
  REQUIRE(s->apply(on_triangle(Action::pin, far_triangle(*s))).ok());
  for (int i = 0; i < 3; ++i) REQUIRE(s->advance() == StepEnd::done);
  auto free = make({"metrics=[]"});
  for (int i = 0; i < 3; ++i) free->advance();
  CHECK(tip(*s, 0) < 0.3 * tip(*free, 0));
  CHECK(s->picture(false).handles[0].force > 1);
  REQUIRE(s->apply(plain(Action::reset)).ok());
  REQUIRE(s->apply(on_triangle(Action::push, far_triangle(*s))).ok());
  const HandleState sphere = s->picture(false).handles.at(0);
  CHECK(sphere.at.x > 2);
  Command move = plain(Action::move);
  move.handle = sphere.id;
  move.to = sphere.at - Vec3{0.3, 0, 0};
  REQUIRE(s->apply(move).ok());
  for (int i = 0; i < 8; ++i) REQUIRE(s->advance() == StepEnd::done);
  CHECK(s->picture(false).handles.at(0).force > 0.01);
}

TEST_CASE("so many handles and no more") {
  auto s = make({"metrics=[]"});
  for (std::size_t i = 0; i < Hand::most; ++i)
    REQUIRE(s->apply(on_triangle(Action::pull, static_cast<Index>(i % 8))).ok());
  CHECK(s->apply(on_triangle(Action::pull, 0)).error().find("release one of them first") !=
        std::string::npos);
}

TEST_CASE("a step that fails says why, leaves the world where it was, and can be got over") {
  SimulationOptions options;
  bool stop = false;
  options.step_limit = 1e-9;
  options.interrupted = [&] { return stop; };
  auto s = make({}, options);
  const std::uint64_t hash = s->picture(false).hash;
  CHECK(s->advance() == StepEnd::failed);
  CHECK(s->picture(false).failed);
  CHECK(s->picture(false).message.find("took longer than 1e-09 s") != std::string::npos);
  CHECK(s->picture(false).hash == hash);
  stop = true;
  auto quick = make({}, {0, "", 60, [&] { return stop; }});
  CHECK(quick->advance() == StepEnd::interrupted);
  CHECK_FALSE(quick->picture(false).failed);
  stop = false;
  CHECK(quick->advance() == StepEnd::done);
}

TEST_CASE("no equilibrium: the sentence, the last state, and on after a change") {
  // A chamber past its limit point; few tries, so that it fails soon.
  const SceneDef scene = [] {
    const auto s = override_scene(find_scene("finger")->make({}),
                                  {"bodies[0].mesh.file=meshes/finger_small.msh", "probes=[]", "metrics=[]",
                                   "cavities.chamber.amount=15000", "analysis.smallest_fraction=0.5",
                                   "analysis.max_iterations=15", "analysis.transient_rescue=false"});
    if (!s) FAIL(s.error());
    return s.value();
  }();
  auto made = Simulation::make(scene, {});
  REQUIRE(made.ok());
  Simulation& s = *made.value();
  REQUIRE(s.advance() == StepEnd::done);
  const double volume = s.picture(false).measures[1];
  REQUIRE(set(s, "chamber", 50000).ok());
  StepEnd end = StepEnd::done;
  for (int i = 0; i < 20 && end == StepEnd::done; ++i) end = s.advance();
  REQUIRE(end == StepEnd::failed);
  const Picture p = s.picture(true);
  CHECK(p.failed);
  CHECK(p.message.size() > 20);
  // The state is an equilibrium that the picture shows, not what was tried.
  CHECK(p.measures[1] >= volume);
  CHECK(p.measures[1] < 5 * volume);
  REQUIRE(set(s, "chamber", 3000).ok());
  REQUIRE(s.advance() == StepEnd::done);
  CHECK_FALSE(s.picture(false).failed);
  CHECK(s.picture(false).message.empty());
  REQUIRE(s.apply(plain(Action::reset)).ok());
  REQUIRE(s.advance() == StepEnd::done);
  CHECK(s.picture(false).measures[1] == volume);
}

TEST_CASE("a recording has the outputs of a run, and the second one a folder of its own") {
  const test::Scratch scratch("live_recording");
  SimulationOptions options;
  options.folder = (scratch / "first").string();
  auto s = make({}, options);
  REQUIRE(s->apply(plain(Action::record)).ok());
  CHECK_FALSE(s->apply(plain(Action::record)).ok());
  REQUIRE(s->apply(on_triangle(Action::push, far_triangle(*s))).ok());
  for (int i = 0; i < 3; ++i) REQUIRE(s->advance() == StepEnd::done);
  CHECK(s->picture(false).recorded == 3);
  REQUIRE(s->apply(plain(Action::reset)).ok());
  CHECK(s->picture(false).recorded == -1);
  for (const char* file : {"index.html", "summary.json", "steps.csv", "small.pvd"}) {
    INFO(file);
    CHECK((std::filesystem::exists(scratch / "first" / file) ||
           (std::string(file) == "index.html" && !results_page_available())));
  }
  const auto summary = nlohmann::json::parse(test::slurp(scratch / "first" / "summary.json"));
  CHECK(summary["status"] == "converged");
  // As many columns in every row, whatever was held meanwhile.
  std::istringstream table(test::slurp(scratch / "first" / "steps.csv"));
  std::size_t rows = 0, columns = 0;
  for (std::string line; std::getline(table, line); ++rows) {
    const auto n = static_cast<std::size_t>(std::count(line.begin(), line.end(), ','));
    if (rows == 0) columns = n;
    CHECK(n == columns);
  }
  CHECK(rows == 5);
  REQUIRE(s->apply(plain(Action::record)).ok());
  s->advance();
  REQUIRE(s->close().ok());
  CHECK(std::filesystem::exists(scratch / "first_2" / "summary.json"));
}

TEST_CASE("a folder that cannot be written is said, and the world goes on") {
  SimulationOptions options;
  options.folder = "/proc/isochor_live";
  auto s = make({}, options);
  CHECK(s->apply(plain(Action::record)).error().find("/proc/isochor_live") != std::string::npos);
  CHECK(s->advance() == StepEnd::done);
  auto without = make();
  CHECK(without->apply(plain(Action::record)).error().find("--out") != std::string::npos);
}
