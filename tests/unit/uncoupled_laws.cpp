// Laws of invariants and stretches against closed forms of homogeneous states, in the constants of other
// codes.
#include "bench/material_response.h"
#include "engine/elements/volume_strain.h"
#include "support/worlds.h"

using namespace isochor;
using test::value;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// dW/dI and dW/dII at a stretch of a block that keeps its volume.
using Slopes = std::function<std::array<double, 2>(double I, double II)>;

void check_incompressible(const char* name, const MaterialPtr& material, const Slopes& slopes,
                          double largest) {
  INFO(name);
  const auto block = *response::Block::of(*material);
  REQUIRE(block.incompressible);
  for (const double s : {0.6, 1 + 1e-6, 1.3, 0.5 * (1 + largest), largest}) {
    INFO("stretch " << s);
    double side = 1;
    const double s2 = s * s;
    const auto uniaxial = slopes(s2 + 2 / s, 2 * s + 1 / s2);
    const double pulled = 2 * (s - 1 / s2) * (uniaxial[0] + uniaxial[1] / s);
    CHECK(response::uniaxial(block, s, side) == Approx(pulled).epsilon(1e-9));
    const auto equal = slopes(2 * s2 + 1 / (s2 * s2), s2 * s2 + 2 / s2);
    const double spread = 2 * (s - std::pow(s, -5)) * (equal[0] + s2 * equal[1]);
    CHECK(response::equibiaxial(block, s, side) == Approx(spread).epsilon(1e-9));
  }
  const auto sheared = slopes(3 + 0.49, 3 + 0.49);
  CHECK(response::simple_shear(block, 0.7) == Approx(2 * 0.7 * (sheared[0] + sheared[1])).epsilon(1e-12));
}

VolumePart incompressible(VolumeEnergy energy = VolumeEnergy::quadratic) {
  return {energy, kInfinity};
}

}  // namespace

TEST_CASE("incompressible blocks answer pulls as the closed forms of each law say") {
  for (const bool isochoric : {false, true}) {
    for (const auto energy : {VolumeEnergy::quadratic, VolumeEnergy::logarithmic, VolumeEnergy::mixed}) {
      const VolumePart v = incompressible(energy);
      const auto pick = [&](auto full, auto iso, const auto& constants) {
        return value(isochoric ? iso(constants) : full(constants));
      };
      check_incompressible(
          "mooney_rivlin",
          pick(mooney_rivlin, isochoric_mooney_rivlin,
               MooneyRivlinConstants{3e4, 1e4, 0.5, 2e3, -1e3, 5e2, v}),
          [](double I, double II) {
            const double x = I - 3, y = II - 3;
            return std::array{3e4 + 4e3 * x - 1e3 * y, 1e4 - 1e3 * x + 1e3 * y};
          },
          2.5);
      // Ecoflex as fitted with a negative second coefficient.
      check_incompressible(
          "yeoh", pick(yeoh, isochoric_yeoh, YeohConstants{{17e3, -200, 23}, 0.5, v}),
          [](double I, double) {
            const double x = I - 3;
            return std::array{17e3 - 400 * x + 69 * x * x, 0.0};
          },
          4);
      check_incompressible(
          "fung", pick(fung, isochoric_fung, FungConstants{1e3, 0.8, 4e3, 0.5, v}),
          [](double I, double) {
            return std::array{0.5e3 + 2e3 * 0.8 * std::exp(0.8 * (I - 3)), 0.0};
          },
          2);
      check_incompressible(
          "gent", pick(gent, isochoric_gent, GentConstants{2e4, 30, 0.5, v}),
          [](double I, double) {
            return std::array{1e4 / (1 - (I - 3) / 30), 0.0};
          },
          3);
      check_incompressible(
          "veronda_westmann",
          pick(veronda_westmann, isochoric_veronda_westmann, VerondaWestmannConstants{2e4, 0.6, 0.5, v}),
          [](double I, double) {
            return std::array{1.2e4 * std::exp(0.6 * (I - 3)), -0.6e4};
          },
          2);
      // FEBio's mu and N, Abaqus's mu and lambda_m = sqrt N.
      const double N = 9;
      check_incompressible(
          "arruda_boyce",
          pick(arruda_boyce, isochoric_arruda_boyce,
               ArrudaBoyceConstants{2e4, 0, 0, 0.5, 0, 0, std::sqrt(N), v}),
          [=](double I, double) {
            const double f = I / N;
            return std::array{2e4 * (1.0 / 2 + 2.0 / 20 * f + 33.0 / 1050 * f * f + 76.0 / 7000 * f * f * f +
                                     5 * 519.0 / 673750 * f * f * f * f),
                              0.0};
          },
          2.5);
    }
  }
  check_incompressible(
      "isochoric_holmes_mow", value(isochoric_holmes_mow({1e4, 0.5, 0.5, incompressible()})),
      [](double I, double) {
        return std::array{0.5e4 * std::exp(0.5 * (I - 3)), 0.0};
      },
      2);
}

