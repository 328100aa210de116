#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

#include "catch.h"
#include "contract/registry.h"
#include "support/allocations.h"

using namespace isochor;
using test::HyperDual;
using test::MaterialCase;

namespace {

using Gradient = std::array<double, 9>;

double det(const Gradient& F) {
  return F[0] * (F[4] * F[8] - F[5] * F[7]) - F[1] * (F[3] * F[8] - F[5] * F[6]) +
         F[2] * (F[3] * F[7] - F[4] * F[6]);
}

// kLanes deformation gradients within the domain of a material: near rest, far from it, strongly stretched.
std::vector<std::array<Gradient, kLanes>> samples(const MaterialCase& c) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<std::array<Gradient, kLanes>> out;
  for (const double size : {1e-3, 0.1, 0.4, 0.8}) {
    std::array<Gradient, kLanes> batch{};
    for (Gradient& F : batch) {
      do {
        for (std::size_t i = 0; i < 9; ++i) F[i] = (i % 4 == 0 ? 1.0 : 0.0) + size * unit(random);
      } while (std::abs(det(F)) < 0.05 || det(F) > c.largest_J || (!c.inverted && det(F) < 0.05));
    }
    out.push_back(batch);
  }
  return out;
}

PointBatch to_batch(const std::array<Gradient, kLanes>& F) {
  PointBatch batch;
  for (std::size_t l = 0; l < kLanes; ++l) {
    for (std::size_t i = 0; i < 9; ++i) batch.F[i][l] = F[l][i];
    batch.element[l] = static_cast<Index>(l);
  }
  return batch;
}

std::size_t packed(std::size_t i, std::size_t j) {
  return i >= j ? i * (i + 1) / 2 + j : j * (j + 1) / 2 + i;
}

Gradient rotation() {
  // About (1, 2, 2)/3 by 0.9 rad.
  const double n[3] = {1.0 / 3, 2.0 / 3, 2.0 / 3}, s = std::sin(0.9), k = 1 - std::cos(0.9);
  Gradient R{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) R[3 * i + j] = (i == j ? 1 - k : 0.0) + k * n[i] * n[j];
  }
  R[1] -= s * n[2], R[3] += s * n[2], R[2] += s * n[1], R[6] -= s * n[1], R[5] -= s * n[0], R[7] += s * n[0];
  return R;
}

Gradient times(const Gradient& A, const Gradient& B) {
  Gradient C{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      for (std::size_t k = 0; k < 3; ++k) C[3 * i + j] += A[3 * i + k] * B[3 * k + j];
    }
  }
  return C;
}

}  // namespace

TEST_CASE("materials agree with automatic differentiation of their formulas") {
  for (const MaterialCase& c : test::material_cases()) {
    INFO(c.name);
    for (const auto& sample : samples(c)) {
      ResponseBatch r;
      c.material->evaluate(Want::hessian, to_batch(sample), r);
      double size = c.scale, worst_psi = 0, worst_P = 0, worst_A = 0;
      for (std::size_t l = 0; l < kLanes; ++l) {
        for (std::size_t i = 0; i < 9; ++i) {
          for (std::size_t j = 0; j <= i; ++j) {
            std::array<HyperDual, 9> F;
            for (std::size_t k = 0; k < 9; ++k) F[k] = sample[l][k];
            F[i].b = 1;
            F[j].c = 1;
            const HyperDual psi = c.energy(F);
            size = std::max({size, std::abs(psi.a), std::abs(psi.b), std::abs(psi.d)});
            worst_psi = std::max(worst_psi, std::abs(r.psi[l] - psi.a));
            worst_P = std::max(worst_P, std::abs(r.P[i][l] - psi.b));
            worst_A = std::max(worst_A, std::abs(r.A[packed(i, j)][l] - psi.d));
          }
        }
      }
      CHECK(worst_psi < 1e-13 * size);
      CHECK(worst_P < 1e-13 * size);
      CHECK(worst_A < 1e-12 * size);
    }
  }
}

TEST_CASE("materials agree with finite differences over decades of steps") {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (const MaterialCase& c : test::material_cases()) {
    INFO(c.name);
    for (const auto& sample : samples(c)) {
      Gradient d;
      for (double& v : d) v = unit(random);
      ResponseBatch at_sample, plus, minus;
      c.material->evaluate(Want::hessian, to_batch(sample), at_sample);
      double best_P = 1, best_A = 1;
      for (double h = 1e-2; h > 1e-9; h /= 10) {
        auto forward = sample, backward = sample;
        for (std::size_t l = 0; l < kLanes; ++l) {
          for (std::size_t i = 0; i < 9; ++i) forward[l][i] += h * d[i], backward[l][i] -= h * d[i];
        }
        c.material->evaluate(Want::gradient, to_batch(forward), plus);
        c.material->evaluate(Want::gradient, to_batch(backward), minus);
        double error_P = 0, error_A = 0, size = c.scale;
        for (std::size_t l = 0; l < kLanes; ++l) {
          double slope = 0;
          for (std::size_t i = 0; i < 9; ++i) {
            slope += at_sample.P[i][l] * d[i];
            double bend = 0;
            for (std::size_t j = 0; j < 9; ++j) bend += at_sample.A[packed(i, j)][l] * d[j];
            error_A = std::max(error_A, std::abs((plus.P[i][l] - minus.P[i][l]) / (2 * h) - bend));
            size = std::max(size, std::abs(bend));
          }
          error_P = std::max(error_P, std::abs((plus.psi[l] - minus.psi[l]) / (2 * h) - slope));
          size = std::max(size, std::abs(slope));
        }
        best_P = std::min(best_P, error_P / size);
        best_A = std::min(best_A, error_A / size);
      }
      CHECK(best_P < 1e-8);
      CHECK(best_A < 1e-8);
    }
  }
}

