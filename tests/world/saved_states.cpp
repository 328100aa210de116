// Saved states: what is damaged or of another scene is refused and changes nothing; what is not goes on with
// the same bits. The scenes hold everything that keeps something between steps.
#include <cmath>
#include <functional>
#include <random>

#include "engine/base/base.h"
#include "isochor/contact.h"
#include "support/worlds.h"

using namespace isochor;
using namespace test;

namespace {

using Blob = std::vector<std::byte>;

// What the scenes are made of, so that variants differ in one place.
struct Parts {
  WorldOptions options = dynamic_options();
  Vec3 gravity{0, 0, -9.81};
  Curve gravity_curve = Curve::constant(1);
  double young = 2e4, poisson = 0.45, density = 1000, cell_factor = 1, fiber = 100;
  double width = 0.04;
  Element element = Element::tet4_edge_smoothed;
  CavityDef gas;
  ValveDef leak;
  DampingDef damping;
  CableDef cable;
  ContactDef floor;
  SurfaceContactDef touch;
  TractionDef pull;
  double held = 0.001;
  bool extra_effect = false;

  Parts() {
    gas.name = "gas";
    gas.surfaces = {"chamber"};
    gas.control = CavityControl::gas;
    gas.amount = {{{0, 1}, {0.05, 1.2}}};
    leak.name = "leak";
    leak.from = "gas";
    leak.conductance = 1e-9;
    damping.name = "damping";
    damping.viscosity = 5;
    cable.name = "cable";
    cable.points = {{0.001, 0.015, 0.003}, {0.015, 0.015, 0.003}, {0.029, 0.015, 0.003}};
    cable.control = CableControl::tension;
    cable.amount = Curve::ramp(0.1, 0.04);
    floor.name = "floor";
    floor.friction = 0.3;
    floor.obstacle.position = {0, 0, -0.0001};
    touch.name = "touch";
    touch.friction = 0.2;
    touch.surfaces = {"z0"};
    touch.against_surfaces = {"z1"};
    pull.name = "pull";
    pull.surface = "x1";
    pull.traction = {20, 0, 0};
  }
};

struct Scene {
  const char* name;
  double h;
  void (*change)(Parts&);
  void (*build)(World&, const Parts&);
};

MaterialPtr soft(const Parts& p, std::size_t cells) {
  auto material = neo_hookean(p.young, p.poisson);
  std::vector<double> factor(cells, 1.0);
  factor.back() = p.cell_factor;
  FiberFamily family;
  family.k1 = p.fiber;
  material = value(with_fibers(material, {family}));
  return value(with_stiffness_field(material, factor));
}

BodyId add_soft(World& world, const Parts& p, const Mesh& mesh, const std::string& name) {
  return add_body(world, mesh, p.element, soft(p, static_cast<std::size_t>(mesh.cell_count())), p.density,
                  name);
}

// A chamber of gas that leaks, with a cable and damping.
void build_chamber(World& world, const Parts& p) {
  const Mesh mesh =
      mapped(hollow_box(false, CellType::tet4), [&](const Vec3& x) { return (p.width / 4) * x; });
  const BodyId body = add_soft(world, p, mesh, "box");
  hold(world, body, {"z0"}, {}, {p.held, 0, 0});
  value(world.add(damping(p.damping)));
  value(world.add(cavity(p.gas)));
  value(world.add(valve(p.leak)));
  value(world.add(cable(p.cable)));
  if (p.extra_effect) value(world.add(traction(p.pull)));
}

// Two blocks that fall on a floor and on each other.
void build_pile(World& world, const Parts& p) {
  const double w = p.width;
  const BodyId low = add_soft(world, p, block({0, 0, 0}, {w, 0.02, 0.02}, {3, 2, 2}), "low");
  const BodyId high = add_soft(world, p, block({0.003, 0, 0.0202}, {w, 0.02, 0.04}, {4, 2, 2}), "high");
  add_volume(world, low);
  auto floor = p.floor;
  floor.body = low;
  value(world.add(contact(floor)));
  auto touch = p.touch;
  touch.body = high;
  touch.against = low;
  value(world.add(surface_contact(touch)));
  auto pull = p.pull;
  pull.body = high;
  value(world.add(traction(pull)));
  if (p.extra_effect) value(world.add(damping(p.damping)));
}

// A held bar that is pulled.
void build_bar(World& world, const Parts& p) {
  const BodyId body = add_soft(world, p, box({3, 2, 2}, {p.width, 0.02, 0.02}), "bar");
  add_volume(world, body);
  hold(world, body, {"x0"}, {}, {0, 0, p.held});
  value(world.add(traction(p.pull)));
  if (p.extra_effect) value(world.add(damping(p.damping)));
}

const Scene kScenes[] = {
    {"chamber, generalized alpha", 0.004, [](Parts& p) { p.options.scheme = generalized_alpha(0.7); },
     build_chamber},
    {"pile, implicit Euler", 0.004, [](Parts&) {}, build_pile},
    {"bar, bdf2 with control of errors", 0.004,
     [](Parts& p) {
       p.options.scheme = bdf2();
       p.options.time_error = 1e-3;
     },
     build_bar},
    {"bar, statics", 0.2,
     [](Parts& p) {
       p.options = static_options();
       p.poisson = 0.5;
       p.pull.amount = Curve::ramp(1);
     },
     build_bar},
};

using Change = std::function<void(Parts&)>;

World make(
    const Scene& scene, const Change& change = [](Parts&) {}) {
  Parts p;
  scene.change(p);
  change(p);
  p.options.gravity = p.gravity;
  p.options.gravity_curve = p.gravity_curve;
  World world = make_world(p.options);
  scene.build(world, p);
  return world;
}

void advance(World& world, const Scene& scene, int steps) {
  for (int i = 0; i < steps; ++i) {
    INFO(scene.name << ", step " << i);
    must_advance(world, scene.h);
  }
}

std::size_t below(std::mt19937_64& random, std::size_t n) {
  return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
}

Blob corrupted(const Blob& blob, std::mt19937_64& random) {
  Blob bad = blob;
  switch (below(random, 7)) {
    case 0:  // bits
      for (std::size_t k = 1 + below(random, 4); k > 0; --k)
        bad[below(random, bad.size())] ^= std::byte{1} << below(random, 8);
      break;
    case 1:
      bad.resize(below(random, bad.size()));
      break;
    case 2:
      bad.insert(bad.end(), 1 + below(random, 64), static_cast<std::byte>(below(random, 256)));
      break;
    case 3: {  // two sections change places
      const std::size_t n = 8 * (1 + below(random, 16)), a = below(random, bad.size() - n),
                        b = below(random, bad.size() - n);
      std::swap_ranges(bad.begin() + static_cast<std::ptrdiff_t>(a),
                       bad.begin() + static_cast<std::ptrdiff_t>(a + n),
                       bad.begin() + static_cast<std::ptrdiff_t>(b));
      break;
    }
    case 4: {  // a number that is none, or huge
      const double numbers[] = {NAN, INFINITY, -1, 1e300, 4e9, 0};
      std::memcpy(bad.data() + below(random, bad.size() - 8), &numbers[below(random, 6)], 8);
      break;
    }
    case 5: {  // a piece is lost
      const std::size_t a = below(random, bad.size() - 20);
      bad.erase(bad.begin() + static_cast<std::ptrdiff_t>(a),
                bad.begin() + static_cast<std::ptrdiff_t>(a + 1 + below(random, 16)));
      break;
    }
    default:  // a piece stands twice
      bad.insert(bad.begin() + static_cast<std::ptrdiff_t>(below(random, bad.size())), blob.begin(),
                 blob.begin() + static_cast<std::ptrdiff_t>(1 + below(random, 64)));
  }
  return bad;
}

// A checksum that fits what has become of the bytes, as damage by intent would have it.
Blob resealed(Blob blob) {
  if (blob.size() < 32) return blob;
  const std::uint64_t size = blob.size();
  std::memcpy(blob.data() + 16, &size, 8);
  Hash h;
  h.add(std::span<const std::byte>(blob).first(blob.size() - 8));
  const std::uint64_t sum = h.value();
  std::memcpy(blob.data() + blob.size() - 8, &sum, 8);
  return blob;
}

}  // namespace

