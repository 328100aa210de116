#include "studies/fit/law.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "engine/elements/material_model.h"

namespace isochor::fit {

namespace {

using Json = nlohmann::ordered_json;
using Values = std::vector<double>;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Json of(const char* law) {
  return {{"law", law}, {"poisson", 0.5}};
}

Law neo_hookean() {
  return {"neo_hookean",
          {{"mu", "Pa", 0, kInfinity}},
          [](double mu, double) { return std::vector<Values>{{mu}}; },
          [](const Values& v) {
            Json keys = of("neo_hookean");
            keys["young"] = 3 * v[0];
            return keys.dump();
          }};
}

Law mooney_rivlin(int terms) {
  Law law{"mooney_rivlin_" + std::to_string(terms), {}, {}, {}};
  const std::array<const char*, 5> names{"c1", "c2", "c20", "c11", "c02"};
  for (int i = 0; i < terms; ++i)
    law.constants.push_back({names[static_cast<std::size_t>(i)], "Pa", -kInfinity, kInfinity});
  law.starts = [terms](double mu, double) {
    Values start(static_cast<std::size_t>(terms), 0.0);
    start[0] = 0.4 * mu;
    start[1] = 0.1 * mu;
    return std::vector<Values>{start};
  };
  law.keys = [names](const Values& v) {
    Json keys = of("mooney_rivlin");
    for (std::size_t i = 0; i < v.size(); ++i) keys[names[i]] = v[i];
    return keys.dump();
  };
  return law;
}

Law yeoh(int terms) {
  Law law{"yeoh_" + std::to_string(terms), {}, {}, {}};
  for (int i = 0; i < terms; ++i)
    law.constants.push_back({"c[" + std::to_string(i) + "]", "Pa", i == 0 ? 0 : -kInfinity, kInfinity});
  law.starts = [terms](double mu, double) {
    Values start(static_cast<std::size_t>(terms), 0.0);
    start[0] = mu / 2;
    return std::vector<Values>{start};
  };
  law.keys = [](const Values& v) {
    Json keys = of("yeoh");
    keys["c"] = v;
    return keys.dump();
  };
  return law;
}

// Searched for are the parts of the shear modulus, mu alpha/2, which are positive in a stable law, and the
// exponents; several starts, since the problem has several minima.
Law ogden(int terms) {
  Law law{"ogden_" + std::to_string(terms), {}, {}, {}};
  for (int i = 0; i < terms; ++i) {
    const std::string term = "terms[" + std::to_string(i) + "].";
    law.constants.push_back({term + "mu*alpha/2", "Pa", 0, kInfinity});
    law.constants.push_back({term + "alpha", "", -30, 30, true});
  }
  law.starts = [terms](double mu, double) {
    std::vector<Values> all;
    for (const std::array<double, 3>& exponents : std::initializer_list<std::array<double, 3>>{
             {2, -2, 6}, {1.5, 5, -2}, {4, -2, 1}, {1.2, 8, 3}, {3, -4, 10}, {1.5, 3, 15}}) {
      Values start;
      for (int i = 0; i < terms; ++i) {
        start.push_back(mu * std::pow(0.1, i));
        start.push_back(exponents[static_cast<std::size_t>(i)]);
      }
      all.push_back(start);
    }
    return all;
  };
  law.keys = [](const Values& v) {
    Json keys = of("ogden");
    keys["terms"] = Json::array();
    for (std::size_t i = 0; i < v.size(); i += 2)
      keys["terms"].push_back({{"mu", 2 * v[i] / v[i + 1]}, {"alpha", v[i + 1]}});
    return keys.dump();
  };
  return law;
}

Law gent() {
  return {"gent",
          {{"mu", "Pa", 0, kInfinity}, {"jm", "", 1e-3, 1e6}},
          [](double mu, double largest) {
            return std::vector<Values>{{mu, 1.2 * largest + 1}, {mu, 10 * largest + 1}};
          },
          [](const Values& v) {
            Json keys = of("gent");
            keys["mu"] = v[0];
            keys["jm"] = v[1];
            return keys.dump();
          }};
}

Law arruda_boyce() {
  return {"arruda_boyce",
          {{"mu", "Pa", 0, kInfinity}, {"locking_stretch", "", 1.0, 1e3}},
          [](double mu, double largest) {
            const double chain = std::sqrt(largest / 3 + 1);
            return std::vector<Values>{{mu, 1.1 * chain}, {mu, 4 * chain}};
          },
          [](const Values& v) {
            Json keys = of("arruda_boyce");
            keys["mu"] = v[0];
            keys["locking_stretch"] = v[1];
            return keys.dump();
          }};
}

}  // namespace

const std::vector<Law>& laws() {
  static const std::vector<Law> all{neo_hookean(), mooney_rivlin(2), mooney_rivlin(3), mooney_rivlin(5),
                                    yeoh(2),       yeoh(3),          ogden(1),         ogden(2),
                                    ogden(3),      gent(),           arruda_boyce()};
  return all;
}

Result<const Law*> find_law(const std::string& name) {
  std::string known;
  for (const Law& law : laws()) {
    if (law.name == name) return &law;
    known += (known.empty() ? "" : ", ") + law.name;
  }
  return Error{"--law " + name + ": there is no such law to fit; there are " + known};
}

namespace {

// Stretches along x, y, z; z is free, and no volume is lost.
std::array<double, 3> block(Mode mode, double stretch) {
  const double y =
      mode == Mode::uniaxial ? 1 / std::sqrt(stretch) : (mode == Mode::equibiaxial ? stretch : 1.0);
  return {stretch, y, 1 / (stretch * y)};
}

}  // namespace

std::vector<double> stresses(const MaterialModel& material, Mode mode, std::span<const double> stretches) {
  const auto energy = material.distortional();
  constexpr auto lanes = static_cast<std::size_t>(kLanes);
  std::vector<double> out(stretches.size());
  PointBatch batch{};
  ResponseBatch response;
  for (std::size_t first = 0; first < stretches.size(); first += lanes) {
    // The last batch repeats its last point.
    const auto of_lane = [&](std::size_t l) {
      return block(mode, stretches[std::min(first + l, stretches.size() - 1)]);
    };
    for (std::size_t l = 0; l < lanes; ++l) {
      for (std::size_t i = 0; i < 3; ++i) batch.F[4 * i][l] = of_lane(l)[i];
    }
    energy->evaluate(Want::gradient, batch, response);
    for (std::size_t l = 0; l < lanes && first + l < out.size(); ++l) {
      const std::array<double, 3> s = of_lane(l);
      // P - q F^-T, with the pressure q that frees z.
      out[first + l] = std::isfinite(response.psi[l]) ? response.P[0][l] - response.P[8][l] * s[2] / s[0]
                                                      : std::numeric_limits<double>::quiet_NaN();
    }
  }
  return out;
}

double stress(const MaterialModel& material, Mode mode, double stretch) {
  return stresses(material, mode, {&stretch, 1}).front();
}

double first_invariant(Mode mode, double stretch) {
  const auto [x, y, z] = block(mode, stretch);
  return x * x + y * y + z * z - 3;
}

}  // namespace isochor::fit
