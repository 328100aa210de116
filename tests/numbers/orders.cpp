// Orders of convergence by manufactured solutions: a finite deformation is chosen, the body force that it
// needs is computed, and errors in L2 are compared between two meshes.
#include <cmath>

#include "constraints/stencil/face_pool.h"
#include "engine/elements/material.h"
#include "engine/elements/material_model.h"
#include "engine/elements/reference_element.h"
#include "engine/mesh/cell_shape.h"
#include "support/worlds.h"

using namespace isochor;
using namespace test;

namespace {

using Tensor = std::array<double, 9>;

// A chosen motion and, at nu = 0.5, a chosen pressure; positions of order 1.
struct Manufactured {
  MaterialPtr material;
  bool incompressible = false;

  Vec3 position(const Vec3& X) const {
    const double a = 0.15;
    // A shear whose amount varies keeps every volume: J = 1 everywhere.
    if (incompressible) return {X.x, X.y + a * std::sin(2 * X.x), X.z + a * std::sin(2 * X.x + 1)};
    return {X.x + a * std::sin(2 * X.y), X.y + a * std::sin(2 * X.z + X.x),
            X.z + a * std::cos(2 * X.x) * X.y};
  }
  double pressure(const Vec3& X) const { return incompressible ? std::sin(2 * X.x + X.y) * X.z : 0; }

  Tensor gradient(const Vec3& X) const {
    Tensor F{};
    constexpr double h = 1e-4;
    for (int j = 0; j < 3; ++j) {
      // Fourth order: rounding and truncation stay near 1e-12.
      const auto at_step = [&](double s) {
        Vec3 Y = X;
        Y[j] += s * h;
        return position(Y);
      };
      const Vec3 d = (1 / (12 * h)) * (8.0 * (at_step(1) - at_step(-1)) - (at_step(2) - at_step(-2)));
      for (int i = 0; i < 3; ++i) F[static_cast<std::size_t>(3 * i + j)] = d[i];
    }
    return F;
  }

  static Tensor cofactor(const Tensor& F) {
    Tensor g{};
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        const std::size_t a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
        g[3 * i + j] = F[3 * a + c] * F[3 * b + d] - F[3 * a + d] * F[3 * b + c];
      }
    }
    return g;
  }

  Tensor stress(const Vec3& X) const {
    const Tensor F = gradient(X);
    const auto energy = incompressible ? material->distortional() : value(material->complete());
    PointBatch batch{};
    ResponseBatch response{};
    for (int l = 0; l < kLanes; ++l) {
      for (std::size_t i = 0; i < 9; ++i) batch.F[i][l] = F[i];
    }
    energy->evaluate(Want::gradient, batch, response);
    Tensor P = cofactor(F);
    for (std::size_t i = 0; i < 9; ++i) P[i] = pressure(X) * P[i] + response.P[i][0];
    return P;
  }

  // tr(sigma)/3 and sigma in the order xx yy zz xy yz zx.
  std::array<double, 6> cauchy(const Vec3& X) const {
    const Tensor F = gradient(X), P = stress(X), g = cofactor(F);
    const double J = F[0] * g[0] + F[1] * g[1] + F[2] * g[2];
    const auto s = [&](std::size_t i, std::size_t j) {
      return (P[3 * i] * F[3 * j] + P[3 * i + 1] * F[3 * j + 1] + P[3 * i + 2] * F[3 * j + 2]) / J;
    };
    return {s(0, 0), s(1, 1), s(2, 2), s(0, 1), s(1, 2), s(2, 0)};
  }

  // What holds the motion in place: minus the divergence of P.
  Vec3 force(const Vec3& X) const {
    Vec3 f{};
    constexpr double h = 1e-3;
    for (int j = 0; j < 3; ++j) {
      const auto at_step = [&](double s) {
        Vec3 Y = X;
        Y[j] += s * h;
        return stress(Y);
      };
      const Tensor p1 = at_step(1), m1 = at_step(-1), p2 = at_step(2), m2 = at_step(-2);
      for (int i = 0; i < 3; ++i) {
        const auto k = static_cast<std::size_t>(3 * i + j);
        f[i] -= (8 * (p1[k] - m1[k]) - (p2[k] - m2[k])) / (12 * h);
      }
    }
    return f;
  }
};

// Shape functions and volumes at points of a cell, exact enough to judge cubic terms.
struct CellPoint {
  std::vector<double> N;
  double volume = 0;
};

