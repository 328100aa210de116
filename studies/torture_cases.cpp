#include <algorithm>
#include <array>

#include "isochor/mesh_io.h"
#include "scenes/library.h"
#include "studies/torture_bench.h"
#include "studies/torture_motion.h"

namespace isochor::studies {

namespace {

constexpr double kPi = 3.14159265358979323846;

Result<Mesh> box(const TortureSettings& s, Vec3 size, std::array<int, 3> divisions) {
  BoxMeshDef def;
  def.upper = size;
  def.divisions = divisions;
  if (s.element == Element::hex8) def.cell_type = CellType::hex8;
  return box_mesh(def);
}

// One end held, the other moved: amount 1 when the load is complete.
DirichletDef moved(const TortureBench& bench, const std::string& surface) {
  DirichletDef def;
  def.name = "move";
  def.where.body = bench.body();
  def.where.surfaces = {surface};
  def.amount = Curve::ramp(1, bench.load_time());
  return def;
}

TortureResult cantilever(const TortureSettings& s) {
  WorldOptions options;
  options.gravity = {0, 0, -9.8 * s.load};
  TortureBench bench(s, options);
  bench.add_body(box(s, {1, 0.1, 0.1}, {20, 2, 2}), neo_hookean(torture_constants(s, 266e3)), 1070);
  bench.hold({"x0"});
  return bench.run(true);
}

TortureResult bar_between_ends(const TortureSettings& s, const std::function<void(DirichletDef&)>& motion,
                               std::array<int, 3> divisions = {8, 3, 3}, Vec3 size = {0.4, 0.1, 0.1},
                               bool equilibrium = true) {
  TortureBench bench(s);
  bench.add_body(box(s, size, divisions), neo_hookean(torture_constants(s, 66e3)));
  bench.hold({"x0"});
  DirichletDef end = moved(bench, "x1");
  motion(end);
  bench.add(dirichlet(end));
  return bench.run(equilibrium);
}

TortureResult twist(const TortureSettings& s) {
  return bar_between_ends(s, [&](DirichletDef& end) {
    end.axis_point = {0, 0.05, 0.05};
    end.axis = {1, 0, 0};
    end.angle = kPi * s.load;
  });
}

TortureResult stretch(const TortureSettings& s) {
  return bar_between_ends(s, [&](DirichletDef& end) { end.displacement = {2.4 * 0.4 * s.load, 0, 0}; });
}

// Both faces bonded, down to a fifth of the height at load 1. The path of equilibria of the Tet10 mesh turns
// back at 86 % of the way (docs/stability.md); in motion it gets past that.
TortureResult compression(const TortureSettings& s) {
  return bar_between_ends(
      s,
      [&](DirichletDef& end) {
        end.displacement = {-0.8 * 0.1 * std::min(s.load, 1.1), 0, 0};
      },
      {4, 4, 4}, {0.1, 0.1, 0.1}, s.step > 0 || s.element != Element::tet10);
}

// A flat block on a table, its middle pressed down to half its height.
TortureResult puck(const TortureSettings& s) {
  TortureBench bench(s);
  bench.add_body(box(s, {0.2, 0.2, 0.08}, {8, 8, 4}), neo_hookean(torture_constants(s, 60e3)));
  bench.hold({"z0"});
  DirichletDef press;
  press.name = "press";
  press.where.body = bench.body();
  press.where.boxes = {{Vec3{0.07, 0.07, 0.079}, Vec3{0.13, 0.13, 0.081}}};
  press.displacement = {0, 0, -0.5 * 0.08 * s.load};
  press.amount = Curve::ramp(1, bench.load_time());
  bench.add(dirichlet(press));
  return bench.run(s.load <= 1);
}

TortureResult chamber(const TortureSettings& s, const std::string& mesh, double pressure) {
  TortureBench bench(s);
  bench.add_body(read_mesh(scenes_folder() + "/meshes/" + mesh + ".msh"),
                 neo_hookean(torture_constants(s, mesh == "bubble" ? 100e3 : 90e3)), 1070);
  bench.hold({"clamped"});
  CavityDef def;
  def.body = bench.body();
  def.surfaces = {"chamber"};
  def.amount = Curve::ramp(pressure * s.load, bench.load_time());
  bench.add(cavity(def));
  // Far beyond the pressures of the paper there may be no equilibrium.
  return bench.run(s.load <= 1);
}

TortureResult bubble_case(const TortureSettings& s) {
  return chamber(s, "bubble", 4000);
}
TortureResult cushion_case(const TortureSettings& s) {
  return chamber(s, "cushion", 10000);
}

// Load 1 is 0.7 of mu: the limit point of the closed form is at 0.82.
TortureResult sphere(const TortureSettings& s) {
  TortureBench bench(s);
  bench.add_body(read_mesh(scenes_folder() + "/meshes/thick_sphere.msh"),
                 neo_hookean(torture_constants(s, 3)), 1);
  bench.hold({"symmetry_x"}, {{1, 0, 0}});
  bench.hold({"symmetry_y"}, {{0, 1, 0}});
  bench.hold({"symmetry_z"}, {{0, 0, 1}});
  CavityDef def;
  def.body = bench.body();
  def.surfaces = {"inner"};
  def.amount = Curve::ramp(0.7 * s.load, bench.load_time());
  bench.add(cavity(def));
  return bench.run(s.load <= 1);
}

// A block that falls on the floor with 2 m/s times the load.
TortureResult drop(const TortureSettings& s) {
  WorldOptions options;
  options.gravity = {0, 0, -9.81};
  TortureBench bench(s, options);
  bench.add_body(box(s, {0.1, 0.1, 0.1}, {3, 3, 3}), neo_hookean(torture_constants(s, 60e3)));
  ContactDef floor;
  floor.body = bench.body();
  floor.obstacle.position = {0, 0, -0.2 * s.load * s.load};
  bench.add(contact(floor));
  if (!bench.ok()) return bench.march(1, 1);
  TortureResult out = bench.march(s.step, std::clamp(static_cast<int>(0.4 / s.step), 5, 300));
  if (out.verdict != TortureVerdict::solved) return out;
  double lowest = 1;
  for (const Vec3& x : bench.world().positions(bench.body())) lowest = std::min(lowest, x.z);
  if (lowest < floor.obstacle.position.z - 1e-6) {
    out.verdict = TortureVerdict::broken;
    out.reason = "nodes are below the floor by " + std::to_string(floor.obstacle.position.z - lowest) + " m";
  }
  return out;
}

// A cube that stands on its glued face under gravity: its energy stays bounded and it comes to rest.
TortureResult standing(const TortureSettings& s) {
  WorldOptions options;
  options.gravity = {0, 0, -9.81 * s.load};
  TortureBench bench(s, options);
  bench.add_body(box(s, {0.1, 0.1, 0.1}, {4, 4, 4}), neo_hookean(torture_constants(s, 30e3)));
  bench.hold({"z0"});
  if (s.step <= 0 || !bench.ok()) return bench.run(true);
  TortureResult out = bench.march(s.step, 60);
  if (out.verdict != TortureVerdict::solved) return out;
  const double elastic = bench.world().elastic_energy(), kinetic = bench.world().kinetic_energy();
  const std::vector<Vec3> settled(bench.world().positions(bench.body()).begin(),
                                  bench.world().positions(bench.body()).end());
  TortureResult more = bench.march(s.step, 60);
  double creep = 0;
  for (std::size_t i = 0; i < settled.size(); ++i) {
    const Vec3 d = bench.world().positions(bench.body())[i] - settled[i];
    creep = std::max(creep, std::sqrt(dot(d, d)));
  }
  more.drift = creep / 0.1;
  more.iterations += out.iterations;
  // Shorter steps have not come to rest after 60 of them.
  const double bound = 2 * (elastic + kinetic) + 1e-9;
  if (more.verdict == TortureVerdict::solved && s.step > 0.005 &&
      (creep > 1e-3 * 0.1 || bench.world().elastic_energy() + bench.world().kinetic_energy() > bound)) {
    more.verdict = TortureVerdict::broken;
    more.reason = "the cube creeps by " + std::to_string(creep) + " m or gains energy";
  }
  return more;
}

// Starts that have nothing to do with rest; the corner nodes of one face are held. The energy lives through
// inversion; the shape that comes back must be the one at rest.
TortureResult recovery(const TortureSettings& s,
                       const std::function<Vec3(const Vec3&, TortureNoise&)>& spoil) {
  WorldOptions options;
  options.definiteness = Definiteness::projected;
  options.max_iterations = 200;
  TortureSettings still = s;
  still.seed = 0;
  TortureBench bench(still, options);
  bench.add_body(box(s, {0.1, 0.1, 0.1}, {3, 3, 3}), stable_neo_hookean(torture_constants(s, 30e3)), 1000,
                 true);
  DirichletDef pins;
  pins.name = "corners";
  pins.where.body = bench.body();
  pins.where.nearest = {{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}, {0, 0, 0.1}};
  bench.add(dirichlet(pins));
  if (!bench.ok()) return bench.run(false);
  const auto rest = bench.world().rest_positions(bench.body());
  std::vector<Vec3> start(rest.begin(), rest.end());
  TortureNoise noise(s.seed);
  for (Vec3& x : start) {
    const bool pinned = std::any_of(pins.where.nearest.begin(), pins.where.nearest.end(),
                                    [&](const Vec3& p) { return dot(x - p, x - p) < 1e-16; });
    const Vec3 other = spoil(x, noise);
    if (!pinned) x = other;
  }
  if (auto r = bench.world().set_positions(bench.body(), start); !r) {
    TortureResult out;
    out.reason = r.error();
    return out;
  }
  TortureResult out = bench.run(true);
  if (out.verdict != TortureVerdict::solved || s.step > 0) return out;
  double away = 0;
  const auto x = bench.world().positions(bench.body());
  for (std::size_t i = 0; i < x.size(); ++i)
    away = std::max(away, std::sqrt(dot(x[i] - rest[i], x[i] - rest[i])));
  out.drift = away / 0.1;
  // Another equilibrium is one, but not what was asked.
  if (away > 1e-6) {
    out.verdict = TortureVerdict::stopped;
    out.reason = "ended in another equilibrium than rest";
  }
  return out;
}

TortureResult scrambled(const TortureSettings& s) {
  return recovery(s, [](const Vec3&, TortureNoise& n) {
    const double half = 0.05 * std::cbrt(2.0);
    return Vec3{0.05 + half * n.next(), 0.05 + half * n.next(), 0.05 + half * n.next()};
  });
}
TortureResult crushed(const TortureSettings& s) {
  return recovery(s, [](const Vec3& x, TortureNoise& n) { return Vec3{x.x, x.y, 0.05 + 1e-4 * n.next()}; });
}
TortureResult mirrored(const TortureSettings& s) {
  return recovery(s, [](const Vec3& x, TortureNoise& n) {
    return Vec3{0.1 - x.x, x.y + 1e-4 * n.next(), x.z};
  });
}

// Half of the bar is a million times stiffer.
TortureResult stiffness_jump(const TortureSettings& s) {
  WorldOptions options;
  options.gravity = {0, 0, -9.8 * s.load};
  TortureBench bench(s, options);
  auto mesh = box(s, {0.4, 0.1, 0.1}, {8, 2, 2});
  auto material = neo_hookean(torture_constants(s, 30e3));
  if (mesh && material) {
    const auto corners = static_cast<std::size_t>(nodes_per_cell(mesh.value().cell_type));
    std::vector<double> factor;
    for (std::size_t c = 0; c + corners <= mesh.value().cells.size(); c += corners) {
      double x = 0;
      for (std::size_t a = 0; a < corners; ++a)
        x += mesh.value().nodes[static_cast<std::size_t>(mesh.value().cells[c + a])].x;
      factor.push_back(x / static_cast<double>(corners) < 0.2 ? 1 : 1e6);
    }
    material = with_stiffness_field(material.value(), factor);
  }
  bench.add_body(std::move(mesh), material);
  bench.hold({"x0"});
  return bench.run(true);
}

// A beam whose layers are pressed to slivers, dihedral angles down to a degree; or with cells a thousand
// times longer at one end than at the other.
TortureResult bad_mesh(const TortureSettings& s, const std::function<void(Vec3&)>& spoil) {
  WorldOptions options;
  options.gravity = {0, 0, -5 * s.load};
  TortureSettings exact = s;
  exact.seed = 0;  // slivers would turn over
  TortureBench bench(exact, options);
  auto mesh = box(s, {0.4, 0.1, 0.1}, {8, 2, 4});
  if (mesh) {
    for (Vec3& x : mesh.value().nodes) spoil(x);
    // Another load instead of another mesh.
  }
  bench.add_body(std::move(mesh), neo_hookean(torture_constants(s, 100e3)));
  bench.hold({"x0"});
  if (s.seed > 0) {
    PointForceDef push;
    push.where.body = bench.body();
    push.where.nearest = {{0.4, 0, 0.1}};
    TortureNoise noise(s.seed);
    push.force = {0.2 * noise.next(), 0.2 * noise.next(), 0.2 * noise.next()};
    push.amount = Curve::ramp(1, bench.load_time());
    bench.add(point_force(push));
  }
  return bench.run(true);
}

TortureResult slivers(const TortureSettings& s) {
  return bad_mesh(s, [](Vec3& x) {
    // Layers at 0.025, 0.05, 0.075: the middle one comes within a hundredth of a cell of the lower.
    if (std::abs(x.z - 0.05) < 1e-9) x.z = 0.0255;
  });
}
TortureResult graded(const TortureSettings& s) {
  return bad_mesh(s,
                  [](Vec3& x) { x.x = 0.4 * (std::exp2(1.25 * (x.x / 0.05)) - 1) / (std::exp2(10.0) - 1); });
}

// A free body that spins at 20 rad/s: momentum stays, and energy does what the scheme promises.
TortureResult spin(const TortureSettings& s) {
  TortureSettings settings = s;
  TortureBench bench(settings);
  bench.add_body(box(s, {0.2, 0.1, 0.05}, {4, 2, 1}), neo_hookean(torture_constants(s, 100e3)));
  TortureResult out;
  if (!bench.ok()) return bench.march(s.step, 1);
  // A short couple sets it turning; then it is left alone.
  PointForceDef push;
  push.name = "push";
  push.where.body = bench.body();
  push.where.surfaces = {"x1"};
  push.force = {0, 2 * s.load, 0};
  push.amount = {{{0, 1}, {10 * s.step, 1}, {10.001 * s.step, 0}}};
  bench.add(point_force(push));
  push.name = "pull";
  push.where.surfaces = {"x0"};
  push.force = {0, -2 * s.load, 0};
  bench.add(point_force(push));
  if (!bench.ok()) return bench.march(s.step, 1);
  out = bench.march(s.step, 11);
  if (out.verdict != TortureVerdict::solved) return out;
  World& world = bench.world();
  // Momentum over the sum of its magnitudes, with the lumped mass of linear tets.
  const auto measure = [&] {
    const Mesh& mesh = world.mesh(bench.body());
    if (mesh.cell_type != CellType::tet4) return 0.0;
    std::vector<double> mass(mesh.nodes.size(), 0);
    for (std::size_t c = 0; c + 4 <= mesh.cells.size(); c += 4) {
      const auto node = [&](std::size_t a) { return static_cast<std::size_t>(mesh.cells[c + a]); };
      const Vec3 e0 = mesh.nodes[node(1)] - mesh.nodes[node(0)],
                 e1 = mesh.nodes[node(2)] - mesh.nodes[node(0)],
                 e2 = mesh.nodes[node(3)] - mesh.nodes[node(0)];
      for (std::size_t a = 0; a < 4; ++a) mass[node(a)] += std::abs(dot(cross(e0, e1), e2)) / 24;
    }
    Vec3 linear{};
    double size = 0;
    const auto v = world.velocities(bench.body());
    for (std::size_t i = 0; i < v.size(); ++i) {
      linear += mass[i] * v[i];
      size += mass[i] * std::sqrt(dot(v[i], v[i]));
    }
    return size > 0 ? std::sqrt(dot(linear, linear)) / size : 0;
  };
  const double energy = world.kinetic_energy() + world.elastic_energy();
  const int steps = 1000;
  TortureResult more = bench.march(s.step, steps);
  more.iterations += out.iterations;
  const double after = world.kinetic_energy() + world.elastic_energy();
  more.drift = after / energy - 1;
  if (more.verdict == TortureVerdict::solved && (measure() > 1e-6 || more.drift > 0.05)) {
    more.verdict = TortureVerdict::broken;
    more.reason = "momentum appeared, " + std::to_string(measure()) + ", or energy grew by " +
                  std::to_string(more.drift);
  }
  return more;
}

// Nothing acts on the body: not a bit of it moves.
TortureResult at_rest(const TortureSettings& s) {
  TortureBench bench(s);
  bench.add_body(box(s, {0.1, 0.1, 0.1}, {3, 3, 3}), neo_hookean(torture_constants(s, 30e3)));
  bench.hold({"z0"});
  TortureResult out = bench.run(true);
  if (!bench.ok() || out.verdict != TortureVerdict::solved) return out;
  const auto x = bench.world().positions(bench.body()), X = bench.world().rest_positions(bench.body());
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Vec3 d = x[i] - X[i];
    if (d.x == 0 && d.y == 0 && d.z == 0) continue;
    out.verdict = TortureVerdict::broken;
    out.reason = "a body at rest moved";
  }
  return out;
}

// Amounts that are not finite are refused, and the state stays as it was.
TortureResult poisoned(const TortureSettings& s) {
  WorldOptions options;
  options.gravity = {0, 0, -5 * s.load};
  TortureBench bench(s, options);
  bench.add_body(box(s, {0.2, 0.1, 0.1}, {4, 2, 2}), neo_hookean(torture_constants(s, 50e3)));
  bench.hold({"x0"});
  TractionDef def;
  def.body = bench.body();
  def.surface = "x1";
  def.traction = {0, 0, 10};
  const auto load = bench.add(traction(def));
  TortureResult out = bench.run(true);
  if (!bench.ok() || out.verdict != TortureVerdict::solved) return out;
  World& world = bench.world();
  const std::uint64_t before = world.state_hash();
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    if (!world.set_amount(*load, bad) && world.state_hash() == before) continue;
    out.verdict = TortureVerdict::broken;
    out.reason = "an amount that is not finite was taken";
  }
  // The largest double is finite: forces overflow, the step is rejected.
  if (!world.set_amount(*load, 1e308)) return out;
  const std::uint64_t set = world.state_hash();  // amounts that a host sets are part of it
  const StepReport report = world.step(s.step > 0 ? s.step : 1);
  if (report.status == StepStatus::converged || world.state_hash() != set) {
    out.verdict = TortureVerdict::broken;
    out.reason = "a load that overflows was carried";
  }
  return out;
}

