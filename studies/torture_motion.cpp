#include "studies/torture_motion.h"

#include <algorithm>

#include "isochor/mesh_io.h"
#include "scenes/library.h"
#include "studies/torture_bench.h"

namespace isochor::studies {

namespace {

double energy(const World& world) {
  return world.kinetic_energy() + world.elastic_energy();
}

TortureResult refuse(TortureResult out, std::string reason) {
  out.verdict = TortureVerdict::broken;
  out.reason = std::move(reason);
  return out;
}

TortureResult ball(const TortureSettings& s, const std::string& mesh, int most_steps) {
  TortureBench bench(s);
  bench.add_body(read_mesh(scenes_folder() + "/meshes/" + mesh + ".msh"),
                 neo_hookean(torture_constants(s, 1e5)), 1000);
  ContactDef floor;
  floor.body = bench.body();
  floor.obstacle.position = {0, 0, -0.052};
  bench.add(contact(floor));
  if (!bench.ok()) return bench.march(1, 1);
  World& world = bench.world();
  const std::vector<Vec3> down(world.rest_positions(bench.body()).size(), Vec3{0, 0, -2 * s.load});
  if (const auto r = world.set_velocities(bench.body(), down); !r) return bench.march(1, 1);
  const double before = energy(world);
  // Down and up again takes some 30 ms.
  TortureResult out = bench.march(s.step, std::clamp(static_cast<int>(0.08 / s.step), 5, most_steps));
  if (out.verdict != TortureVerdict::solved) return out;
  out.drift = energy(world) / before - 1;
  double lowest = 1;
  for (const Vec3& x : world.positions(bench.body())) lowest = std::min(lowest, x.z);
  const double below = floor.obstacle.position.z - lowest;
  if (below > 1e-6) return refuse(out, "nodes are below the floor by " + std::to_string(below) + " m");
  // Nothing but the floor acts.
  if (out.drift > 1e-6) return refuse(out, "energy grew by " + std::to_string(out.drift));
  return out;
}

// How far velocities differ from the mean of their neighbors along cells: near zero for what the mesh
// resolves, near one for a motion that changes from node to node.
double roughness(const World& world, BodyId body) {
  const Mesh& mesh = world.mesh(body);
  const auto v = world.velocities(body);
  const auto corners = static_cast<std::size_t>(nodes_per_cell(mesh.cell_type));
  std::vector<Vec3> sum(v.size(), Vec3{});
  std::vector<double> count(v.size(), 0);
  for (std::size_t c = 0; c + corners <= mesh.cells.size(); c += corners) {
    for (std::size_t a = 0; a < corners; ++a) {
      for (std::size_t b = 0; b < corners; ++b) {
        if (a == b) continue;
        sum[static_cast<std::size_t>(mesh.cells[c + a])] += v[static_cast<std::size_t>(mesh.cells[c + b])];
        ++count[static_cast<std::size_t>(mesh.cells[c + a])];
      }
    }
  }
  double differs = 0, size = 0;
  for (std::size_t i = 0; i < v.size(); ++i) {
    if (count[i] == 0) continue;
    const Vec3 d = v[i] - (1 / count[i]) * sum[i];
    differs += dot(d, d);
    size += dot(v[i], v[i]);
  }
  return size > 0 ? std::sqrt(differs / size) : 0;
}

}  // namespace

TortureResult ball_coarse(const TortureSettings& s) {
  return ball(s, "ball_small", 100);
}
TortureResult ball_fine(const TortureSettings& s) {
  return ball(s, "ball", 30);
}

TortureResult swing(const TortureSettings& s) {
  constexpr double length = 0.4;
  TortureSettings undamped = s;
  // Keeps all motion, meets hard rows at the end of each step.
  if (!undamped.scheme) undamped.scheme = generalized_alpha(1);
  TortureBench bench(undamped);
  BoxMeshDef box;
  box.upper = {length, 0.05, 0.05};
  box.divisions = {8, 2, 2};
  if (s.element == Element::hex8) box.cell_type = CellType::hex8;
  bench.add_body(box_mesh(box), neo_hookean(torture_constants(s, 500e3)));
  if (!bench.ok()) return bench.march(1, 1);
  World& world = bench.world();
  std::vector<Vec3> start;
  for (const Vec3& x : world.rest_positions(bench.body())) {
    const double along = 2 * x.x / length - 1;
    start.push_back({0, 0, 0.5 * s.load * (along * along - 1.0 / 3)});
  }
  if (const auto r = world.set_velocities(bench.body(), start); !r) return bench.march(1, 1);
  const double before = energy(world);
  TortureResult out = bench.march(s.step, 1000);
  if (out.verdict != TortureVerdict::solved) return out;
  out.drift = energy(world) / before - 1;
  const double rough = roughness(world, bench.body());
  out.reason = "roughness " + std::to_string(rough);
  if (std::abs(out.drift) > 0.05) return refuse(out, "energy changed by " + std::to_string(out.drift));
  if (rough > 0.6) return refuse(out, "the motion changes from node to node, " + out.reason);
  return out;
}

}  // namespace isochor::studies