std::vector<CellPoint> cell_points(const Mesh& mesh, std::size_t cell) {
  const auto per = static_cast<std::size_t>(nodes_per_cell(mesh.cell_type));
  const Index* n = mesh.cells.data() + cell * per;
  std::vector<CellPoint> out;
  const auto add = [&](const std::vector<double>& N, const std::vector<Vec3>& dN, double weight) {
    Vec3 d[3] = {};
    for (std::size_t a = 0; a < per; ++a) {
      for (int k = 0; k < 3; ++k) d[k] += dN[a][k] * mesh.nodes[at(n[a])];
    }
    out.push_back({N, weight * dot(d[0], cross(d[1], d[2]))});
  };
  if (mesh.cell_type == CellType::hex8) {
    const double g = std::sqrt(0.6), at_point[3] = {-g, 0, g}, weight[3] = {5.0 / 9, 8.0 / 9, 5.0 / 9};
    for (std::size_t q = 0; q < 27; ++q) {
      const Vec3 xi{at_point[q % 3], at_point[q / 3 % 3], at_point[q / 9]};
      std::vector<double> N;
      std::vector<Vec3> dN;
      for (std::size_t a = 0; a < 8; ++a) {
        N.push_back(hex_function(a, xi));
        dN.push_back(hex_gradient(a, xi));
      }
      add(N, dN, weight[q % 3] * weight[q / 3 % 3] * weight[q / 9]);
    }
    return out;
  }
  const ReferenceElement& points = tet10_element();
  const Vec3 b[4] = {{-1, -1, -1}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (std::size_t q = 0; q < points.weight.size(); ++q) {
    if (per == 10) {
      const auto first = static_cast<std::ptrdiff_t>(10 * q);
      add({points.shape.begin() + first, points.shape.begin() + first + 10},
          {points.shape_gradient.begin() + first, points.shape_gradient.begin() + first + 10},
          points.weight[q]);
    } else {
      const auto first = static_cast<std::ptrdiff_t>(4 * q);
      add({points.corner_shape.begin() + first, points.corner_shape.begin() + first + 4}, {b, b + 4},
          points.weight[q]);
    }
  }
  return out;
}

struct Errors {
  double displacement = 0, pressure = 0, cell_stress = 0, node_stress = 0;
};

// Dead load P N on faces whose outward normal is near +x.
void add_traction(const Manufactured& m, const Mesh& mesh, const std::vector<Index>& faces,
                  std::vector<Vec3>& force) {
  const auto per = static_cast<std::size_t>(nodes_per_face(mesh.cell_type));
  const FaceRule& rule = face_rule(per);
  for (std::size_t f = 0; f < faces.size(); f += per) {
    for (std::size_t q = 0; q < static_cast<std::size_t>(rule.points); ++q) {
      Vec3 X{}, u{}, v{};
      for (std::size_t a = 0; a < per; ++a) {
        const Vec3& node = mesh.nodes[at(faces[f + a])];
        X += rule.N[q * per + a] * node;
        u += rule.N_u[q * per + a] * node;
        v += rule.N_v[q * per + a] * node;
      }
      Vec3 n = rule.weight[q] * cross(u, v);
      if (n.x < 0) n = -n;
      const Tensor P = m.stress(X);
      const Vec3 t{P[0] * n.x + P[1] * n.y + P[2] * n.z, P[3] * n.x + P[4] * n.y + P[5] * n.z,
                   P[6] * n.x + P[7] * n.y + P[8] * n.z};
      for (std::size_t a = 0; a < per; ++a) force[at(faces[f + a])] += rule.N[q * per + a] * t;
    }
  }
}

Errors errors_on(const Manufactured& m, Element element, const Mesh& given) {
  WorldOptions options = static_options();
  options.force_tolerance = 1e-11;
  World world = make_world(options);
  const BodyId body = add_body(world, given, element, m.material);
  if (m.incompressible) add_volume(world, body);
  const Mesh& mesh = world.mesh(body);
  std::vector<bool> outside(mesh.nodes.size(), false);
  std::vector<Vec3> force(mesh.nodes.size());
  for (const auto& s : mesh.surfaces) {
    if (s.name == "outer") continue;  // all of the sides, a name that bodies add
    // With all of the boundary given, an incompressible body would leave its mean pressure open.
    if (m.incompressible && s.name == "x1") {
      add_traction(m, mesh, s.faces, force);
    } else {
      for (const Index n : s.faces) outside[at(n)] = true;
    }
  }
  const auto per = static_cast<std::size_t>(nodes_per_cell(mesh.cell_type));
  const auto at_point = [&](std::size_t cell, const CellPoint& p, std::span<const Vec3> x) {
    Vec3 sum{};
    for (std::size_t a = 0; a < per; ++a) sum += p.N[a] * x[at(mesh.cells[cell * per + a])];
    return sum;
  };
  for (std::size_t c = 0; c < at(mesh.cell_count()); ++c) {
    for (const CellPoint& p : cell_points(mesh, c)) {
      const Vec3 f = m.force(at_point(c, p, mesh.nodes));
      for (std::size_t a = 0; a < per; ++a) force[at(mesh.cells[c * per + a])] += p.volume * p.N[a] * f;
    }
  }
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    Selection where;
    where.body = body;
    where.nodes = {static_cast<Index>(i)};
    if (outside[i]) {
      DirichletDef def;
      def.name = "node " + std::to_string(i);
      def.where = where;
      def.displacement = m.position(mesh.nodes[i]) - mesh.nodes[i];
      def.amount = Curve::ramp(1);
      value(world.add(dirichlet(def)));
    } else {
      PointForceDef def;
      def.name = "force " + std::to_string(i);
      def.where = where;
      def.force = force[i];
      def.amount = Curve::ramp(1);
      value(world.add(point_force(def)));
    }
  }
  must_advance(world);
  Errors e;
  const BodyFields fields = world.fields(body);
  const auto at_nodes = [&](std::size_t cell, const CellPoint& p, const auto& read) {
    double sum = 0;
    for (std::size_t a = 0; a < per; ++a) sum += p.N[a] * read(at(mesh.cells[cell * per + a]));
    return sum;
  };
  const auto exact_pressure = [&](const Vec3& X) {
    const auto s = m.cauchy(X);
    return (s[0] + s[1] + s[2]) / 3;
  };
  for (std::size_t c = 0; c < at(mesh.cell_count()); ++c) {
    for (const CellPoint& p : cell_points(mesh, c)) {
      const Vec3 X = at_point(c, p, mesh.nodes);
      const Vec3 d = at_point(c, p, world.positions(body)) - m.position(X);
      e.displacement += p.volume * dot(d, d);
      const double q = at_nodes(c, p, [&](std::size_t i) { return fields.node_pressure[i]; });
      e.pressure += p.volume * std::pow(q - exact_pressure(X), 2);
      const auto s = m.cauchy(X);
      for (std::size_t k = 0; k < 6; ++k) {
        const double node = at_nodes(c, p, [&](std::size_t i) { return fields.node_stress[6 * i + k]; });
        e.node_stress += p.volume * std::pow(node - s[k], 2);
        e.cell_stress += p.volume * std::pow(fields.cell_stress[6 * c + k] - s[k], 2);
      }
    }
  }
  for (double* v : {&e.displacement, &e.pressure, &e.cell_stress, &e.node_stress}) *v = std::sqrt(*v);
  return e;
}

