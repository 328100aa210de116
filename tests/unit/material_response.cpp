// The states that the pictures of the materials show, against closed forms.
#include "bench/material_response.h"

#include "support/worlds.h"

using namespace isochor;
using test::neo_hookean;
using test::value;

TEST_CASE("homogeneous states of the pictures are those of the closed forms") {
  const auto block = *response::Block::of(*neo_hookean(3, 0.5));
  REQUIRE(block.incompressible);
  for (const double stretch : {0.5, 1.25, 2.0, 3.0}) {
    double side = 1;
    // Nominal: the Cauchy stress over the stretch.
    CHECK(response::uniaxial(block, stretch, side) == Approx(stretch - 1 / (stretch * stretch)));
    CHECK(side == Approx(1 / std::sqrt(stretch)));
    CHECK(response::equibiaxial(block, stretch, side) == Approx(stretch - std::pow(stretch, -5)));
  }
  CHECK(response::simple_shear(block, 0.7) == Approx(0.7));
}

TEST_CASE("compressible states are free of stress where nothing holds them") {
  ElasticConstants c;
  // The reference has mu/2 (I - 3) - mu log J with rows of kappa = K = 2.1666...: as a complete energy that
  // is Ogden's with lambda = K.
  c.mu = 1;
  c.lambda = 2 + 1.0 / 6;
  const auto block = *response::Block::of(*value(neo_hookean_ogden(c)));
  REQUIRE(!block.incompressible);
  double side = 1;
  const double nominal = response::uniaxial(block, 2, side);
  CHECK(side == Approx(0.76331492555856).epsilon(1e-10));
  CHECK(nominal / (side * side) == Approx(2.932594376728146).epsilon(1e-10));
  // Small strain gives the bulk modulus K = lambda + 2 mu / 3.
  CHECK(response::volumetric(block, 1 + 1e-6) / 1e-6 == Approx(c.lambda + 2.0 / 3).epsilon(1e-5));
  side = 1;
  const double small = response::equibiaxial(block, 1 + 1e-6, side) / 1e-6;
  const double nu = c.lambda / (2 * (c.lambda + 1)), young = 2 * (1 + nu);
  CHECK(small == Approx(young / (1 - nu)).epsilon(1e-5));
}