constexpr TortureCase kCases[] = {
    {"cantilever", "Cantilever under its weight", 10, true, true, cantilever},
    {"twist", "Bar turned by 180 degrees (load 2: 360)", 2, true, true, twist},
    {"stretch", "Bar stretched to 3.4 times its length", 1, true, true, stretch},
    {"compression", "Bonded block pressed to a fifth of its height", 1, true, true, compression},
    {"puck", "Block indented to half its height", 1, true, true, puck},
    {"bubble", "Bubble, multiples of 4 kPa", 10, false, true, bubble_case, 5},
    {"cushion", "Cushion, multiples of 10 kPa", 10, false, true, cushion_case, 5},
    {"sphere", "Thick sphere, load 2 beyond its limit point", 2, false, true, sphere},
    {"drop", "Block dropped on a floor", 3, true, false, drop},
    {"ball", "Ball that hits a floor, coarse", 3, true, false, ball_coarse},
    {"ball_fine", "Ball that hits a floor, fine", 1, true, false, ball_fine, 0, true},
    {"standing", "Standing cube", 4, true, true, standing},
    {"scrambled", "Cube with random vertices", 1, false, true, scrambled},
    {"crushed", "Cube crushed flat", 1, false, true, crushed},
    {"mirrored", "Cube turned inside out", 1, false, true, mirrored},
    {"stiffness_jump", "Stiffness ratio of a million", 10, true, true, stiffness_jump},
    {"slivers", "Dihedral angles of a degree", 10, true, true, slivers},
    {"graded", "Cells of size ratio a thousand", 4, true, true, graded},
    {"spin", "Free body spinning for 1,000 steps", 1, true, false, spin},
    {"swing", "Free bar swinging undamped for 1,000 steps", 1, true, false, swing, 0, false, 1e-3},
    {"at_rest", "Nothing acts", 1, true, true, at_rest},
    {"poisoned", "Loads that are not finite", 1, true, true, poisoned},
};

}  // namespace

std::span<const TortureCase> torture_cases() {
  return kCases;
}

const TortureCase* find_torture_case(std::string_view name) {
  for (const TortureCase& c : kCases) {
    if (c.name == name) return &c;
  }
  return nullptr;
}

}  // namespace isochor::studies