TEST_CASE("the series of Arruda and Boyce as FEBio 4 has it is that of betas times i") {
  const double N = 7, mu = 1.5e4;
  const double b[] = {1 / (5 * N), 11 / (175 * N * N), 19 / (875 * N * N * N), 519 / (67375 * N * N * N * N)};
  const auto m =
      value(isochoric_arruda_boyce({mu, 2 * b[0], 3 * b[1], 0.5, 4 * b[2], 5 * b[3], 0, incompressible()}));
  check_incompressible(
      "FEBio 4", m,
      [=](double I, double) {
        constexpr double a[] = {0.5, 0.1, 11.0 / 350, 19.0 / 1750, 519.0 / 134750};
        const double f = I / N;
        return std::array{
            mu * (a[0] + 2 * a[1] * f + 3 * a[2] * f * f + 4 * a[3] * f * f * f + 5 * a[4] * f * f * f * f),
            0.0};
      },
      2.5);
}

TEST_CASE("Ogden blocks answer as the sums over stretches say, in FEBio's and Abaqus's constants") {
  // FEBio: c/m^2 (sum - 3); Abaqus: 2 mu/alpha^2 (sum - 3).
  const double c1 = 1e4, m1 = 3, mu2 = 2e3, alpha2 = -2.5;
  OgdenConstants o{{{c1 / m1, m1}, {2 * mu2 / alpha2, alpha2}}, 0.5, incompressible()};
  for (const bool isochoric : {false, true}) {
    const auto block = *response::Block::of(*value(isochoric ? isochoric_ogden(o) : ogden(o)));
    for (const double s : {0.5, 1 + 1e-6, 1.7, 3.0}) {
      const auto term = [&](double power) {
        return c1 / m1 * std::pow(s, power * m1) + 2 * mu2 / alpha2 * std::pow(s, power * alpha2);
      };
      double side = 1;
      CHECK(response::uniaxial(block, s, side) == Approx((term(1) - term(-0.5)) / s).epsilon(1e-9));
      CHECK(response::equibiaxial(block, s, side) == Approx((term(1) - term(-2)) / s).epsilon(1e-9));
    }
  }
}

TEST_CASE("the pressure of an isochoric law is that of its U(J) and nothing else") {
  const double bulk = 7e4;
  for (const auto energy : {VolumeEnergy::quadratic, VolumeEnergy::logarithmic, VolumeEnergy::mixed}) {
    const VolumePart v{energy, bulk};
    const MaterialPtr laws[] = {value(isochoric_mooney_rivlin({3e4, 1e4, 0.5, 1e3, 1e3, 1e3, v})),
                                value(isochoric_yeoh({{2e4, 1e3}, 0.5, v})),
                                value(isochoric_fung({1e3, 2, 1e4, 0.5, v})),
                                value(isochoric_arruda_boyce({2e4, 0, 0, 0.5, 0, 0, 3, v})),
                                value(isochoric_gent({2e4, 20, 0.5, v})),
                                value(isochoric_veronda_westmann({2e4, 2, 0.5, v})),
                                value(isochoric_holmes_mow({2e4, 2, 0.5, v})),
                                value(isochoric_ogden({{{1e4, 2}, {1e2, 8}}, 0.5, v}))};
    for (const MaterialPtr& m : laws) {
      INFO(m->name() << ", U " << static_cast<int>(energy));
      CHECK(1 / m->inverse_bulk() == Approx(bulk));
      const response::Block block{value(m->complete()), false};
      for (const double J : {0.6, 0.99, 1.4}) {
        const double p = energy == VolumeEnergy::quadratic     ? bulk * (J - 1)
                         : energy == VolumeEnergy::logarithmic ? bulk * std::log(J) / J
                                                               : bulk / 2 * (J - 1 / J);
        CHECK(response::volumetric(block, J) == Approx(p).epsilon(1e-10).margin(1e-9 * bulk));
      }
    }
  }
}

