// What is added to a material or made around one: fibers, a compression penalty, a memory, fields, the guard
// of elements.
#include "contract/formulas.h"
#include "contract/material_constants.h"
#include "contract/registry.h"
#include "engine/elements/element_guard.h"
#include "engine/elements/material_model.h"
#include "isochor/fiber_fields.h"
#include "isochor/mullins.h"
#include "isochor/viscoelastic.h"

namespace test {

namespace {

using isochor::ElasticConstants;
using isochor::MaterialPtr;
using isochor::Result;

// Two families, one of them dispersed, in a neo-Hookean matrix; and everything times a factor.
void add_fibers(std::vector<MaterialCase>& out) {
  isochor::FiberFamily a, b;
  a.direction = {1, 2, 2};
  a.k1 = 0.8;
  b.direction = {0, 3, -4};
  b.k1 = 0.5;
  b.k2 = 0.7;
  b.dispersion = 0.1;
  const auto fibers = [](const Gradient9& F, double x, double y, double z, double d, double k1, double k2) {
    const double n = x * x + y * y + z * z, v[3] = {x, y, z};
    HyperDual along;
    for (std::size_t i = 0; i < 3; ++i) {
      along += square(F[3 * i] * v[0] + F[3 * i + 1] * v[1] + F[3 * i + 2] * v[2]);
    }
    const HyperDual E = d * trace_C(F) + (1 - 3 * d) / n * along - 1.0;
    if (E.a <= 0) return HyperDual();
    return k2 > 0 ? k1 / (2 * k2) * (exp(k2 * E * E) - 1.0) : 0.5 * k1 * E * E;
  };
  const auto energy = [=](const Gradient9& F) {
    return 0.5 * kMu * (trace_C(F) - 3.0) - kMu * log(determinant(F)) + fibers(F, 1, 2, 2, 0, 0.8, 0) +
           fibers(F, 0, 3, -4, 0.1, 0.5, 0.7);
  };
  const MaterialPtr matrix = made(isochor::neo_hookean(constants()));
  MaterialCase c;
  c.name = "neo_hookean with fibers";
  c.covers = {"materials/fibers"};
  c.material = made(isochor::with_fibers(matrix, {a, b}))->distortional();
  c.energy = energy;
  c.isotropic = false;
  out.push_back(c);
  c.name = "neo_hookean with fibers, times 1.7";
  c.covers = {"materials/stiffness_field"};
  const std::vector<double> factor(isochor::kLanes, 1.7);
  c.material =
      made(isochor::with_stiffness_field(made(isochor::with_fibers(matrix, {a, b})), factor))->distortional();
  c.energy = [=](const Gradient9& F) { return 1.7 * energy(F); };
  out.push_back(c);
}

// Fibers in all directions, as the families that stand for them.
void add_spread_fibers(std::vector<MaterialCase>& out) {
  constexpr double b = 0.7, k1 = 0.8, k2 = 0.3;
  isochor::FiberFamily family;
  family.direction = {1, 2, 2};
  family.k1 = k1;
  family.k2 = k2;
  family.exponent = 4;
  isochor::FiberSpread spread;
  spread.concentration = b;
  spread.rings = 3;
  spread.around = 5;
  const auto families = isochor::spread_fibers(family, spread);
  if (!families) throw std::runtime_error(families.error());
  MaterialCase c;
  c.name = "neo_hookean with fibers in all directions";
  c.covers = {"materials/fiber_spread"};
  c.material =
      made(isochor::with_fibers(made(isochor::neo_hookean(constants())), families.value()))->distortional();
  // The formula of single fibers, for the directions and stiffnesses that the quadrature has; that these are
  // those of the distribution is a matter of tests/unit/fiber_fields.cpp.
  c.energy = [all = families.value()](const Gradient9& F) {
    HyperDual sum = 0.5 * kMu * (trace_C(F) - 3.0) - kMu * log(determinant(F));
    for (const isochor::FiberFamily& f : all) {
      const double v[3] = {f.direction.x, f.direction.y, f.direction.z};
      HyperDual along;
      for (std::size_t i = 0; i < 3; ++i)
        along += square(F[3 * i] * v[0] + F[3 * i + 1] * v[1] + F[3 * i + 2] * v[2]);
      const HyperDual E = along - 1.0;
      if (E.a > 0) sum += f.k1 / (4 * k2) * (exp(k2 * square(square(E))) - 1.0);
    }
    return sum;
  };
  c.isotropic = false;
  out.push_back(c);
}

// psi of the toe law by Gauss quadrature of its T(s)/s, whose derivatives are those of its upper end.
HyperDual toe_energy(const HyperDual& s, double c3, double c4, double c5, double straight) {
  const auto T = [=](const HyperDual& v) {
    if (v.a <= straight) return c3 * (exp(c4 * (v - 1.0)) - 1.0);
    return c5 * v + (c3 * (std::exp(c4 * (straight - 1)) - 1) - c5 * straight);
  };
  // With five points on each of many pieces; the piece with the end scales with it.
  constexpr double x[] = {0, 0.5384693101056831, 0.9061798459386640},
                   w[] = {0.5688888888888889, 0.4786286704993665, 0.2369268850561891};
  const auto piece = [&](const HyperDual& low, const HyperDual& high) {
    HyperDual sum;
    const HyperDual middle = 0.5 * (low + high), half = 0.5 * (high - low);
    for (int i = 0; i < 3; ++i) {
      for (const double sign : {-1.0, 1.0}) {
        if (i == 0 && sign < 0) continue;
        const HyperDual v = middle + sign * x[i] * half;
        sum += w[i] * half * T(v) / v;
      }
    }
    return sum;
  };
  HyperDual psi;
  if (s.a <= 1) return psi;
  const HyperDual bend = s.a > straight ? HyperDual(straight) : s;
  constexpr int n = 40;
  for (int i = 0; i < n; ++i) {
    psi += piece(1.0 + (bend - 1.0) * (1.0 * i / n), 1.0 + (bend - 1.0) * ((i + 1.0) / n));
    if (s.a > straight) psi += piece(bend + (s - bend) * (1.0 * i / n), bend + (s - bend) * ((i + 1.0) / n));
  }
  return psi;
}

// Fibers of J^(-1/3) F, with dispersion, another exponent and the toe law, in matrices of the same kind.
void add_isochoric_fibers(std::vector<MaterialCase>& out) {
  const auto along = [](const Gradient9& F, double x, double y, double z) {
    const double n = x * x + y * y + z * z, v[3] = {x, y, z};
    HyperDual sum;
    for (std::size_t i = 0; i < 3; ++i) {
      sum += square(F[3 * i] * v[0] + F[3 * i + 1] * v[1] + F[3 * i + 2] * v[2]);
    }
    return sum / n;
  };
  const auto matrix = [](const Gradient9& F) {
    return 0.55 * (pow(determinant(F), -2.0 / 3) * trace_C(F) - 3.0);
  };
  const MaterialPtr base = made(isochor::isochoric_yeoh({{0.55}, 0.3}));
  struct Case {
    std::string name;
    isochor::FiberFamily family;
    std::function<HyperDual(const Gradient9&)> energy;
  };
  std::vector<Case> list;
  isochor::FiberFamily f;
  f.direction = {1, 2, 2};
  f.k1 = 0.8;
  f.k2 = 0.4;
  f.dispersion = 0.15;
  f.isochoric = true;
  list.push_back({"Holzapfel-Gasser-Ogden", f, [=](const Gradient9& F) {
                    const HyperDual a = pow(determinant(F), -2.0 / 3);
                    const HyperDual E = a * (0.15 * trace_C(F) + 0.55 * along(F, 1, 2, 2)) - 1.0;
                    if (E.a <= 0) return HyperDual();
                    return 0.8 / 0.8 * (exp(0.4 * E * E) - 1.0);
                  }});
  f.dispersion = 0;
  f.exponent = 3.5;
  list.push_back({"exponential power 3.5, isochoric", f, [=](const Gradient9& F) {
                    const HyperDual E = pow(determinant(F), -2.0 / 3) * along(F, 1, 2, 2) - 1.0;
                    if (E.a <= 0) return HyperDual();
                    return 0.8 / (3.5 * 0.4) * (exp(0.4 * pow(E, 3.5)) - 1.0);
                  }});
  f.isochoric = false;
  f.k2 = 0;
  list.push_back({"power 3.5", f, [=](const Gradient9& F) {
                    const HyperDual E = along(F, 1, 2, 2) - 1.0;
                    return E.a <= 0 ? HyperDual() : 0.8 / 3.5 * pow(E, 3.5);
                  }});
  f.exponent = 2;
  f.law = isochor::FiberLaw::toe;
  f.k1 = 0.2;
  f.k2 = 4;
  f.straight_modulus = 2.5;
  f.straight_stretch = 1.3;
  list.push_back({"toe", f, [=](const Gradient9& F) {
                    return toe_energy(pow(along(F, 1, 2, 2), 0.5), 0.2, 4, 2.5, 1.3);
                  }});
  f.isochoric = true;
  list.push_back({"toe, isochoric", f, [=](const Gradient9& F) {
                    return toe_energy(pow(determinant(F), -1.0 / 3) * pow(along(F, 1, 2, 2), 0.5), 0.2, 4,
                                      2.5, 1.3);
                  }});
  for (const Case& one : list) {
    MaterialCase c;
    c.name = "isochoric_yeoh with fibers, " + one.name;
    c.covers = {"materials/fibers"};
    c.material = made(isochor::with_fibers(base, {one.family}))->distortional();
    c.energy = [=, fibers = one.energy](const Gradient9& F) { return matrix(F) + fibers(F); };
    c.isotropic = false;
    c.scale = 10;
    c.largest_J = 2.5;
    out.push_back(c);
  }
}

using Matrix9 = std::array<HyperDual, 9>;

Matrix9 product(const Matrix9& A, const Matrix9& B) {
  Matrix9 C;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j)
      C[3 * i + j] = A[3 * i] * B[j] + A[3 * i + 1] * B[3 + j] + A[3 * i + 2] * B[6 + j];
  }
  return C;
}
Matrix9 sum(const Matrix9& A, double b, const Matrix9& B) {
  Matrix9 C;
  for (std::size_t i = 0; i < 9; ++i) C[i] = A[i] + b * B[i];
  return C;
}
Matrix9 inverse(const Matrix9& A) {
  Matrix9 C;
  const HyperDual det = determinant(A);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      const std::size_t a = (j + 1) % 3, b = (j + 2) % 3, c = (i + 1) % 3, d = (i + 2) % 3;
      C[3 * i + j] = (A[3 * a + c] * A[3 * b + d] - A[3 * a + d] * A[3 * b + c]) / det;
    }
  }
  return C;
}

