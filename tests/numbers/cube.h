// A unit cube whose nodes follow an affine map exactly when an element passes the patch test: its inner node
// is off the lattice.
#pragma once

#include <cmath>

#include "support/worlds.h"

namespace test {

inline Mesh uneven_cube(CellType cells = CellType::tet4) {
  return mapped(box({2, 2, 2}, {1, 1, 1}, cells), [](const Vec3& p) {
    const double inner = 64 * p.x * (1 - p.x) * p.y * (1 - p.y) * p.z * (1 - p.z);
    return p + inner * Vec3{0.07, -0.05, 0.04};
  });
}

// Sliding faces at x = 0, y = 0, z = 0.
inline void slide_on_axes(isochor::World& world, isochor::BodyId body) {
  hold(world, body, {"x0"}, {{1, 0, 0}});
  hold(world, body, {"y0"}, {{0, 1, 0}});
  hold(world, body, {"z0"}, {{0, 0, 1}});
}

// Moves every node of the surfaces in the given directions by a linear map of its rest position.
template <class Map>
void move_linearly(isochor::World& world, isochor::BodyId body, const std::vector<std::string>& surfaces,
                   const std::vector<Vec3>& directions, const Map& displacement) {
  const Mesh& mesh = world.mesh(body);
  std::vector<bool> chosen(mesh.nodes.size(), false);
  for (const auto& s : mesh.surfaces) {
    if (std::find(surfaces.begin(), surfaces.end(), s.name) == surfaces.end()) continue;
    for (const Index n : s.faces) chosen[static_cast<std::size_t>(n)] = true;
  }
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    if (!chosen[i]) continue;
    isochor::DirichletDef def;
    def.name = "node " + std::to_string(i);
    def.where.body = body;
    def.where.nodes = {static_cast<Index>(i)};
    def.directions = directions;
    def.displacement = displacement(mesh.nodes[i]);
    def.amount = isochor::Curve::ramp(1);
    value(world.add(isochor::dirichlet(def)));
  }
}

// Largest distance of a node from where an affine map puts it.
template <class Map>
double distance_from(const isochor::World& world, isochor::BodyId body, const Map& map) {
  double worst = 0;
  for (std::size_t i = 0; i < world.positions(body).size(); ++i) {
    const Vec3 d = world.positions(body)[i] - map(world.rest_positions(body)[i]);
    worst = std::max(worst, std::sqrt(dot(d, d)));
  }
  return worst;
}

// Largest deviation of a Cauchy stress component over all cells; components in the order xx yy zz xy yz zx.
inline double stress_error(const isochor::BodyFields& fields, std::size_t component, double expected) {
  double worst = 0;
  for (std::size_t i = component; i < fields.cell_stress.size(); i += 6) {
    worst = std::max(worst, std::abs(fields.cell_stress[i] - expected));
  }
  return worst;
}

}  // namespace test
