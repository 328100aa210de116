// Rows, supports and the assembled system of every scene of the registry: what the pools say one by one must
// add up.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <random>

#include "catch.h"
#include "contract/scene_probe.h"
#include "engine/solve/kkt/kkt.h"
#include "support/allocations.h"
#include "support/dense.h"
#include "support/meshes.h"

using namespace isochor;
using test::SceneProbe;

namespace {

double length(const Vec3& v) {
  return std::sqrt(dot(v, v));
}

// An assembly with fixed multipliers of its rows.
struct Assembled {
  const System& system;
  TbbParallel parallel{1};
  Assembly assembly;
  std::vector<double> lambda, prescribed;

  explicit Assembled(const SceneProbe& scene, double uniform = 0)
      : system(scene.system()),
        assembly(scene.shared_system(), parallel),
        lambda(scene.multipliers(at(system.rows()))),
        prescribed(scene.multipliers(at(system.prescribed_rows()))) {
    if (uniform == 0) return;
    std::fill(lambda.begin(), lambda.end(), uniform);
    std::fill(prescribed.begin(), prescribed.end(), uniform);
  }
  void evaluate(Want want, const std::vector<Vec3>& x) {
    assembly.evaluate(want, Definiteness::exact, x, lambda, prescribed);
  }
  std::vector<double> rows() const {
    std::vector<double> phi(lambda.size());
    assembly.row_values(phi);
    return phi;
  }
  std::vector<double> prescribed_rows() const {
    std::vector<double> phi(prescribed.size());
    assembly.prescribed_row_values(phi);
    return phi;
  }
  double potential(const std::vector<Vec3>& x) {
    evaluate(Want::value, x);
    double sum = assembly.energy();
    const auto phi = rows(), given = prescribed_rows();
    for (std::size_t r = 0; r < phi.size(); ++r) sum += lambda[r] * phi[r];
    for (std::size_t r = 0; r < given.size(); ++r) sum += prescribed[r] * given[r];
    return sum;
  }
  std::vector<Vec3> residual(const std::vector<Vec3>& x) {
    evaluate(Want::gradient, x);
    std::vector<Vec3> r(x.size());
    assembly.residual(r);
    return r;
  }
};

std::vector<Vec3> rotated(const std::vector<Vec3>& x) {
  // About z by 0.5, then about x by -1.1, then away.
  std::vector<Vec3> out;
  for (const Vec3& p : x) {
    const Vec3 q{std::cos(0.5) * p.x - std::sin(0.5) * p.y, std::sin(0.5) * p.x + std::cos(0.5) * p.y, p.z};
    out.push_back({q.x + 0.7, std::cos(1.1) * q.y + std::sin(1.1) * q.z - 0.2,
                   -std::sin(1.1) * q.y + std::cos(1.1) * q.z + 1.3});
  }
  return out;
}

}  // namespace

TEST_CASE("forces of a scene are the slope of its potential, and its matrix the slope of both") {
  for (const auto& c : test::scene_cases()) {
    INFO(c.name);
    const SceneProbe scene(c);
    Assembled a(scene);
    const auto d = scene.direction(17);
    std::vector<Vec3> Hd(d.size());
    std::vector<double> Gd(a.lambda.size());
    a.evaluate(Want::hessian, scene.x());
    a.assembly.hessian_times(d, Hd);
    a.assembly.jacobian_times(d, Gd);
    const auto r = a.residual(scene.x());
    double slope = 0, size = 0;
    for (std::size_t i = 0; i < d.size(); ++i) slope += dot(r[i], d[i]), size = std::max(size, length(Hd[i]));
    double best_slope = 1, best_H = 1, best_G = 1;
    for (double h = 1e-3; h > 1e-8; h /= 10) {
      const auto plus = scene.moved(d, h), minus = scene.moved(d, -h);
      const double up = a.potential(plus);
      const auto rows_up = a.rows();
      const double down = a.potential(minus);
      const auto rows_down = a.rows();
      best_slope = std::min(best_slope, std::abs((up - down) / (2 * h) - slope) / std::abs(slope));
      const auto r_up = a.residual(plus), r_down = a.residual(minus);
      double error = 0;
      for (std::size_t i = 0; i < d.size(); ++i) {
        error = std::max(error, length((1 / (2 * h)) * (r_up[i] - r_down[i]) - Hd[i]));
      }
      best_H = std::min(best_H, error / size);
      double error_G = 0, size_G = 1e-300;
      for (std::size_t i = 0; i < Gd.size(); ++i) {
        error_G = std::max(error_G, std::abs((rows_up[i] - rows_down[i]) / (2 * h) - Gd[i]));
        size_G = std::max(size_G, std::abs(Gd[i]));
      }
      best_G = std::min(best_G, error_G / size_G);
    }
    CHECK(best_slope < 1e-7);
    CHECK(best_H < 1e-7);
    CHECK(best_G < 1e-7);
  }
}

