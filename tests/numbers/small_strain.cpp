// Small uniaxial strain gives Young's modulus and Poisson's ratio back, whatever the formulation.
#include "numbers/cube.h"

using namespace isochor;
using namespace test;

namespace {

using Make = Result<MaterialPtr> (*)(const ElasticConstants&);

struct Measured {
  double stress, transverse;
};

Measured pull(Element element, const MaterialPtr& material, bool rows, double strain) {
  World world = make_world(static_options());
  const BodyId body = add_body(world, uneven_cube(), element, material);
  if (rows) add_volume(world, body);
  slide_on_axes(world, body);
  hold(world, body, {"x1"}, {{1, 0, 0}}, {strain, 0, 0});
  must_advance(world);
  return {world.fields(body).cell_stress[0], displacement_at(world, body, {1, 1, 1}).y};
}

}  // namespace

TEST_CASE("small strain gives E and nu back") {
  const std::pair<const char*, Make> materials[] = {
      {"neo_hookean", isochor::neo_hookean},
      {"stable_neo_hookean", isochor::stable_neo_hookean},
      {"stable_neo_hookean_barrier", isochor::stable_neo_hookean_barrier},
      {"isochoric_neo_hookean", isochor::isochoric_neo_hookean},
      {"corotated", isochor::corotated},
      {"stvk", isochor::stvk},
      {"mooney_rivlin",
       [](const ElasticConstants& c) {
         const double mu = c.young / (2 * (1 + c.poisson));
         return isochor::mooney_rivlin({0.3 * mu, 0.2 * mu, c.poisson});
       }},
      {"ogden", [](const ElasticConstants& c) {
         const double mu = c.young / (2 * (1 + c.poisson));
         return isochor::ogden({{{0.8 * mu, 1.3}, {-0.24 * mu, -4}}, c.poisson});
       }}};
  constexpr double young = 2.6e5, strain = 1e-4;
  for (const auto& [name, make] : materials) {
    for (const double nu : {0.0, 0.1, 0.3, 0.45, 0.49, 0.499, 0.4999, 0.5}) {
      ElasticConstants constants;
      constants.young = young;
      constants.poisson = nu;
      const MaterialPtr material = value(make(constants));
      for (const bool rows : {true, false}) {
        if (!rows && nu == 0.5) continue;
        for (const Element element : kElements) {
          INFO(name << ", nu = " << nu << ", " << name_of(element) << (rows ? ", mixed" : ", one field"));
          // Both signs, so that the error is of second order in the strain.
          const Measured tension = pull(element, material, rows, strain),
                         pressing = pull(element, material, rows, -strain);
          CHECK((tension.stress - pressing.stress) / (2 * strain) == Approx(young).epsilon(2e-6));
          CHECK(-(tension.transverse - pressing.transverse) / (2 * strain) == Approx(nu).margin(1e-6));
        }
      }
    }
  }
}
