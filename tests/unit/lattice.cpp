// Lattices of hexahedra around surfaces.
#include "isochor/lattice.h"

#include <map>

#include "mesh_support.h"

using namespace mesh_test;
using isochor::check_mesh;
using isochor::Lattice;
using isochor::LatticeDef;

namespace {

using Block = std::array<int, 3>;

// The surface of some unit blocks on a grid, scaled.
LatticeDef surface_of(const std::vector<Block>& blocks, double size) {
  LatticeDef def;
  std::map<Block, Index> number;
  const auto has = [&](Block b) { return std::find(blocks.begin(), blocks.end(), b) != blocks.end(); };
  for (const Block& b : blocks) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (const int side : {0, 1}) {
        Block other = b;
        other[axis] += side == 1 ? 1 : -1;
        if (has(other)) continue;
        const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
        Index corner[4];
        for (int k = 0; k < 4; ++k) {
          Block p = b;
          p[axis] += side;
          // Counterclockwise around the axis; the other way around on the lower side.
          const bool at_u = k == 1 || k == 2, at_v = k >= 2;
          p[u] += side == 1 ? at_u : at_v;
          p[v] += side == 1 ? at_v : at_u;
          const auto [it, fresh] = number.try_emplace(p, static_cast<Index>(def.points.size()));
          if (fresh) def.points.push_back(size * Vec3{1.0 * p[0], 1.0 * p[1], 1.0 * p[2]});
          corner[k] = it->second;
        }
        def.triangles.insert(def.triangles.end(),
                             {corner[0], corner[1], corner[2], corner[0], corner[2], corner[3]});
      }
    }
  }
  return def;
}

// A U: a bar of five blocks with a prong of four on both ends.
std::vector<Block> fork_blocks() {
  std::vector<Block> blocks;
  for (int i = 0; i < 5; ++i) blocks.push_back({i, 0, 0});
  for (int j = 1; j < 5; ++j) {
    blocks.push_back({0, j, 0});
    blocks.push_back({4, j, 0});
  }
  return blocks;
}

Lattice make(const LatticeDef& def) {
  auto lattice = lattice_mesh(def);
  INFO((lattice ? std::string() : lattice.error()));
  REQUIRE(lattice.ok());
  return std::move(lattice).value();
}

double worst_distance(std::span<const Vec3> a, std::span<const Vec3> b) {
  double worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    worst = std::max(worst, std::sqrt(dot(a[i] - b[i], a[i] - b[i])));
  return worst;
}

// A sphere of radius 1, by latitude and longitude.
LatticeDef sphere(int n) {
  LatticeDef def;
  def.points = {{0, 0, 1}};
  for (int i = 1; i < n; ++i) {
    for (int j = 0; j < 2 * n; ++j) {
      const double a = 3.14159265358979 * i / n, b = 3.14159265358979 * j / n;
      def.points.push_back({std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a)});
    }
  }
  const auto at_ring = [&](int i, int j) { return static_cast<Index>(1 + (i - 1) * 2 * n + j % (2 * n)); };
  const auto last = static_cast<Index>(def.points.size());
  def.points.push_back({0, 0, -1});
  for (int j = 0; j < 2 * n; ++j) {
    def.triangles.insert(def.triangles.end(), {0, at_ring(1, j), at_ring(1, j + 1)});
    def.triangles.insert(def.triangles.end(), {last, at_ring(n - 1, j + 1), at_ring(n - 1, j)});
    for (int i = 1; i + 1 < n; ++i) {
      def.triangles.insert(def.triangles.end(), {at_ring(i, j), at_ring(i + 1, j), at_ring(i + 1, j + 1)});
      def.triangles.insert(def.triangles.end(), {at_ring(i, j), at_ring(i + 1, j + 1), at_ring(i, j + 1)});
    }
  }
  return def;
}

}  // namespace

TEST_CASE("lattice: a box of whole cubes is filled exactly", "[mesh]") {
  LatticeDef def = surface_of({{0, 0, 0}, {1, 0, 0}}, 0.5);
  def.spacing = 0.25;
  for (const bool turned : {false, true}) {
    if (turned) {
      for (std::size_t t = 0; t < def.triangles.size(); t += 3)
        std::swap(def.triangles[t], def.triangles[t + 1]);
    }
    const Lattice lattice = make(def);
    CHECK(lattice.mesh.cell_count() == 16);
    CHECK(lattice.mesh.node_count() == 45);
    const auto report = check_mesh(lattice.mesh);
    CHECK(report.findings.empty());
    CHECK(report.volume == Approx(0.25));
  }
}

