// Directions from a Laplace problem where it has a closed solution, fibers in all directions against
// integrals, and what is refused.
#include "isochor/fiber_fields.h"

#include <cmath>
#include <numbers>
#include <random>

#include "engine/base/base.h"
#include "isochor/generate.h"
#include "support/meshes.h"
#include "support/sheets.h"

using namespace isochor;

namespace {

// A box bent to a quarter of a tube about z: x is the radius, y the angle.
Mesh tube(CellType type, int fine) {
  Mesh mesh = test::mapped(test::box({2 * fine, 6 * fine, fine}, {1, 1, 1}, type), [](const Vec3& p) {
    const double r = 1 + p.x, a = 0.5 * std::numbers::pi * p.y;
    return Vec3{r * std::cos(a), r * std::sin(a), p.z};
  });
  return mesh;
}

std::vector<Vec3> middles(const Mesh& mesh) {
  const auto per = static_cast<std::size_t>(nodes_per_cell(mesh.cell_type));
  const std::size_t corners = mesh.cell_type == CellType::tet10 ? 4 : per;
  std::vector<Vec3> out;
  for (std::size_t c = 0; c < mesh.cells.size(); c += per) {
    Vec3 sum{};
    for (std::size_t k = 0; k < corners; ++k) sum += mesh.nodes[static_cast<std::size_t>(mesh.cells[c + k])];
    out.push_back((1.0 / static_cast<double>(corners)) * sum);
  }
  return out;
}

std::string refusal(const Mesh& mesh, const LaplaceFibers& fibers) {
  const auto made = laplace_directions(mesh, fibers);
  REQUIRE(!made);
  return made.error();
}

// A family's stress-free energy at C, by the formula of single fibers.
double energy(const std::vector<FiberFamily>& families, const Mat3& C) {
  double sum = 0;
  for (const FiberFamily& f : families) {
    const Vec3 a = direction(f.direction);
    const double E = dot(a, C * a) - 1;
    if (E > 0) sum += f.k1 / f.exponent * std::pow(E, f.exponent);
  }
  return sum;
}

Mat3 diagonal(double x, double y, double z) {
  Mat3 C;
  C(0, 0) = x, C(1, 1) = y, C(2, 2) = z;
  return C;
}

// The same over the sphere, by a fine lattice of its own: cosines to z at middles, weights exp(2 b c^2).
double integral(double k1, double exponent, double b, const Mat3& C) {
  constexpr int n = 2000, m = 400;
  double sum = 0, all = 0;
  for (int i = 0; i < n; ++i) {
    const double c = (i + 0.5) / n, s = std::sqrt(1 - c * c), w = std::exp(2 * b * c * c);
    all += w * m;
    for (int k = 0; k < m; ++k) {
      const double turn = 2 * std::numbers::pi * (k + 0.5) / m;
      const Vec3 a{s * std::cos(turn), s * std::sin(turn), c};
      const double E = dot(a, C * a) - 1;
      if (E > 0) sum += w * k1 / exponent * std::pow(E, exponent);
    }
  }
  return sum / all;
}

}  // namespace

TEST_CASE("in a block of any cells fibers run straight from one side to the other", "[unit]") {
  for (const CellType type : {CellType::tet4, CellType::tet10, CellType::hex8}) {
    // Inner nodes anywhere: a linear phi is in the space all the same.
    const Mesh mesh = test::mapped(test::box({3, 2, 2}, {2, 1, 1}, type), [](const Vec3& p) {
      const double inner = p.x * (2 - p.x) * p.y * (1 - p.y) * p.z * (1 - p.z);
      return p + inner * Vec3{0.3, -0.4, 0.5};
    });
    for (const auto& [from, to, along] :
         {std::tuple("x0", "x1", Vec3{1, 0, 0}), {"z1", "z0", Vec3{0, 0, -1}}}) {
      const auto a = laplace_directions(mesh, {{from}, {to}});
      REQUIRE(a);
      REQUIRE(a.value().size() == static_cast<std::size_t>(mesh.cell_count()));
      for (const Vec3& d : a.value()) CHECK(norm(d - along) < 1e-10);
    }
  }
}

TEST_CASE("in a tube fibers go outward, round it, or wind about it by an angle that changes through the wall",
          "[unit]") {
  for (const CellType type : {CellType::tet4, CellType::hex8}) {
    double before = 1;
    for (const int fine : {2, 4}) {
      const Mesh mesh = tube(type, fine);
      const std::vector<Vec3> x = middles(mesh);
      LaplaceFibers helix{{"x0"}, {"x1"}, {0, 0, 2}, -0.8, 0.6};
      const auto out = laplace_directions(mesh, {{"x0"}, {"x1"}});
      const auto wound = laplace_directions(mesh, helix);
      REQUIRE(out);
      REQUIRE(wound);
      double worst = 0;
      for (std::size_t c = 0; c < x.size(); ++c) {
        const Vec3 er = direction({x[c].x, x[c].y, 0}), et{-er.y, er.x, 0};
        // phi of a tube from radius 1 to 2 is log r/log 2.
        const double r = std::sqrt(x[c].x * x[c].x + x[c].y * x[c].y), angle = -0.8 + 1.4 * std::log2(r);
        worst = std::max(worst, norm(out.value()[c] - er));
        worst =
            std::max(worst, norm(wound.value()[c] - (std::cos(angle) * et + Vec3{0, 0, std::sin(angle)})));
        CHECK(std::abs(norm(wound.value()[c]) - 1) < 1e-12);
      }
      INFO(static_cast<int>(type) << ", fine " << fine << ", worst " << worst);
      CHECK(worst < 0.7 * before);
      before = worst;
    }
    CHECK(before < 0.12);
  }
}