TEST_CASE("the solution of a linear system solves it whatever the treatment of its rows") {
  for (const auto& c : test::scene_cases()) {
    INFO(c.name);
    const SceneProbe scene(c);
    const System& s = scene.system();
    Assembled a(scene);
    a.evaluate(Want::hessian, scene.x());
    const TbbParallel serial{1};
    Kkt kkt(scene.shared_system(), serial, make_linear_solver(Solver::automatic));
    const double mass_scale = 1e6;  // far from any singular matrix
    const std::vector<double> stiffness(at(s.nodes()), 1.0);
    Kkt::Values values;
    values.mass_scale = mass_scale;
    values.stiffness = stiffness;
    // Tangents of rows with a law, at no multiplier and as the scene starts.
    std::vector<double> tangent(s.compliance().size(), 0.0), memory(at(s.memory()), 0.0);
    s.start_memory(memory);
    const std::vector<double> none(at(s.rows()), 0.0);
    for (const auto& law : s.laws()) {
      const RowPool& pool = *s.parts().row_pools[at(law.row_pool)];
      std::vector<double> strain(at(pool.rows()));
      s.evaluate_law(law, 0, 0.1, memory, none, strain,
                     std::span(tangent).subspan(law.first_entry, pool.compliance.size()));
    }
    values.tangent = tangent;
    StageSeconds seconds;
    const Kkt::Outcome f = kkt.factor(a.assembly, values, seconds);
    INFO(f.message);
    if (f.status == FactorStatus::singular) continue;
    REQUIRE(f.status == FactorStatus::ok);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(-1, 1);
    std::vector<Vec3> b(at(s.nodes())), u(b.size()), Hu(b.size()), GTl(b.size());
    std::vector<double> g(a.lambda.size()), l(g.size()), Gu(g.size());
    for (Vec3& v : b) v = {unit(random), unit(random), unit(random)};
    for (std::size_t r = 0; r < g.size(); ++r) g[r] = unit(random) * s.row_measure()[r];
    REQUIRE(kkt.solve(b, g, u, l, seconds));
    a.assembly.hessian_times(u, Hu);
    a.assembly.constraint_force(l, GTl);
    a.assembly.jacobian_times(u, Gu);
    for (std::size_t k = 0; k < s.compliance().size(); ++k) {
      const ComplianceEntry& e = s.compliance()[k];
      const double value = e.value + tangent[k];
      Gu[at(e.row)] -= value * l[at(e.col)];
      if (e.row != e.col) Gu[at(e.col)] -= value * l[at(e.row)];
    }
    // Rows without compliance that hold a rigid body together carry forces that are much larger than their
    // sum.
    double worst = 0, worst_row = 0, largest = 1;
    for (Index i = 0; i < s.nodes(); ++i) {
      largest = std::max({largest, length(Hu[at(i)]), length(GTl[at(i)])});
      const Vec3 f_left = Hu[at(i)] + GTl[at(i)] + mass_scale * s.parts().mass[at(i)] * u[at(i)] - b[at(i)];
      const Index k = s.basis_of()[at(i)];
      Vec3 q = k >= 0 ? transposed_times(s.free_bases()[at(k)].directions, f_left) : f_left;
      for (Index d = s.first_unknown()[at(i) + 1] - s.first_unknown()[at(i)]; d < 3; ++d) q[d] = 0;
      worst = std::max(worst, length(q));
    }
    for (std::size_t r = 0; r < l.size(); ++r) {
      worst_row = std::max(worst_row, std::abs(Gu[r] - g[r]) / s.row_measure()[r]);
    }
    INFO("left over " << worst << " of forces up to " << largest);
    CHECK(worst < 1e-9 * largest);
    CHECK(worst_row < 1e-6);
  }
}