// By square roots until the argument is next to 1 (Denman & Beavers), and the series there.
Matrix9 logarithm(Matrix9 A) {
  Matrix9 one;
  for (std::size_t i = 0; i < 9; i += 4) one[i] = HyperDual() + 1.0;
  constexpr int roots = 6;
  for (int k = 0; k < roots; ++k) {
    Matrix9 Y = A, Z = one;
    for (int i = 0; i < 14; ++i) {
      const Matrix9 y = sum(Y, 1, inverse(Z)), z = sum(Z, 1, inverse(Y));
      for (std::size_t e = 0; e < 9; ++e) Y[e] = 0.5 * y[e], Z[e] = 0.5 * z[e];
    }
    A = Y;
  }
  const Matrix9 x = product(sum(A, -1, one), inverse(sum(A, 1, one))), square = product(x, x);
  Matrix9 power = x, log = x;
  for (int n = 3; n < 13; n += 2) {
    power = product(power, square);
    log = sum(log, 1.0 / n, power);
  }
  for (HyperDual& v : log) v = 2.0 * (1 << roots) * v;
  return log;
}

// What stays of a material with memory, and the spring of a branch.
void add_viscoelastic(std::vector<MaterialCase>& out) {
  const isochor::MaterialPtr model = made(
      isochor::with_prony_series(made(isochor::isochoric_neo_hookean(constants())), {{0.3, 1}, {0.2, 5}}));
  const auto strain = [](const Gradient9& F) {
    return trace_C(F) / exp(2.0 / 3 * log(determinant(F))) - 3.0;
  };
  MaterialCase c;
  c.covers = {"materials/viscoelastic", "materials/isochoric_base"};
  c.name = "isochoric_neo_hookean with memory, what stays";
  c.material = model->distortional();
  c.energy = [=](const Gradient9& F) { return 0.25 * kMu * strain(F); };
  out.push_back(c);
  c.name = "isochoric_neo_hookean with memory, one field";
  c.material = model->complete().value();
  const double kappa = 1 / model->inverse_bulk();
  c.energy = [=](const Gradient9& F) {
    const HyperDual d = determinant(F) - 1.0;
    return 0.25 * kMu * strain(F) + 0.5 * kappa * d * d;
  };
  c.scale = 10;
  out.push_back(c);
  c.scale = 1;
  c.name = "logarithmic spring";
  c.material = model->memory()->branches.front().spring;
  c.energy = [](const Gradient9& F) {
    Matrix9 C;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j)
        C[3 * i + j] = F[i] * F[j] + F[3 + i] * F[3 + j] + F[6 + i] * F[6 + j];
    }
    const Matrix9 e = logarithm(C);  // twice the strain
    const HyperDual mean = (1.0 / 3) * (e[0] + e[4] + e[8]);
    HyperDual square;
    for (std::size_t i = 0; i < 9; ++i) {
      const HyperDual d = i % 4 == 0 ? e[i] - mean : e[i];
      square = square + d * d;
    }
    return 0.25 * 0.3 * kMu * square;
  };
  out.push_back(c);
}

