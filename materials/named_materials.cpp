// Materials by name. Every number here is one that the source states; none is fitted here.
#include <cmath>

#include "engine/base/text.h"
#include "isochor/materials.h"

namespace isochor {

namespace {

constexpr double kPsi = 6894.757;  // [Pa]

// Data sheets of casting silicones state a "100 % modulus": the nominal stress at twice the length. The one
// law with one constant that it determines is neo-Hookean, P = mu (s - 1/s^2).
NamedMaterial by_stress_at_double_length(const char* name, const char* product, double psi,
                                         double specific_gravity) {
  const double mu = psi * kPsi / (2 - 0.25);
  NamedMaterial m;
  m.name = std::string(name) + "_data_sheet";
  m.description = std::string(product) +
                  ": isochoric, W = mu/2 (I - 3) with the stress at twice the length, " + number(psi) +
                  " psi, that is mu = " + number(mu) + " Pa; good to about that stretch";
  m.source = std::string("Smooth-On, Inc., technical bulletin of ") + product + ", 100 % modulus (ASTM D412)";
  m.year = 2018;
  m.density = 1000 * specific_gravity;
  m.make = [mu](double poisson) { return isochoric_yeoh({{mu / 2}, poisson}); };
  return m;
}

// The same law through a measured stress at twice the length [Pa].
NamedMaterial by_measured_stress(const char* name, const char* product, double stress) {
  const double mu = stress / (2 - 0.25);
  NamedMaterial m;
  m.name = std::string(name) + "_marechal";
  m.description = std::string(product) +
                  ": isochoric, W = mu/2 (I - 3) with the measured stress at twice the length, " +
                  number(stress) + " Pa, that is mu = " + number(mu) + " Pa; good to about that stretch";
  m.source =
      "L. Marechal et al., Toward a common framework and database of materials for soft robotics, Soft "
      "Robotics (2020), doi 10.1089/soro.2019.0115, pull test (ASTM D412, first loading); Open Database "
      "License 1.0";
  m.year = 2020;
  m.make = [mu](double poisson) { return isochoric_yeoh({{mu / 2}, poisson}); };
  return m;
}

std::vector<NamedMaterial> make_list() {
  std::vector<NamedMaterial> list = {
      by_stress_at_double_length("ecoflex_00_10", "Ecoflex 00-10", 8, 1.04),
      by_stress_at_double_length("ecoflex_00_20", "Ecoflex 00-20", 8, 1.07),
      by_stress_at_double_length("ecoflex_00_30", "Ecoflex 00-30", 10, 1.07),
      by_stress_at_double_length("ecoflex_00_50", "Ecoflex 00-50", 12, 1.07),
      by_stress_at_double_length("dragon_skin_10", "Dragon Skin 10", 22, 1.07),
      by_stress_at_double_length("dragon_skin_20", "Dragon Skin 20", 49, 1.08),
      by_stress_at_double_length("dragon_skin_30", "Dragon Skin 30", 86, 1.08),
      by_stress_at_double_length("smooth_sil_950", "Smooth-Sil 950", 272, 1.24),
      by_measured_stress("ecoflex_00_10", "Ecoflex 00-10", 14.79e3),
      by_measured_stress("ecoflex_00_30", "Ecoflex 00-30", 29.72e3),
      by_measured_stress("dragon_skin_10", "Dragon Skin 10 Medium", 112.96e3),
      by_measured_stress("dragon_skin_20", "Dragon Skin 20", 318.36e3),
  };
  NamedMaterial m;
  m.name = "elastosil_m4601_mosadegh";
  m.description = "Elastosil M4601 of pneumatic actuators: isochoric, Yeoh, c = 0.11 MPa, 0.02 MPa";
  m.source =
      "B. Mosadegh et al., Pneumatic networks for soft robotics that actuate rapidly, Advanced Functional "
      "Materials 24 (2014) 2163-2170, doi 10.1002/adfm.201303288";
  m.year = 2014;
  m.density = 1130;
  m.make = [](double poisson) { return isochoric_yeoh({{0.11e6, 0.02e6}, poisson}); };
  list.push_back(m);

  m.name = "natural_rubber_treloar_ogden";
  m.description =
      "vulcanized natural rubber, 8 phr sulfur, of Treloar's experiments: isochoric, Ogden, mu = 0.63, "
      "0.0012, "
      "-0.01 MPa, alpha = 1.3, 5, -2; to stretches of about 7";
  m.source =
      "R. W. Ogden, Large deformation isotropic elasticity, Proc. R. Soc. Lond. A 326 (1972) 565-584, doi "
      "10.1098/rspa.1972.0026, fit of the data of L. R. G. Treloar, Trans. Faraday Soc. 40 (1944) 59-70";
  m.year = 1972;
  m.density = 0;
  m.make = [](double poisson) {
    return isochoric_ogden(
        {{{0.63e6, 1.3}, {0.0012e6, 5}, {-0.01e6, -2}}, poisson, {VolumeEnergy::quadratic, -1}});
  };
  list.push_back(m);

  m.name = "natural_rubber_treloar_arruda_boyce";
  m.description =
      "the same rubber: isochoric, Arruda-Boyce by its series, mu = 0.27 MPa, chains of 26.5 links; to "
      "stretches of about 5, where the series leaves the full law";
  m.source =
      "E. M. Arruda, M. C. Boyce, A three-dimensional constitutive model for the large stretch behavior of "
      "rubber elastic materials, J. Mech. Phys. Solids 41 (1993) 389-412, doi 10.1016/0022-5096(93)90013-6";
  m.year = 1993;
  m.make = [](double poisson) {
    return isochoric_arruda_boyce({.mu = 0.27e6, .poisson = poisson, .locking_stretch = std::sqrt(26.5)});
  };
  list.push_back(m);

  m.name = "pdms_sylgard_184_cured_at_25";
  m.description =
      "Sylgard 184, 10:1, cured at 25 degrees C: isochoric, W = E/6 (I - 3) with Young's modulus E = 1.32 "
      "MPa; "
      "to strains of about 0.4";
  m.source =
      "I. D. Johnston, D. K. McCluskey, C. K. L. Tan, M. C. Tracey, Mechanical characterization of bulk "
      "Sylgard 184 for microfluidics and microengineering, J. Micromech. Microeng. 24 (2014) 035017, doi "
      "10.1088/0960-1317/24/3/035017";
  m.year = 2014;
  m.make = [](double poisson) { return isochoric_yeoh({{1.32e6 / 6}, poisson}); };
  list.push_back(m);

  m.name = "tpu_ninjaflex_data_sheet";
  m.description =
      "NinjaFlex thermoplastic polyurethane, printed: isochoric, W = E/6 (I - 3) with the tensile modulus E "
      "= "
      "12 MPa; small strains";
  m.source = "NinjaTek, NinjaFlex 3D printing filament, technical data sheet (ASTM D638)";
  m.year = 2016;
  m.density = 1190;
  m.make = [](double poisson) { return isochoric_yeoh({{12e6 / 6}, poisson}); };
  list.push_back(m);
  return list;
}

}  // namespace

const std::vector<NamedMaterial>& named_materials() {
  static const std::vector<NamedMaterial> list = make_list();
  return list;
}

Result<MaterialPtr> named_material(const std::string& name, double poisson) {
  std::string known;
  for (const NamedMaterial& m : named_materials()) {
    if (m.name == name) return m.make(poisson);
    known += (known.empty() ? "" : ", ") + m.name;
  }
  return Error{"named: there is no material named \"" + name + "\"; there are " + known};
}

}  // namespace isochor