Mesh mesh_of(Element element, int n, bool distorted) {
  const CellType type = element == Element::hex8    ? CellType::hex8
                        : element == Element::tet10 ? CellType::tet10
                                                    : CellType::tet4;
  const Mesh mesh = box({n, n, n}, {1, 1, 1}, type);
  return distorted ? mapped(mesh, wavy) : mesh;
}

double order(double coarse, double fine, double ratio) {
  return std::log(coarse / fine) / std::log(ratio);
}

}  // namespace

TEST_CASE("orders of convergence of displacements and stresses") {
  struct Expected {
    Element element;
    int coarse, fine;
    double displacement, node_stress;
  };
  for (const bool incompressible : {false, true}) {
    const Manufactured m{neo_hookean(2.6, incompressible ? 0.5 : 0.3), incompressible};
    for (const Expected& x : {Expected{Element::tet4, 4, 8, 2, 1.4},
                              {Element::tet4_edge_smoothed, 4, 8, 2, 1.4},
                              {Element::tet10, 2, 4, 3, 1.7},
                              {Element::hex8, 4, 8, 2, 1.4}}) {
      const Errors a = errors_on(m, x.element, mesh_of(x.element, x.coarse, true));
      const Errors b = errors_on(m, x.element, mesh_of(x.element, x.fine, true));
      const double ratio = double(x.fine) / x.coarse;
      INFO(name_of(x.element) << (incompressible ? ", nu = 0.5" : ", nu = 0.3") << ", errors "
                              << a.displacement << " -> " << b.displacement << " displacement, " << a.pressure
                              << " -> " << b.pressure << " mean stress, " << a.cell_stress << " -> "
                              << b.cell_stress << " stress in cells, " << a.node_stress << " -> "
                              << b.node_stress << " at nodes; orders "
                              << order(a.displacement, b.displacement, ratio) << ", "
                              << order(a.pressure, b.pressure, ratio) << ", "
                              << order(a.cell_stress, b.cell_stress, ratio) << ", "
                              << order(a.node_stress, b.node_stress, ratio));
      // With rows the coarse mesh is not yet where the order shows in full.
      CHECK(order(a.displacement, b.displacement, ratio) > x.displacement - (incompressible ? 0.3 : 0.1));
      CHECK(order(a.node_stress, b.node_stress, ratio) > x.node_stress);
      CHECK(order(a.cell_stress, b.cell_stress, ratio) > 0.8);
      // What nodes get is better than what cells have, but for the rough stresses of linear tets beside rows.
      const bool rough = incompressible && x.element == Element::tet4;
      if (!rough) CHECK(b.node_stress < b.cell_stress);
    }
  }
}