// On a base with a barrier, and on one that lives through inversion.
void add_compression_penalty(std::vector<MaterialCase>& out) {
  const auto penalty = [](const Gradient9& F) {
    const HyperDual d = determinant(F) - 1.0;
    return 2.5 / 12 * d * d * (9.0 * d * d + 6.0);
  };
  MaterialCase c;
  c.covers = {"materials/compression_penalty"};
  c.name = "neo_hookean with compression penalty";
  c.material = made(isochor::with_compression_penalty(made(isochor::neo_hookean(constants())), {2.5, 9}))
                   ->distortional();
  c.energy = [=](const Gradient9& F) {
    return 0.5 * kMu * (trace_C(F) - 3.0) - kMu * log(determinant(F)) + penalty(F);
  };
  c.scale = 10;
  c.largest_J = 2;
  out.push_back(c);
  c.name = "stable_neo_hookean with compression penalty";
  c.material =
      made(isochor::with_compression_penalty(made(isochor::stable_neo_hookean(constants())), {2.5, 9}))
          ->distortional();
  c.energy = [=](const Gradient9& F) {
    return 0.5 * kMu * (trace_C(F) - 3.0) - kMu * (determinant(F) - 1.0) + penalty(F);
  };
  c.inverted = true;
  out.push_back(c);
}