TEST_CASE("coupled laws are those of FEBio") {
  // c1 (I - 3) + c2 (II - 3) - 2 (c1 + 2 c2) log J + k/2 log^2 J, and Veronda-Westmann with k/2 log^2 J: the
  // stress of a block of sides a, b, c.
  const double c1 = 2e4, c2 = 0.7e4, k = 9e4, a = 1.3, b = 0.9, c = 1.05, J = a * b * c;
  const response::Point p = response::evaluate(
      *value(value(mooney_rivlin({c1, c2, 0.5, 0, 0, 0, {VolumeEnergy::logarithmic, k}}))->complete()),
      {a, 0, 0, 0, b, 0, 0, 0, c});
  CHECK(p.P[0] == Approx(2 * a * (c1 + c2 * (b * b + c * c)) - 2 * (c1 + 2 * c2) / a + k * std::log(J) / a));
  const double d2 = 0.4;
  const response::Point q = response::evaluate(
      *value(value(veronda_westmann({c1, d2, 0.5, {VolumeEnergy::logarithmic, k}}))->complete()),
      {a, 0, 0, 0, b, 0, 0, 0, c});
  const double e = std::exp(d2 * (a * a + b * b + c * c - 3));
  CHECK(q.P[0] == Approx(2 * a * c1 * d2 * (e - 0.5 * (b * b + c * c)) + k * std::log(J) / a));
}

TEST_CASE("strains of volume rows are those whose squares the volume parts are, with all digits at rest") {
  for (const double d : {-0.7, -0.3, -0.0626, -0.0624, -1e-3, -1e-9, 0.0, 1e-9, 0.0624, 0.0626, 0.5, 3.0}) {
    INFO("J - 1 = " << d);
    const VolumeResponse r = volume_response(VolumeStrain::mixed, d);
    const double J = 1 + d;
    CHECK(0.5 * r.value * r.value == Approx(0.25 * (d * (2 + d) - 2 * std::log1p(d))).margin(1e-16));
    CHECK(r.value * r.first == Approx(0.5 * d * (2 + d) / J));
    CHECK(r.first * r.first + r.value * r.second == Approx(0.5 * (1 + 1 / (J * J))));
    if (std::abs(d) < 1e-6) CHECK(r.value == Approx(d).epsilon(1e-8));
  }
  // Derivatives at rest: Phi = d - d^2/6 + ...
  CHECK(volume_response(VolumeStrain::mixed, 0).first == 1);
  CHECK(volume_response(VolumeStrain::mixed, 0).second == Approx(-1.0 / 3));
}

