// Small meshes that tests share.
#pragma once

#include <array>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "isochor/generate.h"
#include "isochor/mesh.h"

namespace test {

using isochor::CellType;
using isochor::Index;
using isochor::Mesh;
using isochor::Vec3;

// A box that must exist.
Mesh box(std::array<int, 3> divisions, Vec3 upper = {1, 1, 1}, CellType type = CellType::tet4);

// Every node moved by a map; Tet10 edges become curved.
Mesh mapped(Mesh mesh, const std::function<Vec3(const Vec3&)>& map);
// A smooth map that leaves nothing axis-aligned; amplitude 0.05 for a unit box.
Vec3 wavy(const Vec3& p);

// The cells whose centroid is in the box are taken out; the faces they leave bare become surface `name`.
Mesh without_cells(const Mesh& mesh, const Vec3& lower, const Vec3& upper, const std::string& name);
// A 3 x 3 x 3 box without its middle cell, or without the middle cell and the one above it. Surface
// "chamber".
Mesh hollow_box(bool open, CellType type);

// The same body with its nodes numbered otherwise, its cells in another order and each cell's nodes in
// another (equally oriented) order. `place[old node]` is the new number.
Mesh shuffled(const Mesh& mesh, unsigned seed, std::vector<Index>& place);

// Two regions, "low" and "high", divided at x.
Mesh divided(Mesh mesh, double x);

// Total volume of straight-sided cells, corners only.
double corner_volume(const Mesh& mesh, std::span<const Vec3> x);

}  // namespace test