TEST_CASE("a state goes on with the same bits in a new world, whenever it was saved") {
  for (const Scene& scene : kScenes) {
    INFO(scene.name);
    World a = make(scene);
    std::vector<Blob> saved;
    std::vector<std::uint64_t> hash;
    for (int i = 0; i < 5; ++i) {
      saved.push_back(a.save());
      hash.push_back(a.state_hash());
      must_advance(a, scene.h);
    }
    for (const std::size_t at : {std::size_t{0}, std::size_t{1}, std::size_t{3}}) {
      World b = make(scene);
      REQUIRE(b.load(saved[at]).ok());
      CHECK(b.save() == saved[at]);
      for (std::size_t i = at; i < hash.size(); ++i) {
        CHECK(b.state_hash() == hash[i]);
        must_advance(b, scene.h);
      }
      CHECK(b.save() == a.save());
    }
  }
}

TEST_CASE("a damaged state is refused and the world goes on with its bits") {
  for (const Scene& scene : kScenes) {
    INFO(scene.name);
    World world = make(scene), twin = make(scene);
    advance(world, scene, 2);
    advance(twin, scene, 2);
    const Blob saved = world.save();
    std::mt19937_64 random(20);
    for (int i = 0; i < 400; ++i) {
      const Blob bad = corrupted(saved, random);
      if (bad == saved) continue;
      INFO("damage number " << i);
      const auto r = world.load(bad);
      REQUIRE_FALSE(r.ok());
      CHECK_THAT(r.error(), Catch::Matchers::StartsWith("load: "));
    }
    CHECK(world.save() == saved);
    advance(world, scene, 2);
    advance(twin, scene, 2);
    CHECK(world.save() == twin.save());
  }
}

