// Thin bodies that tests share: sheets of triangles, structured and not, bent to a shape.
#pragma once

#include <algorithm>
#include <random>

#include "support/worlds.h"

namespace test {

// The unit square in the plane z = 0, n by m rectangles cut in two. With `disorder` inner nodes are moved by
// up to so much of their distance, those of the rim along it, and the cuts are drawn.
inline Mesh unit_sheet(int n, int m, double disorder = 0, unsigned seed = 7) {
  isochor::BoxMeshDef def;
  def.upper = {1, 1, 0};
  def.divisions = {n, m, 1};
  def.cell_type = CellType::tri3;
  Mesh mesh = value(isochor::box_mesh(def));
  if (disorder == 0) return mesh;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto inner = [](double s) { return s > 1e-9 && s < 1 - 1e-9; };
  for (Vec3& x : mesh.nodes) {
    const double dx = unit(random), dy = unit(random);
    if (inner(x.x)) x.x += disorder * dx / n;
    if (inner(x.y)) x.y += disorder * dy / m;
  }
  for (std::size_t c = 0; c < mesh.cells.size(); c += 6) {
    // Both triangles of a rectangle stand together; either diagonal cuts it.
    Index corner[4];
    const auto q = static_cast<Index>(c / 6), i = q % n, j = q / n;
    corner[0] = i + (n + 1) * j, corner[1] = corner[0] + 1, corner[2] = corner[1] + n + 1,
    corner[3] = corner[0] + n + 1;
    const std::size_t one[6] = {0, 1, 2, 0, 2, 3}, other[6] = {0, 1, 3, 1, 2, 3};
    const bool first = unit(random) < 0;
    for (std::size_t k = 0; k < 6; ++k) mesh.cells[c + k] = corner[first ? one[k] : other[k]];
  }
  return mesh;
}

inline isochor::BodyId add_sheet(isochor::World& world, Mesh mesh, const std::string& name = "sheet") {
  isochor::BodyDef def;
  def.name = name;
  def.mesh = std::move(mesh);
  def.element = isochor::Element::tri3;
  return value(world.add_body(def));
}

// Nodes of a mesh in a box.
inline isochor::Selection in_box(isochor::BodyId body, const Vec3& lower, const Vec3& upper) {
  isochor::Selection s;
  s.body = body;
  s.boxes = {{lower, upper}};
  return s;
}

inline isochor::EffectId hold_nodes(isochor::World& world, const std::string& name, isochor::Selection where,
                                    std::vector<Vec3> directions) {
  isochor::DirichletDef def;
  def.name = name;
  def.where = std::move(where);
  def.directions = std::move(directions);
  return value(world.add(isochor::dirichlet(def)));
}

}  // namespace test
