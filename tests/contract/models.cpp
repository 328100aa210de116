// What a material promises at small strain, at the level of its tangent.
#include <cmath>

#include "catch.h"
#include "contract/registry.h"
#include "engine/elements/material_model.h"

using namespace isochor;

namespace {

// Shear modulus and first Lamé parameter of an isotropic tangent at rest.
struct Lame {
  double mu, lambda;
};
Lame tangent(const Material& material) {
  PointBatch batch;
  for (int l = 0; l < kLanes; ++l) {
    for (int i = 0; i < 9; ++i) batch.F[i][l] = i % 4 == 0 ? 1 : 0;
    batch.element[l] = 0;
  }
  ResponseBatch r;
  material.evaluate(Want::hessian, batch, r);
  const auto A = [&](int i, int j) { return r.A[i >= j ? i * (i + 1) / 2 + j : j * (j + 1) / 2 + i][0]; };
  return {0.5 * (A(1, 1) + A(1, 3)), A(0, 4)};
}

}  // namespace

TEST_CASE("tangents at rest give E and nu back") {
  for (const auto& model : test::model_cases()) {
    for (const double nu : {0.0, 0.1, 0.3, 0.45, 0.49, 0.499, 0.4999, 0.5}) {
      INFO(model.name << ", nu = " << nu);
      ElasticConstants c;
      c.young = 2.6e5;
      c.poisson = nu;
      const MaterialPtr m = model.make(c).value();
      CHECK(m->young() == Approx(2.6e5).epsilon(1e-14));
      CHECK(m->poisson() == Approx(nu).margin(1e-15));
      const double mu = 2.6e5 / (2 * (1 + nu));
      CHECK(m->shear_modulus() == Approx(mu).epsilon(1e-14));
      const Lame d = tangent(*m->distortional());
      CHECK(d.mu == Approx(mu).epsilon(1e-14));
      if (nu == 0.5) {
        CHECK(m->inverse_bulk() == 0);
        CHECK_FALSE(m->complete().ok());
        continue;
      }
      const double lambda = 2.6e5 * nu / ((1 + nu) * (1 - 2 * nu));
      const double carried = std::isinf(m->inverse_bulk()) ? 0 : 1 / m->inverse_bulk();
      CHECK(d.lambda + carried == Approx(lambda).epsilon(1e-12).margin(1e-9 * mu));
      const Lame whole = tangent(*m->complete().value());
      // Where lambda_L stands inside the energy its digits are lost to mu.
      const double lost = m->has_separate_volume() ? 0 : 3e-16 * lambda / mu;
      CHECK(whole.mu == Approx(mu).epsilon(1e-14 + lost));
      CHECK(whole.lambda == Approx(lambda).epsilon(1e-12).margin(1e-9 * mu));
    }
  }
}

TEST_CASE("all pairs of constants mean the same material") {
  for (const auto& model : test::model_cases()) {
    if (!model.elastic_constants) continue;
    INFO(model.name);
    ElasticConstants by_young, by_lambda, by_bulk;
    by_young.young = 3e4;
    by_young.poisson = 0.4;
    const double mu = 3e4 / 2.8, lambda = 3e4 * 0.4 / (1.4 * 0.2);
    by_lambda.mu = by_bulk.mu = mu;
    by_lambda.lambda = lambda;
    by_bulk.bulk = lambda + 2 * mu / 3;
    for (const auto& c : {by_lambda, by_bulk}) {
      const MaterialPtr m = model.make(c).value();
      CHECK(m->young() == Approx(3e4));
      CHECK(m->poisson() == Approx(0.4));
      CHECK(m->inverse_bulk() == Approx(model.make(by_young).value()->inverse_bulk()));
    }
    by_bulk.bulk = std::numeric_limits<double>::infinity();
    CHECK(model.make(by_bulk).value()->poisson() == 0.5);
    CHECK(model.make(by_bulk).value()->inverse_bulk() == 0);
    by_young.bulk_choice = BulkChoice::bulk_modulus;
    CHECK(model.make(by_young).value()->inverse_bulk() == Approx(3 * (1 - 0.8) / 3e4));
  }
}

TEST_CASE("bad constants are refused with name, value and remedy") {
  const double nan = std::nan("");
  const auto message = [](const test::ModelCase& model, const ElasticConstants& c) {
    const auto r = model.make(c);
    return r ? std::string("accepted") : r.error();
  };
  for (const auto& model : test::model_cases()) {
    if (!model.elastic_constants) continue;
    INFO(model.name);
    const auto young = [](double e, double nu) {
      ElasticConstants c;
      c.young = e;
      c.poisson = nu;
      return c;
    };
    CHECK_THAT(message(model, young(1e5, 0.6)),
               ContainsSubstring("0.6") && ContainsSubstring("0.5") && ContainsSubstring(model.name));
    CHECK_THAT(message(model, young(1e5, nan)), ContainsSubstring("nan") && ContainsSubstring("poisson"));
    CHECK_THAT(message(model, young(-3, 0.3)),
               ContainsSubstring("-3") && ContainsSubstring("young") && ContainsSubstring("positive"));
    CHECK_THAT(message(model, young(0, 0.3)), ContainsSubstring("young") && ContainsSubstring("positive"));
    CHECK_THAT(message(model, young(nan, 0.3)), ContainsSubstring("young") && ContainsSubstring("positive"));
    CHECK_THAT(message(model, young(std::numeric_limits<double>::infinity(), 0.3)),
               ContainsSubstring("young"));
    ElasticConstants both = young(1e5, 0.3);
    both.mu = 3;
    CHECK_THAT(message(model, both), ContainsSubstring("one pair"));
    ElasticConstants alone;
    alone.mu = 3;
    CHECK_THAT(message(model, alone), ContainsSubstring("exactly one of lambda and bulk"));
    alone.bulk = -2;
    CHECK_THAT(message(model, alone), ContainsSubstring("-2") && ContainsSubstring("positive"));
    alone.bulk = nan;
    CHECK_THAT(message(model, alone), ContainsSubstring("not a number"));
    alone.bulk = 1;
    alone.mu = nan;
    CHECK_THAT(message(model, alone), ContainsSubstring("nan") && ContainsSubstring("mu"));
  }
}