TEST_CASE("matrix values are those of the pools in the free directions, minus the compliance") {
  for (const auto& c : test::scene_cases()) {
    INFO(c.name);
    const SceneProbe scene(c);
    const System& s = scene.system();
    if (!s.condensed_rows().empty()) continue;  // those are in the test below
    Assembled a(scene);
    a.evaluate(Want::hessian, scene.x());
    const double mass_scale = 3;
    std::vector<double> values(static_cast<std::size_t>(s.kkt().nonzeros()), std::nan(""));
    a.assembly.kkt_values(mass_scale, values);
    // A random vector of free coordinates and multipliers, through the matrix and through the products.
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(-1, 1);
    Eigen::VectorXd v(s.kkt().size), y = Eigen::VectorXd::Zero(s.kkt().size);
    for (auto& e : v) e = unit(random);
    for (Index col = 0; col < s.kkt().size; ++col) {
      for (auto k = s.kkt().column_start[at(col)]; k < s.kkt().column_start[at(col) + 1]; ++k) {
        const Index row = s.kkt().row[static_cast<std::size_t>(k)];
        y[row] += values[static_cast<std::size_t>(k)] * v[col];
        if (row != col) y[col] += values[static_cast<std::size_t>(k)] * v[row];
      }
    }
    std::vector<Vec3> u(at(s.nodes())), Hu(u.size()), GTl(u.size());
    std::vector<double> l(a.lambda.size()), Gu(l.size());
    const auto basis = [&](Index i) {
      const Index b = s.basis_of()[at(i)];
      Mat3 identity;
      for (int k = 0; k < 3; ++k) identity(k, k) = 1;
      return b >= 0 ? s.free_bases()[at(b)].directions : identity;
    };
    for (Index i = 0; i < s.nodes(); ++i) {
      Vec3 q{};
      for (Index k = s.first_unknown()[at(i)]; k < s.first_unknown()[at(i) + 1]; ++k) {
        q[k - s.first_unknown()[at(i)]] = v[k];
      }
      u[at(i)] = basis(i) * q;
    }
    for (std::size_t r = 0; r < l.size(); ++r) l[r] = v[s.free_unknowns() + static_cast<Index>(r)];
    a.assembly.hessian_times(u, Hu);
    a.assembly.constraint_force(l, GTl);
    a.assembly.jacobian_times(u, Gu);
    for (const ComplianceEntry& e : s.compliance()) {
      Gu[at(e.row)] -= e.value * l[at(e.col)];
      if (e.row != e.col) Gu[at(e.col)] -= e.value * l[at(e.row)];
    }
    double worst = 0;
    for (Index i = 0; i < s.nodes(); ++i) {
      const Vec3 f = Hu[at(i)] + GTl[at(i)] + mass_scale * s.parts().mass[at(i)] * u[at(i)];
      const Vec3 q = transposed_times(basis(i), f);
      for (Index k = s.first_unknown()[at(i)]; k < s.first_unknown()[at(i) + 1]; ++k) {
        worst = std::max(worst, std::abs(q[k - s.first_unknown()[at(i)]] - y[k]));
      }
    }
    for (std::size_t r = 0; r < l.size(); ++r) {
      worst = std::max(worst, std::abs(Gu[r] - y[s.free_unknowns() + static_cast<Index>(r)]));
    }
    CHECK(worst < 1e-12 * y.cwiseAbs().maxCoeff());
  }
}

TEST_CASE("rows are well formed") {
  for (const auto& c : test::scene_cases()) {
    const SceneProbe scene(c);
    for (const auto& pool : scene.system().parts().row_pools) {
      INFO(c.name << ", rows " << pool->name());
      const StencilPool& stencils = *scene.system().parts().stencil_pools[at(pool->stencil_pool)];
      REQUIRE(pool->rows() > 0);
      CHECK(pool->weight.size() == pool->map.item.size());
      CHECK(pool->metric.size() == at(pool->rows()));
      CHECK(pool->measure.size() == at(pool->rows()));
      for (const Index f : pool->map.item) CHECK((f >= 0 && f < stencils.stencils() * stencils.functions()));
      for (const double m : pool->metric) CHECK((m > 0 && std::isfinite(m)));
      for (const double m : pool->measure) CHECK((m > 0 && std::isfinite(m)));
      // Compliance: lower triangle, symmetric positive semidefinite.
      Eigen::MatrixXd C = Eigen::MatrixXd::Zero(pool->rows(), pool->rows());
      for (const ComplianceEntry& e : pool->compliance) {
        REQUIRE((e.col >= 0 && e.row >= e.col && e.row < pool->rows()));
        C(e.row, e.col) += e.value;
        if (e.row != e.col) C(e.col, e.row) += e.value;
      }
      const Eigen::VectorXd eigenvalues = test::eigenvalues(C);
      CHECK(eigenvalues.minCoeff() >= -1e-13 * std::max(1e-300, eigenvalues.maxCoeff()));
      std::vector<double> value(at(pool->rows()), std::nan(""));
      pool->update(0.4, value);
      for (const double v : value) CHECK(std::isfinite(v));
    }
  }
}

TEST_CASE("supports give orthonormal directions and finite targets") {
  for (const auto& c : test::scene_cases()) {
    INFO(c.name);
    const SceneProbe scene(c);
    for (const auto& p : scene.system().parts().prescribers) {
      for (const PrescribedNode& n : p->nodes) {
        REQUIRE((n.directions >= 1 && n.directions <= 3));
        for (std::size_t i = 0; i < static_cast<std::size_t>(n.directions); ++i) {
          for (std::size_t j = 0; j <= i; ++j) {
            CHECK(dot(n.direction[i], n.direction[j]) == Approx(i == j ? 1 : 0).margin(1e-14));
          }
        }
      }
      std::vector<Vec3> target(p->nodes.size());
      p->target(0, target);
      for (std::size_t i = 0; i < target.size(); ++i) {
        CHECK(length(target[i] - scene.rest()[at(p->nodes[i].node)]) < 1e-15);
      }
      p->target(0.7, target);
      for (const Vec3& t : target) CHECK(std::isfinite(length(t)));
    }
  }
}