// At one of its ratios a field of Poisson's ratio is the law at that ratio; here the second of three.
void add_poisson_field(std::vector<MaterialCase>& out) {
  const auto law = [](double nu) {
    ElasticConstants c;
    c.young = 2 * kMu * (1 + 0.3);
    c.poisson = nu;
    return isochor::stable_neo_hookean(c);
  };
  const auto field =
      made(isochor::with_poisson_field(law, {0.3, 0.3, 0.3, 0.3, 0.3, 0.3, 0.3, 0.3, 0.1, 0.45}));
  MaterialCase c;
  c.covers = {"materials/poisson_field"};
  c.name = "stable_neo_hookean with a field of Poisson's ratio";
  c.material = std::move(field->complete()).value();
  const double lambda = 2 * kMu * 0.3 / 0.4 + kMu;
  c.energy = [=](const Gradient9& F) {
    const HyperDual d = determinant(F) - 1.0;
    return 0.5 * kMu * (trace_C(F) - 3.0) - kMu * d + 0.5 * lambda * d * d;
  };
  c.scale = 10;
  c.inverted = true;
  out.push_back(c);
}

// A material for points that began their increment at a given J.
class BeganAt final : public isochor::Material {
 public:
  BeganAt(std::shared_ptr<const isochor::Material> material, double J)
      : material_(std::move(material)), J_(J) {}
  std::string_view name() const override { return material_->name(); }
  void describe(isochor::Fingerprint& f) const override { material_->describe(f); }
  void evaluate(isochor::Want want, const isochor::PointBatch& points,
                isochor::ResponseBatch& response) const override {
    material_->evaluate(want, began(points), response);
  }
  void spectrum(const isochor::PointBatch& points, const isochor::Svd3& svd,
                isochor::Spectrum& out) const override {
    material_->spectrum(began(points), svd, out);
  }

 private:
  isochor::PointBatch began(isochor::PointBatch points) const {
    for (double& J : points.J_before) J = J_;
    return points;
  }
  std::shared_ptr<const isochor::Material> material_;
  double J_;
};

