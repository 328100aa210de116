// Stencils against automatic differentiation: each kind written once more as a plain formula in hyper-dual
// numbers, whose derivatives are exact to rounding.
#include <Eigen/Dense>
#include <cmath>
#include <functional>

#include "catch.h"
#include "constraints/layer/face_strain.h"
#include "constraints/layer/hinge_pool.h"
#include "constraints/stencil/face_pool.h"
#include "constraints/stencil/segment_pool.h"
#include "contract/formulas.h"
#include "contract/scene_probe.h"

using namespace isochor;
using test::HyperDual;
using test::PoolProbe;
using test::SceneProbe;

namespace {

using Point = std::array<HyperDual, 3>;

struct Values {
  HyperDual energy;
  std::vector<HyperDual> function;
};

// Value of a stencil from the positions of its nodes.
using Formula = std::function<Values(Index stencil, const std::vector<Point>& x)>;

HyperDual inner(const Point& a, const Point& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Point minus(const Point& a, const Point& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Point fixed(const Vec3& v) {
  return {HyperDual(v.x), HyperDual(v.y), HyperDual(v.z)};
}
HyperDual triple(const Point& a, const Point& b, const Point& c) {
  return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
         a[2] * (b[0] * c[1] - b[1] * c[0]);
}

// The distortional or complete neo-Hookean energy of the registry's material, and integrals of N_k Phi(J).
Formula solid(const SolidPool& pool, bool logarithmic, std::function<HyperDual(const test::Gradient9&)> psi) {
  return [&pool, logarithmic, psi](Index s, const std::vector<Point>& x) {
    const SolidData& data = pool.data();
    const std::size_t n = x.size();
    Values out;
    out.function.resize(static_cast<std::size_t>(data.functions));
    for (int q = 0; q < data.points; ++q) {
      const Vec3* B = data.gradient.data() +
                      static_cast<std::size_t>(data.points) * at(data.nodes.offset[at(s)]) +
                      static_cast<std::size_t>(q) * n;
      test::Gradient9 F;
      for (std::size_t a = 0; a < n; ++a) {
        for (int i = 0; i < 3; ++i) {
          for (int j = 0; j < 3; ++j)
            F[static_cast<std::size_t>(3 * i + j)] += x[a][static_cast<std::size_t>(i)] * HyperDual(B[a][j]);
        }
      }
      const double w = data.weight[at(s * data.points + q)];
      const HyperDual J = test::determinant(F), phi = logarithmic ? log(J) : J - HyperDual(1);
      if (pool.has_energy()) out.energy += HyperDual(w) * psi(F);
      for (int k = 0; k < data.functions; ++k) {
        const double N =
            data.functions == 1 ? 1 : data.shape[static_cast<std::size_t>(q * data.functions + k)];
        out.function[static_cast<std::size_t>(k)] += HyperDual(w * N) * phi;
      }
    }
    return out;
  };
}

// Metrics of a triangle: tr C and det C from its edges now and at rest.
struct Stretch {
  HyperDual trace, q;
  double area = 0;
};
Stretch stretch(const std::vector<Point>& x, std::span<const Vec3> X) {
  const Vec3 U = X[1] - X[0], V = X[2] - X[0];
  const double G11 = dot(U, U), G12 = dot(U, V), G22 = dot(V, V), det = G11 * G22 - G12 * G12;
  const Point u = minus(x[1], x[0]), v = minus(x[2], x[0]);
  const HyperDual g11 = inner(u, u), g12 = inner(u, v), g22 = inner(v, v);
  Stretch out;
  out.trace = (g11 * HyperDual(G22) - HyperDual(2 * G12) * g12 + g22 * HyperDual(G11)) * HyperDual(1 / det);
  out.q = (g11 * g22 - g12 * g12) * HyperDual(1 / det);
  out.area = 0.5 * std::sqrt(det);
  return out;
}

// Holds every derivative of the pool against the formula's, for the first stencils.
void compare(const SceneProbe& scene, const StencilPool& pool, const Formula& formula) {
  const PoolProbe probe(pool, scene);
  const test::Slots slots = probe.evaluate(Want::hessian, scene.x());
  const auto K = static_cast<std::size_t>(pool.functions());
  double worst[3] = {}, size[3] = {1e-300, 1e-300, 1e-300};
  const auto hold = [&](int what, double got, double want) {
    worst[what] = std::max(worst[what], std::abs(got - want));
    size[what] = std::max(size[what], std::abs(want));
  };
  const Index few = std::min<Index>(pool.stencils(), 10);
  REQUIRE(few > 0);
  for (Index s = 0; s < few; ++s) {
    const auto nodes = pool.nodes()[s];
    const std::size_t n = nodes.size(), first = at(pool.nodes().offset[at(s)]);
    std::vector<Point> x(n);
    for (std::size_t a = 0; a < n; ++a) x[a] = fixed(scene.x()[at(nodes[a])]);
    for (std::size_t p = 0; p < 3 * n; ++p) {
      for (std::size_t r = 0; r <= p; ++r) {
        auto seeded = x;
        seeded[p / 3][p % 3].b = 1;
        seeded[r / 3][r % 3].c = 1;
        const Values v = formula(s, seeded);
        REQUIRE(v.function.size() == K);
        HyperDual sum = v.energy;
        for (std::size_t k = 0; k < K; ++k)
          sum += HyperDual(probe.multiplier()[at(s) * K + k]) * v.function[k];
        if (r == p) {
          hold(1, slots.gradient[first + p / 3][static_cast<int>(p % 3)], sum.b);
          for (std::size_t k = 0; k < K; ++k)
            hold(0, slots.jacobian[first * K + k * n + p / 3][static_cast<int>(p % 3)], v.function[k].b);
        }
        const std::size_t a = p / 3, b = r / 3;
        const auto block = static_cast<std::size_t>(pool.hessian_offset()[at(s)]) + a * (a + 1) / 2 + b;
        hold(2, slots.hessian[block](static_cast<int>(p % 3), static_cast<int>(r % 3)), sum.d);
      }
    }
    const Values v = formula(s, x);
    for (std::size_t k = 0; k < K; ++k)
      CHECK(slots.value[at(s) * K + k] == Approx(v.function[k].a).epsilon(1e-10).margin(1e-14));
    CHECK(slots.energy[at(s)] == Approx(v.energy.a).epsilon(1e-10).margin(1e-14));
  }
  CHECK(worst[0] <= 1e-12 * size[0]);
  CHECK(worst[1] <= 1e-12 * size[1]);
  CHECK(worst[2] <= 1e-12 * size[2]);
}

const test::SceneCase& find_case(const std::string& name) {
  static const std::vector<test::SceneCase> all = test::scene_cases();
  for (const test::SceneCase& c : all) {
    if (c.name == name) return c;
  }
  FAIL("no case " << name);
  return all.front();
}

template <class Pool>
std::vector<const Pool*> pools_of(const SceneProbe& scene) {
  std::vector<const Pool*> out;
  for (const auto& pool : scene.system().parts().stencil_pools) {
    if (const auto* found = dynamic_cast<const Pool*>(pool.get())) out.push_back(found);
  }
  return out;
}

// mu = 1 in the registry: E = 2.6, nu = 0.3.
HyperDual distortional(const test::Gradient9& F) {
  return 0.5 * (test::trace_C(F) - HyperDual(3)) - log(test::determinant(F));
}
// The guard of a compressible body, with the shear modulus of the registry.
HyperDual guard(const test::Gradient9& F) {
  constexpr double threshold = 0.1;
  const HyperDual J = test::determinant(F);
  if (J.a >= threshold) return HyperDual();
  const HyperDual q = log(J / threshold);
  return -1.0 * q * q * q;
}
HyperDual complete(const test::Gradient9& F) {
  const HyperDual l = log(test::determinant(F));
  return distortional(F) + 0.5 * 2.6 * 0.3 / (1.3 * 0.4) * l * l;
}

}  // namespace

TEST_CASE("solids and their volume functions have the derivatives of their formulas") {
  for (const std::string element : {"tet4", "edge-smoothed", "tet10 curved", "hex8"}) {
    for (const std::string variant :
         {", one field", ", volume rows, space 0, strain 0", ", volume rows, space 0, strain 1",
          ", rings, strain 1", ", hard zone in a compliant one, strain 0"}) {
      INFO(element << variant);
      const SceneProbe scene(find_case(element + variant));
      const bool rows = variant != ", one field";
      for (const SolidPool* pool : pools_of<SolidPool>(scene)) {
        INFO(pool->name());
        // The single tets of smoothed bodies carry the element guard in place of the material's energy.
        const bool tets = element == "edge-smoothed" && !pool->name().ends_with("/patches");
        compare(scene, *pool, solid(*pool, variant.back() == '1', [rows, tets](const test::Gradient9& F) {
                  if (tets) return guard(F);
                  return rows ? distortional(F) : complete(F);
                }));
      }
    }
  }
}

// In F F_g^-1: energy times det F_g, volume functions times its root.
TEST_CASE("solids that have grown have the derivatives of their formulas") {
  // 1 + 0.7 G, as in registry_active.cpp.
  Eigen::Matrix3d grown;
  grown << 1.21, 0.105, 0.14, 0.105, 0.86, -0.07, 0.14, -0.07, 1.07;
  const double size = grown.determinant();
  const Eigen::Matrix3d inverse = grown.inverse();
  const auto elastic = [&](const test::Gradient9& F) {
    test::Gradient9 out;
    for (std::size_t i = 0; i < 9; ++i) {
      for (std::size_t k = 0; k < 3; ++k)
        out[i] += F[3 * (i / 3) + k] *
                  HyperDual(inverse(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(i % 3)));
    }
    return out;
  };
  for (const std::string element : {"tet4", "edge-smoothed", "tet10 curved", "hex8"}) {
    for (const std::string variant :
         {", growth, one field", ", growth, rows at nodes, strain 0", ", growth, rows at nodes, strain 1"}) {
      INFO(element << variant);
      const SceneProbe scene(find_case(element + variant));
      const bool one_field = variant.ends_with("one field"), logarithmic = variant.back() == '1';
      for (const SolidPool* pool : pools_of<SolidPool>(scene)) {
        INFO(pool->name());
        REQUIRE(pool->growth() != nullptr);
        const bool tets = element == "edge-smoothed" && !pool->name().ends_with("/patches");
        const SolidData& data = pool->data();
        compare(scene, *pool, [&](Index s, const std::vector<Point>& x) {
          Values out;
          out.function.resize(static_cast<std::size_t>(data.functions));
          for (int q = 0; q < data.points; ++q) {
            const Vec3* B = data.gradient.data() +
                            static_cast<std::size_t>(data.points) * at(data.nodes.offset[at(s)]) +
                            static_cast<std::size_t>(q) * x.size();
            test::Gradient9 F;
            for (std::size_t a = 0; a < x.size(); ++a) {
              for (std::size_t i = 0; i < 9; ++i)
                F[i] += x[a][i / 3] * HyperDual(B[a][static_cast<int>(i % 3)]);
            }
            const test::Gradient9 E = elastic(F);
            const double w = data.weight[at(s * data.points + q)];
            const HyperDual J = test::determinant(E), phi = logarithmic ? log(J) : J - HyperDual(1);
            if (pool->has_energy())
              out.energy += HyperDual(w * size) * (tets        ? guard(E)
                                                   : one_field ? complete(E)
                                                               : distortional(E));
            for (int k = 0; k < data.functions; ++k) {
              const double N =
                  data.functions == 1 ? 1 : data.shape[static_cast<std::size_t>(q * data.functions + k)];
              out.function[static_cast<std::size_t>(k)] += HyperDual(w * std::sqrt(size) * N) * phi;
            }
          }
          return out;
        });
      }
    }
  }
}

TEST_CASE("muscles have the derivatives of their formulas") {
  for (const std::string element : {"tet4", "edge-smoothed", "tet10 curved", "hex8"}) {
    for (int variant = 0; variant < 4; ++variant) {
      const bool current = variant >= 2, by_length = variant % 2 == 1;
      const std::string name =
          ", muscle, tension " + std::to_string(variant / 2) + (by_length ? ", by length" : "");
      INFO(element << name);
      const SceneProbe scene(find_case(element + name));
      // The solid comes first; patches have their data.
      const SolidData& data = pools_of<SolidPool>(scene).front()->data();
      int found = 0;
      for (const auto& pool : scene.system().parts().stencil_pools) {
        if (pool->name() != "muscle") continue;
        ++found;
        compare(scene, *pool, [&](Index s, const std::vector<Point>& x) {
          Values out;
          out.function.resize(1);
          for (int q = 0; q < data.points; ++q) {
            const Vec3* B = data.gradient.data() +
                            static_cast<std::size_t>(data.points) * at(data.nodes.offset[at(s)]) +
                            static_cast<std::size_t>(q) * x.size();
            Point f{};
            for (std::size_t a = 0; a < x.size(); ++a) {
              const HyperDual along((B[a].x + 2 * B[a].y + 2 * B[a].z) / 3);
              for (std::size_t i = 0; i < 3; ++i) f[i] += x[a][i] * along;
            }
            const HyperDual stretch = sqrt(inner(f, f));
            // By Simpson's rule in many pieces from 1, whose end moves with the stretch.
            const auto pull = [&](const HyperDual& v) {
              const HyperDual d = (v - HyperDual(1.2)) * HyperDual(1 / 0.6);
              const HyperDual force = by_length ? HyperDual(1) - d * d : HyperDual(1);
              return current ? force / v : force;
            };
            constexpr int pieces = 200;
            HyperDual sum = pull(HyperDual(1)) + pull(stretch);
            for (int k = 1; k < 2 * pieces; ++k) {
              const double part = 0.5 * k / pieces;
              sum += HyperDual(k % 2 == 1 ? 4 : 2) *
                     pull(HyperDual(1) + HyperDual(part) * (stretch - HyperDual(1)));
            }
            const double w = data.weight[at(s * data.points + q)];
            out.function[0] += HyperDual(w / (6 * pieces)) * (stretch - HyperDual(1)) * sum;
          }
          return out;
        });
      }
      CHECK(found == 1);
    }
  }
}

TEST_CASE("skins have the derivatives of their formulas") {
  {
    constexpr double gamma = 3;  // as in the registry
    const SceneProbe scene(find_case("tet4, epidermis of stiffness " + std::to_string(2.0)));
    const auto pools = pools_of<FaceStrainPool>(scene);
    REQUIRE(pools.size() == 1);
    compare(scene, *pools[0], [&](Index s, const std::vector<Point>& x) {
      std::vector<Vec3> X;
      for (const Index n : pools[0]->nodes()[s]) X.push_back(scene.rest()[at(n)]);
      const Stretch t = stretch(x, X);
      const HyperDual m = sqrt(t.q) - HyperDual(1);
      return Values{HyperDual(0),
                    {HyperDual(t.area) * m * sqrt(HyperDual(1) + HyperDual(gamma / 6) * m * m)}};
    });
  }
  for (const double nu : {0.0, 0.3, 0.5}) {
    const SceneProbe scene(find_case("tet4, membrane, nu = " + std::to_string(nu)));
    const auto pools = pools_of<FaceStrainPool>(scene);
    REQUIRE(pools.size() == 1);
    compare(scene, *pools[0], [&](Index s, const std::vector<Point>& x) {
      std::vector<Vec3> X;
      for (const Index n : pools[0]->nodes()[s]) X.push_back(scene.rest()[at(n)]);
      const Stretch t = stretch(x, X);
      const double mu = 100 * 0.01 / (2 * (1 + nu)), c = nu / (1 - nu);
      const HyperDual volumetric =
          c > 0 ? HyperDual(1 / c) * (pow(t.q, -c) - HyperDual(1)) : HyperDual(-1) * log(t.q);
      return Values{HyperDual(0.5 * mu * t.area) * (t.trace - HyperDual(2) + volumetric), {}};
    });
  }
}

TEST_CASE("hinges have the derivatives of their angle") {
  for (const char* name : {"thin body, nu = 0.300000", "thin body, clamped"}) {
    const SceneProbe scene(find_case(name));
    const auto pools = pools_of<HingePool>(scene);
    REQUIRE(pools.size() == 1);
    const HingePool& pool = *pools[0];
    const auto angle = [](const std::vector<Point>& x) {
      const Point e = minus(x[1], x[0]), p = minus(x[2], x[0]), q = minus(x[3], x[0]);
      const HyperDual along = inner(e, e);
      return atan(sqrt(along) * triple(q, e, p) / (inner(e, q) * inner(e, p) - along * inner(p, q)));
    };
    const auto corners = [&](Index s, std::vector<Point> x) {
      if (x.size() == 4) return x;
      const auto n = pool.nodes()[s];
      const Vec3 a = scene.rest()[at(n[0])], e = scene.rest()[at(n[1])] - a, c = scene.rest()[at(n[2])] - a;
      const Vec3 ahead = (dot(c, e) / dot(e, e)) * e - c;
      x.emplace_back();
      for (std::size_t k = 0; k < 3; ++k)
        x[3][k] = HyperDual(0.5) * (x[0][k] + x[1][k]) + HyperDual(ahead[static_cast<int>(k)]);
      return x;
    };
    int clamped = 0;
    compare(scene, pool, [&](Index s, const std::vector<Point>& x) {
      std::vector<Point> rest;
      for (const Index n : pool.nodes()[s]) rest.push_back(fixed(scene.rest()[at(n)]));
      clamped += pool.is_clamped(s) ? 1 : 0;
      const HyperDual phi =
          HyperDual(pool.rest_length(s)) * (angle(corners(s, x)) - HyperDual(angle(corners(s, rest)).a));
      // The stiffness is what the pool says at this very place.
      const PoolProbe probe(pool, scene);
      const double now = probe.evaluate(Want::value, scene.x()).energy[at(s)];
      const double square = probe.evaluate(Want::value, scene.x()).value[at(s)];
      return Values{HyperDual(now / (square * square)) * phi * phi, {phi}};
    });
    CHECK((clamped > 0) == (std::string(name) == "thin body, clamped"));
  }
}

TEST_CASE("enclosed volumes have the derivatives of their formula") {
  for (const int control : {0, 2}) {
    const SceneProbe scene(find_case("tet4, closed, chamber control " + std::to_string(control)));
    const auto pools = pools_of<EnclosedVolumePool>(scene);
    REQUIRE(pools.size() == 1);
    compare(scene, *pools[0], [&](Index, const std::vector<Point>& x) {
      const Point o = fixed(pools[0]->origin());
      return Values{HyperDual(0),
                    {HyperDual(1.0 / 6) * triple(minus(x[0], o), minus(x[1], o), minus(x[2], o))}};
    });
  }
}

TEST_CASE("viscosity has the derivatives of its potential") {
  const SceneProbe scene(find_case("tet10 curved, damping"));
  const auto solids = pools_of<SolidPool>(scene);
  REQUIRE(solids.size() == 1);
  const SolidData& data = solids[0]->data();
  int found = 0;
  for (const auto& pool : scene.system().parts().stencil_pools) {
    if (pool->name() != "damping") continue;
    ++found;
    // From rest: viscosity / h |E|^2, with h as the probe has it.
    compare(scene, *pool, [&](Index s, const std::vector<Point>& x) {
      const std::size_t n = x.size();
      Values out;
      for (int q = 0; q < data.points; ++q) {
        const Vec3* B = data.gradient.data() +
                        static_cast<std::size_t>(data.points) * at(data.nodes.offset[at(s)]) +
                        static_cast<std::size_t>(q) * n;
        test::Gradient9 F;
        for (std::size_t a = 0; a < n; ++a) {
          for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j)
              F[static_cast<std::size_t>(3 * i + j)] +=
                  x[a][static_cast<std::size_t>(i)] * HyperDual(B[a][j]);
          }
        }
        // |C - 1|^2 / 4 = (tr C^2 - 2 tr C + 3) / 4
        const HyperDual squares = test::trace_C2(F) - HyperDual(2) * test::trace_C(F) + HyperDual(3);
        out.energy += HyperDual(data.weight[at(s * data.points + q)] * 0.4 / test::kProbeStep / 4) * squares;
      }
      return out;
    });
  }
  CHECK(found == 1);
}

TEST_CASE("segments have the derivatives of their length") {
  // Between nodes, so that the ends are known.
  test::SceneCase c = find_case("tet4, one field");
  CableDef def;
  def.points = {c.mesh.nodes[0], c.mesh.nodes[5], c.mesh.nodes[9], c.mesh.nodes[2]};
  c.effects = {cable(def)};
  const SceneProbe scene(c);
  const auto pools = pools_of<SegmentPool>(scene);
  REQUIRE(pools.size() == 1);
  compare(scene, *pools[0], [&](Index s, const std::vector<Point>& x) {
    REQUIRE(x.size() == 2);
    const Point d = minus(x[1], x[0]);
    return Values{HyperDual(0), {sqrt(inner(d, d)) - HyperDual(pools[0]->rest_length(s))}};
  });
}