TEST_CASE("damage under a checksum that fits crashes nothing") {
  for (const Scene& scene : kScenes) {
    INFO(scene.name);
    World world = make(scene);
    advance(world, scene, 2);
    const Blob saved = world.save();
    std::mt19937_64 random(21);
    int accepted = 0;
    for (int i = 0; i < 150; ++i) {
      INFO("damage number " << i);
      const Blob bad = resealed(corrupted(saved, random));
      const auto r = world.load(bad);
      if (!r) {
        CHECK(world.save() == saved);
        continue;
      }
      if (++accepted % 8 == 0) {
        StepBudget budget;
        budget.iterations = 2;
        (void)world.step(scene.h, budget);
        for (const Vec3& x : world.positions(BodyId{0})) REQUIRE(std::isfinite(x.x + x.y + x.z));
      }
      const auto back = world.load(saved);
      INFO((back.ok() ? "" : back.error()));
      REQUIRE(back.ok());
    }
    CHECK(world.save() == saved);
  }
}

TEST_CASE("a state of another scene is refused, and the message says which part differs") {
  struct Variant {
    std::size_t scene;
    const char* named;
    Change change;
  };
  const Variant variants[] = {
      {0, "material", [](Parts& p) { p.young *= 1 + 1e-15; }},
      {0, "material", [](Parts& p) { p.poisson = 0.44; }},
      {0, "material", [](Parts& p) { p.density = 1001; }},
      {1, "material of body \"low\"", [](Parts& p) { p.cell_factor = 1.01; }},
      {2, "material", [](Parts& p) { p.fiber = 101; }},
      {0, "mesh of body \"box\"", [](Parts& p) { p.width = 0.0401; }},
      {2, "element of body \"bar\"", [](Parts& p) { p.element = Element::tet4; }},
      {0, "effect \"gas\"", [](Parts& p) { p.gas.amount.points[1][1] = 1.21; }},
      {0, "effect \"gas\"", [](Parts& p) { p.gas.polytropic = 1.4; }},
      {0, "effect \"leak\"", [](Parts& p) { p.leak.conductance = 2e-9; }},
      {0, "effect \"damping\"", [](Parts& p) { p.damping.mass_rate = 1; }},
      {0, "effect \"cable\"", [](Parts& p) { p.cable.points[1].x += 1e-9; }},
      {0, "effect \"cable\"", [](Parts& p) { p.cable.amount.points[1][0] = 0.05; }},
      {0, "effect \"hold z0\"", [](Parts& p) { p.held = 0.0011; }},
      {1, "effect \"floor\"", [](Parts& p) { p.floor.friction = 0.31; }},
      {1, "effect \"floor\"",
       [](Parts& p) {
         p.floor.obstacle.axis = {0, 0.01, 1};
       }},
      {1, "effect \"touch\"", [](Parts& p) { p.touch.friction = 0.21; }},
      {1, "effect \"pull\"", [](Parts& p) { p.pull.traction.x = 21; }},
      {3, "effect \"pull\"", [](Parts& p) { p.pull.amount = Curve::ramp(1, 2); }},
      {2, "gravity", [](Parts& p) { p.gravity.z = -9.8; }},
      {2, "gravity", [](Parts& p) { p.gravity_curve = Curve::ramp(1); }},
      {0, "time scheme", [](Parts& p) { p.options.scheme = generalized_alpha(0.8); }},
      {2, "time error", [](Parts& p) { p.options.time_error = 2e-3; }},
      {1, "mass matrix", [](Parts& p) { p.options.consistent_mass = true; }},
      {2, "effect \"damping\" (the state has none)", [](Parts& p) { p.extra_effect = true; }},
  };
  for (const Variant& v : variants) {
    const Scene& scene = kScenes[v.scene];
    INFO(scene.name << ": " << v.named);
    World one = make(scene), other = make(scene, v.change);
    const Blob saved = one.save(), kept = other.save();
    const auto r = other.load(saved);
    REQUIRE_FALSE(r.ok());
    CHECK_THAT(r.error(), Catch::Matchers::Contains("another scene") && Catch::Matchers::Contains(v.named));
    CHECK(other.save() == kept);
  }
  for (const Scene& a : kScenes) {
    for (const Scene& b : kScenes) {
      if (&a == &b) continue;
      World world = make(b);
      CHECK_FALSE(world.load(make(a).save()).ok());
    }
  }
}

