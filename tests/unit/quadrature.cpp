// Quadrature of every element: which polynomials it integrates exactly, and what follows for volumes, curved
// cells and smoothed patches.
#include <cmath>

#include "engine/elements/reference_element.h"
#include "engine/mesh/cell_shape.h"
#include "support/worlds.h"

using namespace isochor;
using namespace test;

namespace {

// Coordinates of a point on the reference cell, from the linear functions of its corners.
Vec3 reference_point(const ReferenceElement& e, int q) {
  const double* N = e.corner_shape.data() + static_cast<std::size_t>(q * e.corners);
  Vec3 xi{};
  for (int a = 0; a < e.corners; ++a) {
    if (e.corners == 8) {
      const auto& s = kHexSign[static_cast<std::size_t>(a)];
      xi += N[a] * Vec3{1.0 * s[0], 1.0 * s[1], 1.0 * s[2]};
    } else if (a > 0) {
      xi[a - 1] = N[a];
    }
  }
  return xi;
}

double integral(const ReferenceElement& e, int a, int b, int c) {
  double sum = 0;
  for (int q = 0; q < e.points; ++q) {
    const Vec3 p = reference_point(e, q);
    sum += e.weight[static_cast<std::size_t>(q)] * std::pow(p.x, a) * std::pow(p.y, b) * std::pow(p.z, c);
  }
  return sum;
}

double factorial(int n) {
  return n < 2 ? 1 : n * factorial(n - 1);
}
double on_tet(int a, int b, int c) {
  return factorial(a) * factorial(b) * factorial(c) / factorial(a + b + c + 3);
}
double on_line(int a) {
  return a % 2 == 1 ? 0 : 2.0 / (a + 1);
}

// Whether all monomials of a total degree are integrated to rounding.
bool exact_on_tet(const ReferenceElement& e, int degree) {
  for (int a = 0; a <= degree; ++a) {
    for (int b = 0; a + b <= degree; ++b) {
      const int c = degree - a - b;
      if (std::abs(integral(e, a, b, c) - on_tet(a, b, c)) > 1e-14) return false;
    }
  }
  return true;
}

double total(const SolidData& data) {
  double sum = 0;
  for (const double w : data.weight) sum += w;
  return sum;
}

}  // namespace

TEST_CASE("quadrature of the reference elements is exact to its degree and no further") {
  for (const auto& [element, degree] : {std::pair(&tet4_element(), 1), {&tet10_element(), 5}}) {
    for (int d = 0; d <= degree; ++d) CHECK(exact_on_tet(*element, d));
    CHECK(!exact_on_tet(*element, degree + 1));
  }
  const ReferenceElement& hex = hex8_element();
  for (int a = 0; a <= 3; ++a) {
    for (int b = 0; b <= 3; ++b) {
      for (int c = 0; c <= 3; ++c) {
        CHECK(integral(hex, a, b, c) == Approx(on_line(a) * on_line(b) * on_line(c)).margin(1e-14));
      }
    }
  }
  CHECK(std::abs(integral(hex, 4, 0, 0) - on_line(4) * 4) > 0.1);
}

TEST_CASE("shape functions sum to one, their gradients to zero, and give the point back") {
  for (const ReferenceElement* e : {&tet4_element(), &tet10_element(), &hex8_element()}) {
    for (int q = 0; q < e->points; ++q) {
      double sum = 0, corners = 0;
      Vec3 slope{};
      for (int a = 0; a < e->nodes; ++a) {
        sum += e->shape[static_cast<std::size_t>(q * e->nodes + a)];
        slope += e->shape_gradient[static_cast<std::size_t>(q * e->nodes + a)];
      }
      for (int k = 0; k < e->corners; ++k)
        corners += e->corner_shape[static_cast<std::size_t>(q * e->corners + k)];
      CHECK(sum == Approx(1).epsilon(1e-14));
      CHECK(corners == Approx(1).epsilon(1e-14));
      CHECK(std::sqrt(dot(slope, slope)) < 1e-14);
    }
  }
}

// Inside a box with plane sides cells may be as curved as they like: the volumes are polynomials that the
// points integrate exactly, so they fill the box.
TEST_CASE("curved cells fill their box") {
  for (const CellType type : {CellType::tet4, CellType::tet10, CellType::hex8}) {
    const Mesh mesh = mapped(box({2, 2, 2}, {1, 1, 1}, type), [](const Vec3& p) {
      const double inner = 64 * p.x * (1 - p.x) * p.y * (1 - p.y) * p.z * (1 - p.z);
      return p + inner * Vec3{0.07 + 0.05 * p.y, -0.05, 0.04 * p.x};
    });
    const ReferenceElement& e = type == CellType::tet4    ? tet4_element()
                                : type == CellType::tet10 ? tet10_element()
                                                          : hex8_element();
    std::vector<Index> cells(at(mesh.cell_count()));
    for (std::size_t c = 0; c < cells.size(); ++c) cells[c] = static_cast<Index>(c);
    const SolidData data = value(solid_data(e, mesh.nodes, mesh.cells, cells, VolumeFunctions::corners));
    INFO("cells with " << e.nodes << " nodes");
    CHECK(total(data) == Approx(1).epsilon(1e-14));
    // A linear motion has its own gradient at every point.
    for (Index s = 0; s < data.nodes.count(); ++s) {
      for (int q = 0; q < data.points; ++q) {
        Mat3 F;
        for (std::size_t a = 0; a < data.nodes[s].size(); ++a) {
          const Vec3 X = mesh.nodes[at(data.nodes[s][a])];
          const Vec3& g = data.gradient[at(s) * static_cast<std::size_t>(data.points * e.nodes) +
                                        static_cast<std::size_t>(q * e.nodes) + a];
          for (int i = 0; i < 3; ++i) {
            for (int k = 0; k < 3; ++k) F(i, k) += X[i] * g[k];
          }
        }
        double off = 0;
        for (int i = 0; i < 3; ++i) {
          for (int k = 0; k < 3; ++k) off = std::max(off, std::abs(F(i, k) - (i == k ? 1 : 0)));
        }
        CHECK(off < 1e-13);
      }
    }
  }
}

TEST_CASE("patches around edges share out the volume and see linear motions exactly") {
  const Mesh mesh = mapped(box({2, 2, 2}), wavy);
  std::vector<Index> cells(at(mesh.cell_count()));
  for (std::size_t c = 0; c < cells.size(); ++c) cells[c] = static_cast<Index>(c);
  const SolidData tets =
      value(solid_data(tet4_element(), mesh.nodes, mesh.cells, cells, VolumeFunctions::none));
  const SolidData patches = value(edge_patch_data(mesh.nodes, mesh.cells, cells));
  CHECK(total(patches) == Approx(total(tets)).epsilon(1e-14));
  for (Index s = 0; s < patches.nodes.count(); ++s) {
    Vec3 sum{};
    Mat3 F;
    for (std::size_t a = 0; a < patches.nodes[s].size(); ++a) {
      const Vec3& g = patches.gradient[at(patches.nodes.offset[at(s)]) + a];
      const Vec3 X = mesh.nodes[at(patches.nodes[s][a])];
      sum += g;
      for (int i = 0; i < 3; ++i) {
        for (int k = 0; k < 3; ++k) F(i, k) += X[i] * g[k];
      }
    }
    CHECK(std::sqrt(dot(sum, sum)) < 1e-12);
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) CHECK(F(i, k) == Approx(i == k ? 1 : 0).margin(1e-13));
    }
  }
}