TEST_CASE("in a sheet fibers run within it", "[unit]") {
  Mesh sheet = test::unit_sheet(6, 4, 0.2);
  for (Vec3& p : sheet.nodes) p.z = 0.3 * p.x;
  const auto a = laplace_directions(sheet, {{"x0"}, {"x1"}});
  REQUIRE(a);
  for (const Vec3& d : a.value()) CHECK(norm(d - direction({1, 0, 0.3})) < 1e-10);
}

TEST_CASE("Laplace problems that give no directions are refused by name", "[unit]") {
  const Mesh mesh = test::box({2, 2, 2}, {1, 1, 1});
  CHECK(refusal(mesh, {{}, {"x1"}}).find("from names no surface") == 0);
  CHECK(refusal(mesh, {{"x0"}, {"lid"}}).find("to: ") == 0);
  CHECK(refusal(mesh, {{"x0"}, {"lid"}}).find("\"lid\"") != std::string::npos);
  CHECK(refusal(mesh, {{"x0"}, {"y0"}}).find("is both in from and in to") != std::string::npos);
  CHECK(refusal(mesh, {{"x0"}, {"x1"}, {1, 0, 0}}).find("the axis runs along the gradient") == 0);
  CHECK(refusal(mesh, {{"x0"}, {"x1"}, {}, 1, 0}).find("and there is none; give the axis") !=
        std::string::npos);
  Mesh two = mesh;
  const Index first = two.node_count();
  for (const Vec3& p : mesh.nodes) two.nodes.push_back(p + Vec3{5, 0, 0});
  for (const Index n : mesh.cells) two.cells.push_back(first + n);
  CHECK(refusal(two, {{"x0"}, {"x1"}}).find("touches neither from nor to") != std::string::npos);
}

TEST_CASE("fibers in all directions pull as their integral over the sphere says", "[unit]") {
  FiberFamily family;
  family.direction = {0, 0, 3};
  family.k1 = 2;
  for (const double b : {0.0, 1.5, -2.0}) {
    for (const double exponent : {2.0, 3.0}) {
      family.exponent = exponent;
      for (const Mat3& C :
           {diagonal(1.3, 1.2, 1.1), diagonal(1.0 / 1.2, 1.0 / 1.2, 1.44), diagonal(1.5, 0.8, 0.9)}) {
        const double exact = integral(2, exponent, b, C);
        double before = 1;
        for (const int n : {4, 8, 16}) {
          const auto families = spread_fibers(family, {b, n, 2 * n});
          REQUIRE(families);
          before = std::abs(energy(families.value(), C) / exact - 1);
        }
        INFO("b " << b << ", exponent " << exponent << ", off " << before);
        CHECK(before < 2e-3);
      }
      // Stretched alike in all directions all fibers are alike, whatever the quadrature.
      const auto few = spread_fibers(family, {b, 2, 3});
      REQUIRE(few);
      CHECK(energy(few.value(), diagonal(1.2, 1.2, 1.2)) == Approx(2 / exponent * std::pow(0.2, exponent)));
    }
  }
}

TEST_CASE("fibers in all directions alike do not see how a material is turned", "[unit]") {
  FiberFamily family;
  family.k1 = 1;
  double least = 1e9, most = 0;
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 30; ++i) {
    family.direction = {normal(random), normal(random), normal(random)};
    const auto families = spread_fibers(family, {0, 8, 16});
    REQUIRE(families);
    const double e = energy(families.value(), diagonal(1.5, 1 / std::sqrt(1.5), 1 / std::sqrt(1.5)));
    least = std::min(least, e);
    most = std::max(most, e);
  }
  CHECK(most / least < 1.02);
}

TEST_CASE("spreads that mean nothing are refused", "[unit]") {
  FiberFamily family;
  family.k1 = 1;
  const auto says = [&](const FiberSpread& spread, const std::string& what) {
    const auto made = spread_fibers(family, spread);
    REQUIRE(!made);
    INFO(made.error());
    CHECK(made.error().find(what) != std::string::npos);
  };
  says({std::nan(""), 4, 8}, "spread.concentration = nan");
  says({101, 4, 8}, "spread.concentration = 101");
  says({0, 0, 8}, "spread.rings = 0");
  says({0, 4, 129}, "spread.around = 129");
  family.dispersion = 0.1;
  says({0, 4, 8}, "dispersion = 0.1 beside a spread");
  family.dispersion = 0;
  family.k1 = -1;
  says({0, 4, 8}, "k1 = -1");
}