TEST_CASE("a scene does not see rigid motions") {
  for (const auto& c : test::scene_cases()) {
    if (!c.rigid_invariant) continue;
    INFO(c.name);
    const SceneProbe scene(c);
    Assembled a(scene);
    const double before = a.potential(scene.x()), after = a.potential(rotated(scene.x()));
    CHECK(after == Approx(before).epsilon(1e-11));
    const auto here = a.residual(scene.x());
    const auto there = a.residual(rotated(scene.x()));
    const auto zero = rotated({Vec3{}}).front();
    const auto turned = rotated(here);
    double worst = 0, size = 0;
    for (std::size_t i = 0; i < here.size(); ++i) {
      worst = std::max(worst, length(there[i] - (turned[i] - zero)));
      size = std::max(size, length(here[i]));
    }
    CHECK(worst < 1e-12 * size);
    // No net force, no net moment.
    Vec3 force{}, moment{};
    for (std::size_t i = 0; i < here.size(); ++i) force += here[i], moment += cross(scene.x()[i], here[i]);
    CHECK(length(force) < 1e-12 * size * std::sqrt(static_cast<double>(here.size())));
    CHECK(length(moment) < 1e-11 * size * std::sqrt(static_cast<double>(here.size())));
  }
}

TEST_CASE("a scene does not see the numbers of nodes, the order of cells or of their nodes") {
  for (const auto& c : test::scene_cases()) {
    if (c.numbered_cells) continue;
    INFO(c.name);
    const SceneProbe scene(c);
    auto other = c;
    std::vector<Index> place;
    other.mesh = test::shuffled(c.mesh, 5, place);
    const SceneProbe shuffled(other);
    // Further bodies keep their numbers.
    while (place.size() < scene.x().size()) place.push_back(static_cast<Index>(place.size()));
    std::vector<Vec3> x(scene.x().size());
    for (std::size_t i = 0; i < x.size(); ++i) x[at(place[i])] = scene.x()[i];
    Assembled a(scene, 0.3), b(shuffled, 0.3);
    CHECK(b.potential(x) == Approx(a.potential(scene.x())).epsilon(1e-12));
    auto phi = a.rows(), psi = b.rows();
    std::sort(phi.begin(), phi.end());
    std::sort(psi.begin(), psi.end());
    REQUIRE(phi.size() == psi.size());
    for (std::size_t r = 0; r < phi.size(); ++r) CHECK(psi[r] == Approx(phi[r]).epsilon(1e-10).margin(1e-14));
    const auto r = a.residual(scene.x()), q = b.residual(x);
    double worst = 0, size = 0;
    for (std::size_t i = 0; i < r.size(); ++i) {
      worst = std::max(worst, length(q[at(place[i])] - r[i]));
      size = std::max(size, length(r[i]));
    }
    CHECK(worst < 1e-12 * size);
    // Coupled stencils know of one triangle at each of their points, and which is a matter of order.
    if (!scene.system().couples())
      CHECK(shuffled.system().kkt().nonzeros() == scene.system().kkt().nonzeros());
    for (std::size_t i = 0; i < r.size(); ++i) {
      CHECK(shuffled.system().parts().mass[at(place[i])] == Approx(scene.system().parts().mass[i]));
    }
  }
}

TEST_CASE("assembling allocates nothing") {
  if (!test::allocations_are_counted()) return;
  for (const auto& c : test::scene_cases()) {
    INFO(c.name);
    const SceneProbe scene(c);
    Assembled a(scene);
    std::vector<double> values(static_cast<std::size_t>(scene.system().kkt().nonzeros())),
        phi(a.lambda.size()), magnitude(scene.x().size());
    std::vector<Vec3> r(scene.x().size()), y(r.size());
    const auto d = scene.direction(2);
    const test::AllocationCount allocations;
    for (const Want want : {Want::value, Want::gradient, Want::hessian}) a.evaluate(want, scene.x());
    a.assembly.kkt_values(1, values);
    a.assembly.residual(r);
    a.assembly.residual_magnitude(magnitude);
    a.assembly.row_values(phi);
    a.assembly.hessian_times(d, y);
    a.assembly.jacobian_times(d, phi);
    a.assembly.constraint_force(a.lambda, y);
    const double energy = a.assembly.energy() + a.assembly.absolute_energy();
    const long count = allocations.count();
    CHECK(std::isfinite(energy));
    CHECK(count == 0);
  }
}