TEST_CASE(
    "laws that are unstable at some stretch are accepted, with the stretches at which they are stable") {
  CHECK(value(isochoric_yeoh({{17e3, 200, 23}, 0.5}))->warnings().empty());
  // dP/ds of W = c1 x + c2 x^2 with c2 < 0 falls; Drucker's range in closed form for uniaxial stretch:
  // d tau/d log s = 2 W' (2 s^2 + 1/s) + 4 W'' (s^2 - 1/s)^2 = 0, tau = 2 W' (s^2 - 1/s).
  const double c1 = 1e4, c2 = -300;
  const auto m = value(isochoric_yeoh({{c1, c2}, 0.5}));
  REQUIRE(m->warnings().size() == 1);
  const std::string text = m->warnings().front();
  double low = 1, high = 10;
  for (int i = 0; i < 60; ++i) {
    const double s = 0.5 * (low + high), x = s * s + 2 / s - 3, q = s * s - 1 / s;
    const double slope = 2 * (c1 + 2 * c2 * x) * (2 * s * s + 1 / s) + 8 * c2 * q * q;
    (slope > 0 ? low : high) = s;
  }
  char end[20];
  std::snprintf(end, sizeof end, "%.4g", low);
  INFO(text << "; by hand " << end);
  CHECK_THAT(text, ContainsSubstring("uniaxial stretch from") && ContainsSubstring(std::string("to ") + end));
  CHECK_THAT(text, ContainsSubstring("equibiaxial") && ContainsSubstring("pure shear"));
  // The world passes it on, with body and region; also through what is put around the law.
  FiberFamily f;
  f.k1 = 1;
  World world = test::make_world(test::static_options());
  const BodyId body = test::add_body(world, test::box({1, 1, 1}), Element::tet4,
                                     value(with_fibers(value(isochoric_yeoh({{c1, c2}, 0.3})), {f})));
  test::hold(world, body, {"x0"});
  value(world.compile());
  REQUIRE(world.warnings().size() == 1);
  CHECK_THAT(world.warnings().front(), ContainsSubstring("body \"") && ContainsSubstring(end));
}

TEST_CASE("what no material can be is refused with constant, value and remedy") {
  const auto refusal = [](const Result<MaterialPtr>& r) { return r ? std::string("accepted") : r.error(); };
  CHECK_THAT(refusal(yeoh({{}, 0.5})), ContainsSubstring("c is empty"));
  CHECK_THAT(refusal(isochoric_yeoh({{-1, 2}, 0.5})), ContainsSubstring("isochoric_yeoh") &&
                                                          ContainsSubstring("2 c[0] = -2") &&
                                                          ContainsSubstring("positive"));
  CHECK_THAT(refusal(isochoric_gent({1, 0, 0.5})), ContainsSubstring("jm = 0"));
  CHECK_THAT(refusal(gent({-1, 10, 0.5})), ContainsSubstring("mu = -1"));
  CHECK_THAT(refusal(veronda_westmann({1, 0, 0.5})), ContainsSubstring("c2 = 0"));
  CHECK_THAT(refusal(isochoric_holmes_mow({1, -1, 0.5})), ContainsSubstring("beta = -1"));
  CHECK_THAT(refusal(holmes_mow({1, 1, 0.4, {VolumeEnergy::mixed, -1}})),
             ContainsSubstring("no volume part"));
  CHECK_THAT(refusal(arruda_boyce({1, 0.1, 0, 0.5, 0, 0, 3})),
             ContainsSubstring("beta1 = 0.1") && ContainsSubstring("locking_stretch = 3"));
  CHECK_THAT(refusal(arruda_boyce({1, 0, 0, 0.5, 0, 0, -3})), ContainsSubstring("locking_stretch = -3"));
  CHECK_THAT(refusal(isochoric_yeoh({{1}, 0.5, {VolumeEnergy::mixed, -5}})), ContainsSubstring("bulk = -5"));
  CHECK_THAT(refusal(isochoric_yeoh({{1}, 0.3, {VolumeEnergy::mixed, 5}})),
             ContainsSubstring("poisson = 0.3") && ContainsSubstring("bulk = 5"));
  CHECK_THAT(refusal(named_material("Ecoflex")),
             ContainsSubstring("\"Ecoflex\"") && ContainsSubstring("ecoflex_00_30_data_sheet"));
  const auto law = [](double nu) { return holmes_mow({1, 1, nu}); };
  CHECK_THAT(refusal(with_poisson_field(law, {0.3, 0.4})),
             ContainsSubstring("holmes_mow") && ContainsSubstring("region"));
}

TEST_CASE("all named materials can be made, and say who states their numbers") {
  for (const NamedMaterial& m : named_materials()) {
    INFO(m.name);
    CHECK(m.year >= 1940);
    CHECK(m.source.size() > 20);
    CHECK(m.description.size() > 20);
    CHECK(value(named_material(m.name))->inverse_bulk() == 0);
    CHECK(value(named_material(m.name, 0.45))->poisson() == Approx(0.45));
    CHECK(value(named_material(m.name))->warnings().empty());
  }
}