TEST_CASE("lattice: the surface moves with the lattice", "[mesh]") {
  for (const double spacing : {0.6, 0.31}) {
    LatticeDef def = sphere(12);
    def.spacing = spacing;
    const Lattice lattice = make(def);
    const auto report = check_mesh(lattice.mesh);
    CHECK(report.usable());
    CHECK(report.parts == 1);
    // All of the sphere is covered, with no more than a layer of cut cells around.
    CHECK(report.volume > 4.18);
    CHECK(report.volume < 4.19 * std::pow(1 + 2 * spacing, 3));
    for (const auto& p : lattice.embedding) {
      double sum = 0;
      for (const double w : p.weights) {
        CHECK(w > -1e-9);
        sum += w;
      }
      CHECK(sum == Approx(1));
    }
    CHECK(worst_distance(embedded_surface(lattice, lattice.mesh.nodes), def.points) < 1e-12);
    const auto affine = [](const Vec3& X) {
      return Vec3{1 + 2 * X.x - 0.3 * X.y, 0.5 * X.y + X.z, X.z - 0.2 * X.x};
    };
    std::vector<Vec3> moved, expected;
    for (const Vec3& X : lattice.mesh.nodes) moved.push_back(affine(X));
    for (const Vec3& X : def.points) expected.push_back(affine(X));
    CHECK(worst_distance(embedded_surface(lattice, moved), expected) < 1e-12);
  }
}

TEST_CASE("lattice: what does not hang together is kept apart", "[mesh]") {
  // The gap of the fork is half as wide as a cube: both prongs pass through the same cubes.
  LatticeDef def = surface_of(fork_blocks(), 0.1);
  def.spacing = 0.6;
  def.samples = 12;
  for (const bool apart : {true, false}) {
    def.keep_apart = apart;
    const Lattice lattice = make(def);
    CHECK(check_mesh(lattice.mesh).usable());
    CHECK(check_mesh(lattice.mesh).parts == 1);
    // One cube holds the whole fork: the bar joins its prongs inside it.
    CHECK(lattice.mesh.cell_count() == 1);
  }
  // With smaller cubes the bar is in the lower ones, the prongs alone in the upper ones.
  def.spacing = 0.25;
  def.samples = 10;
  const auto cells_with = [&](bool apart) {
    def.keep_apart = apart;
    return make(def);
  };
  const Lattice joined = cells_with(false), apart = cells_with(true);
  CHECK(check_mesh(apart.mesh).parts == 1);
  CHECK(check_mesh(apart.mesh).usable());
  CHECK(joined.mesh.cell_count() <= apart.mesh.cell_count());
  // The tips of the prongs share no node, whatever is done to one leaves the other alone.
  LatticeDef narrow = surface_of(fork_blocks(), 0.1);
  narrow.spacing = 0.5;
  narrow.samples = 20;
  for (Vec3& p : narrow.points) p.y *= 2;  // prongs twice as long: 1 m, two cubes
  for (const bool split : {true, false}) {
    narrow.keep_apart = split;
    const Lattice fork_lattice = make(narrow);
    const auto tip_cell = [&](double x) {
      for (std::size_t i = 0; i < narrow.points.size(); ++i) {
        if (narrow.points[i].y > 0.99 && std::abs(narrow.points[i].x - x) < 0.01)
          return fork_lattice.embedding[i].cell;
      }
      return Index{-1};
    };
    CHECK((tip_cell(0) != tip_cell(0.5)) == split);
    CHECK(fork_lattice.mesh.cell_count() == (split ? 3 : 2));
    CHECK(check_mesh(fork_lattice.mesh).usable());
    CHECK(check_mesh(fork_lattice.mesh).parts == 1);
    CHECK(worst_distance(embedded_surface(fork_lattice, fork_lattice.mesh.nodes), narrow.points) < 1e-12);
  }
}

TEST_CASE("lattice: refusals say what is wrong", "[mesh]") {
  const auto refusal_of = [](const LatticeDef& def) {
    const auto r = lattice_mesh(def);
    return r ? std::string() : r.error();
  };
  LatticeDef good = surface_of({{0, 0, 0}}, 1);
  good.spacing = 0.5;
  LatticeDef bad = good;
  bad.spacing = 0;
  CHECK(mentions(refusal_of(bad), {"spacing = 0", "positive"}));
  bad = good;
  bad.spacing = 1e-4;
  CHECK(mentions(refusal_of(bad), {"spacing", "wider"}));
  bad = good;
  bad.samples = 0;
  CHECK(mentions(refusal_of(bad), {"samples = 0"}));
  bad = good;
  bad.triangles.resize(bad.triangles.size() - 3);
  CHECK(mentions(refusal_of(bad), {"not closed", "3 edges"}));
  bad = good;
  std::swap(bad.triangles[0], bad.triangles[1]);
  CHECK(mentions(refusal_of(bad), {"same way around"}));
  bad = good;
  bad.triangles[4] = 99;
  CHECK(mentions(refusal_of(bad), {"names point 99 of 8"}));
  bad = good;
  bad.points.push_back({5, 5, 5});
  CHECK(mentions(refusal_of(bad), {"point 8", "no triangle"}));
  bad = good;
  bad.points[2].y = std::nan("");
  CHECK(mentions(refusal_of(bad), {"point 2", "finite"}));
}