void add_element_guard(std::vector<MaterialCase>& out) {
  constexpr double b = 1.3, threshold = 0.5;
  const auto guard = std::make_shared<isochor::ElementGuard>(
      std::vector<isochor::ElementGuard::Barrier>(isochor::kLanes, {b, threshold}));
  MaterialCase c;
  c.name = "element_guard";
  c.material = std::make_shared<BeganAt>(guard, 1);
  c.energy = [](const Gradient9& F) {
    const HyperDual J = determinant(F);
    if (J.a >= threshold) return HyperDual();
    const HyperDual q = log(J / threshold);
    return -b * q * q * q;
  };
  c.largest_J = 1;
  out.push_back(c);

  c.name = "element_guard of what began inverted";
  c.material = std::make_shared<BeganAt>(guard, -0.5);
  c.energy = [](const Gradient9&) { return HyperDual(); };
  c.inverted = true;
  out.push_back(c);
}

// For points that keep a given number.
class KeptAt final : public isochor::Material {
 public:
  KeptAt(std::shared_ptr<const isochor::Material> material, double kept)
      : material_(std::move(material)), kept_(kept) {}
  std::string_view name() const override { return material_->name(); }
  void describe(isochor::Fingerprint& f) const override { material_->describe(f); }
  void evaluate(isochor::Want want, const isochor::PointBatch& points,
                isochor::ResponseBatch& response) const override {
    material_->evaluate(want, with(points), response);
  }
  void spectrum(const isochor::PointBatch& points, const isochor::Svd3& svd,
                isochor::Spectrum& out) const override {
    material_->spectrum(with(points), svd, out);
  }

 private:
  isochor::PointBatch with(isochor::PointBatch points) const {
    for (double& k : points.kept) k = kept_;
    return points;
  }
  std::shared_ptr<const isochor::Material> material_;
  double kept_;
};

// Integral of erf((most - w) / c) from 0 to W < most by Simpson's rule; its derivatives are those of the end.
double integral_of_erf(double W, double most, double c) {
  constexpr int n = 2000;
  double sum = 0;
  for (int i = 0; i <= n; ++i) {
    const double weight = i == 0 || i == n ? 1 : (i % 2 == 0 ? 2 : 4);
    sum += weight * std::erf((most - W * i / n) / c);
  }
  return sum * W / (3 * n);
}

// Points that have had nothing, less and more than they have now.
void add_mullins(std::vector<MaterialCase>& out) {
  constexpr double r = 1.6, m = 0.4, beta = 0.2;
  const auto base = made(isochor::isochoric_neo_hookean(constants()));
  const MaterialPtr soft = made(isochor::with_mullins_softening(base, {r, m, beta}));
  for (const double most : {0.0, 0.15, 30.0}) {
    for (const bool complete : {false, true}) {
      MaterialCase c;
      c.name =
          "isochoric_neo_hookean softened at " + std::to_string(most) + (complete ? ", with its volume" : "");
      c.covers = {"materials/mullins"};
      c.material = std::make_shared<KeptAt>(complete ? soft->complete().value() : soft->distortional(), most);
      const double kappa = complete ? 1 / base->inverse_bulk() : 0;
      c.scale = complete ? 10 : 1;
      c.energy = [=](const Gradient9& F) {
        const HyperDual J = determinant(F), d = J - 1.0;
        const HyperDual W = 0.5 * kMu * (trace_C(F) * exp(-2.0 / 3 * log(J)) - 3.0);
        const double scale = m + beta * most;
        HyperDual soft_by;
        if (most > 0 && W.a < most) {
          const double u = (most - W.a) / scale;
          soft_by = W.chain(-integral_of_erf(W.a, most, scale) / r, -std::erf(u) / r,
                            2 / std::sqrt(M_PI) * std::exp(-u * u) / (scale * r));
        } else if (most > 0) {
          soft_by = HyperDual(-integral_of_erf(most, most, scale) / r);
        }
        return W + soft_by + 0.5 * kappa * d * d;
      };
      out.push_back(c);
    }
  }
}

}  // namespace

void add_material_additions(std::vector<MaterialCase>& out) {
  add_fibers(out);
  add_spread_fibers(out);
  add_isochoric_fibers(out);
  add_compression_penalty(out);
  add_viscoelastic(out);
  add_poisson_field(out);
  add_element_guard(out);
  add_mullins(out);
}

}  // namespace test