TEST_CASE("materials do not see rotations") {
  const Gradient R = rotation();
  for (const MaterialCase& c : test::material_cases()) {
    if (!c.objective) continue;
    INFO(c.name);
    for (const auto& sample : samples(c)) {
      auto turned = sample, spun = sample;
      for (Gradient& F : turned) F = times(R, F);
      for (Gradient& F : spun) F = times(F, R);
      ResponseBatch r, after, before;
      c.material->evaluate(Want::gradient, to_batch(sample), r);
      c.material->evaluate(Want::gradient, to_batch(turned), after);
      c.material->evaluate(Want::gradient, to_batch(spun), before);
      for (std::size_t l = 0; l < kLanes; ++l) {
        const double size = c.scale + std::abs(r.psi[l]);
        CHECK(std::abs(after.psi[l] - r.psi[l]) < 1e-13 * size);  // objective
        if (c.isotropic) CHECK(std::abs(before.psi[l] - r.psi[l]) < 1e-13 * size);
        Gradient P;
        double stress = c.scale;
        for (std::size_t i = 0; i < 9; ++i) P[i] = r.P[i][l], stress = std::max(stress, std::abs(P[i]));
        const Gradient RP = times(R, P);
        for (std::size_t i = 0; i < 9; ++i) CHECK(std::abs(after.P[i][l] - RP[i]) < 1e-12 * stress);
      }
    }
  }
}

TEST_CASE("materials are at rest when undeformed") {
  for (const MaterialCase& c : test::material_cases()) {
    INFO(c.name);
    std::array<Gradient, kLanes> rest{};
    for (Gradient& F : rest) F = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    ResponseBatch r;
    c.material->evaluate(Want::hessian, to_batch(rest), r);
    if (!c.stress_free) continue;
    for (std::size_t l = 0; l < kLanes; ++l) {
      CHECK(std::abs(r.psi[l]) < 1e-15 * c.scale);
      for (std::size_t i = 0; i < 9; ++i) CHECK(std::abs(r.P[i][l]) < 1e-15 * c.scale);
    }
  }
}

TEST_CASE("materials answer the same whatever is asked, lane by lane") {
  for (const MaterialCase& c : test::material_cases()) {
    INFO(c.name);
    for (const auto& sample : samples(c)) {
      ResponseBatch value, gradient, hessian;
      c.material->evaluate(Want::value, to_batch(sample), value);
      c.material->evaluate(Want::gradient, to_batch(sample), gradient);
      c.material->evaluate(Want::hessian, to_batch(sample), hessian);
      CHECK(std::memcmp(value.psi, hessian.psi, sizeof value.psi) == 0);
      CHECK(std::memcmp(gradient.psi, hessian.psi, sizeof value.psi) == 0);
      CHECK(std::memcmp(gradient.P, hessian.P, sizeof gradient.P) == 0);
      // A lane does not see its neighbors.
      for (std::size_t l = 0; l < kLanes; ++l) {
        std::array<Gradient, kLanes> alone;
        alone.fill(sample[l]);
        ResponseBatch r;
        c.material->evaluate(Want::hessian, to_batch(alone), r);
        bool same = r.psi[l] == hessian.psi[l];
        for (std::size_t i = 0; i < 9; ++i) same = same && r.P[i][l] == hessian.P[i][l];
        for (std::size_t i = 0; i < 45; ++i) same = same && r.A[i][l] == hessian.A[i][l];
        CHECK(same);
      }
    }
  }
}

TEST_CASE("materials say where they have no value") {
  for (const MaterialCase& c : test::material_cases()) {
    INFO(c.name);
    std::array<Gradient, kLanes> turned{};
    for (Gradient& F : turned) F = {-0.7, 0, 0, 0, 1, 0, 0, 0, 1};
    ResponseBatch r;
    c.material->evaluate(Want::hessian, to_batch(turned), r);
    for (std::size_t l = 0; l < kLanes; ++l) {
      if (c.inverted) {
        CHECK(std::isfinite(r.psi[l]));
      } else {
        CHECK(r.psi[l] == std::numeric_limits<double>::infinity());
      }
    }
  }
}

TEST_CASE("materials allocate nothing") {
  if (!test::allocations_are_counted()) return;
  for (const MaterialCase& c : test::material_cases()) {
    INFO(c.name);
    const PointBatch batch = to_batch(samples(c)[1]);
    ResponseBatch r;
    const test::AllocationCount allocations;
    for (const Want want : {Want::value, Want::gradient, Want::hessian}) c.material->evaluate(want, batch, r);
    CHECK(allocations.count() == 0);
  }
}