TEST_CASE("how equations are solved is no part of a state") {
  const Scene& scene = kScenes[3];
  World one = make(scene);
  advance(one, scene, 2);
  World other = make(scene, [](Parts& p) {
    p.options.method = Method::condensation;
    p.options.force_tolerance = 1e-8;
    p.options.max_iterations = 50;
  });
  const auto r = other.load(one.save());
  INFO((r.ok() ? "" : r.error()));
  CHECK(r.ok());
  CHECK(other.state_hash() == one.state_hash());
}

TEST_CASE("amounts that a host has set are part of a state and of its hash") {
  World a = make(kScenes[3]);
  advance(a, kScenes[3], 1);
  const Blob before = a.save();
  const std::uint64_t hash = a.state_hash();
  EffectId pull{2};
  REQUIRE(a.set_amount(pull, 0.5).ok());
  const std::uint64_t with_half = a.state_hash();
  CHECK(with_half != hash);
  const Blob waiting = a.save();
  REQUIRE(a.set_amount(pull, 0.7).ok());
  CHECK(a.state_hash() != with_half);
  must_advance(a, 0.2);
  World b = make(kScenes[3]);
  REQUIRE(b.load(waiting).ok());
  CHECK(b.state_hash() == with_half);
  CHECK(b.save() == waiting);
  REQUIRE(b.load(before).ok());
  CHECK(b.state_hash() == hash);
}
