// What the tests of gradients have in common: parameters of the hollow block with their knobs, differences of
// scenes that are built anew, and the comparison of all with all.
#pragma once

#include <functional>

#include "isochor/gradients.h"
#include "support/hollow_block.h"

namespace test {

using isochor::GradientQuery;
using isochor::Gradients;
using isochor::Output;
using isochor::Parameter;

// A parameter, and where in the knobs it is.
struct Asked {
  std::string name;
  Parameter parameter;
  double Knobs::*knob;
};

inline Parameter cable_stiffness(const Block& block) {
  return Parameter::constant_of(block.cable, block.knobs.spring,
                                [k = block.knobs, kind = block.kind](double v) {
                                  Knobs other = k;
                                  other.spring = v;
                                  return isochor::cable(cable_of(other, kind));
                                });
}

// But the velocity at the start, which an equilibrium has none of.
inline std::vector<Asked> parameters_of(const Block& block) {
  const Knobs k = block.knobs;
  std::vector<Asked> out{
      {"amount of a support", Parameter::amount_of(block.clamp), &Knobs::clamp},
      {"force", Parameter::force_at(block.body, kPushed, kPush), &Knobs::push},
      {"gravity", Parameter::gravity({0, 0, 1}), &Knobs::gravity},
      {"density", Parameter::density(block.body), &Knobs::density},
      {"Young's modulus",
       Parameter::material(block.body, "", k.young, [k](double v) { return material_of(v, k.poisson, k); }),
       &Knobs::young},
      {"Poisson's ratio",
       Parameter::material(block.body, "", k.poisson, [k](double v) { return material_of(k.young, v, k); }),
       &Knobs::poisson},
      {"stiffness", Parameter::stiffness(block.body), &Knobs::stiffness},
      {"shape", Parameter::shape(block.body, shape_motion(block.world.mesh(block.body))), &Knobs::shape}};
  if (k.ratio > 0) {
    // Factors on the stiffness of what remembers are refused.
    std::erase_if(out, [](const Asked& a) { return a.name == "stiffness"; });
    for (double Knobs::*const knob : {&Knobs::ratio, &Knobs::fades}) {
      const auto law = [k, knob](double v) {
        Knobs other = k;
        other.*knob = v;
        return material_of(k.young, k.poisson, other);
      };
      out.push_back({knob == &Knobs::ratio ? "share that relaxes" : "time of relaxation",
                     Parameter::material(block.body, "", k.*knob, law), knob});
    }
  }
  const isochor::Curve curve = cavity_curve(k, block.kind);
  if (!block.kind.changing)
    out.push_back({"amount of a cavity", Parameter::amount_of(block.cavity), &Knobs::cavity});
  out.push_back({"first point of its curve", Parameter::curve_point(block.cavity, curve, 0), &Knobs::cavity});
  if (block.kind.changing)
    out.push_back(
        {"second point of its curve", Parameter::curve_point(block.cavity, curve, 1), &Knobs::late});
  if (block.kind.pulled) {
    out.push_back({"amount of a cable", Parameter::amount_of(block.cable), &Knobs::cable});
    out.push_back({"stiffness of the cable", cable_stiffness(block), &Knobs::spring});
  }
  if (k.viscosity > 0) {
    out.push_back({"viscosity",
                   Parameter::constant_of(block.damping, k.viscosity,
                                          [k](double v) {
                                            Knobs other = k;
                                            other.viscosity = v;
                                            return isochor::damping(damping_of(other));
                                          }),
                   &Knobs::viscosity});
  }
  return out;
}

// What is read off a scene at an equilibrium, or at the end of an increment.
inline std::vector<std::pair<std::string, Output>> measures_of(const Block& block) {
  const auto cell = static_cast<Index>(block.world.mesh(block.body).cell_count() / 2);
  std::vector<std::pair<std::string, Output>> out{
      {"volume", Output::gauge(block.cavity, "volume")},
      {"pressure", Output::gauge(block.cavity, "pressure")},
      {"reaction", Output::reaction(block.clamp, {1, 0.5, -0.2}, {0.1, 0.2, 0.3})},
      {"von Mises", Output::stress(block.body, cell, "von_mises")},
      {"mean stress", Output::stress(block.body, cell, "pressure")},
      {"shear stress", Output::stress(block.body, cell, "zx")}};
  for (const char* part : {"elastic", "gravity", "loads", "pressures", "potential"})
    out.emplace_back(std::string("energy, ") + part, Output::energy(part));
  if (!block.kind.pulled) return out;
  out.emplace_back("tension", Output::gauge(block.cable, "tension"));
  out.emplace_back("length", Output::gauge(block.cable, "length"));
  out.emplace_back("force of the cable", Output::effect_force(block.cable, block.body, {1, 0.3, 0.5}));
  return out;
}

// A function of a host: the sum of squares of all distances from the first node.
inline Output spread(BodyId body) {
  return Output::of_positions(body, [](std::span<const Vec3> x, std::span<Vec3> gradient) {
    double sum = 0;
    for (std::size_t i = 1; i < x.size(); ++i) {
      const Vec3 off = x[i] - x[0];
      sum += dot(off, off);
      gradient[i] = 2.0 * off;
      gradient[0] -= 2.0 * off;
    }
    return isochor::Result<double>(sum);
  });
}

using Values = std::function<std::vector<double>(const Knobs&)>;

// Of the values of scenes with a knob moved: central, or from below where the knob ends there, `end_step`
// apart.
inline std::vector<double> difference(const Knobs& knobs, double Knobs::*knob, double end_step,
                                      const Values& values) {
  const double at = knobs.*knob;
  const bool ends = knob == &Knobs::poisson && at == 0.5;
  double h = 2e-3 * (at == 0 ? 0.1 : std::abs(at));
  // What rows answer bends with the distance to 0.5.
  if (knob == &Knobs::poisson) h = ends ? end_step : 1e-2 * (0.5 - at);
  const std::vector<std::pair<int, double>> rule =
      ends ? std::vector<std::pair<int, double>>{{0, 137. / 60}, {-1, -5},     {-2, 5},
                                                 {-3, -10. / 3}, {-4, 5. / 4}, {-5, -1. / 5}}
           : std::vector<std::pair<int, double>>{{-2, 1. / 12}, {-1, -8. / 12}, {1, 8. / 12}, {2, -1. / 12}};
  std::vector<double> sum;
  for (const auto& [step, weight] : rule) {
    Knobs moved = knobs;
    moved.*knob = at + step * h;
    const std::vector<double> there = values(moved);
    sum.resize(there.size());
    for (std::size_t j = 0; j < there.size(); ++j) sum[j] += weight / h * there[j];
  }
  return sum;
}

struct Found {
  const Gradients &adjoint, &tangent;
};

// Every output by every parameter: against differences to 1e-6, the adjoint against tangents to 1e-10, of the
// largest change of the output by any parameter, each over its own size.
inline void check_all(const Knobs& knobs, const std::vector<std::string>& outputs,
                      const std::vector<Asked>& asked, const Found& found, double end_step,
                      const Values& values) {
  using Catch::Matchers::WithinAbs;
  std::vector<double> largest(outputs.size(), 0), size;
  for (const Asked& a : asked) size.push_back(knobs.*a.knob == 0 ? 0.1 : std::abs(knobs.*a.knob));
  for (std::size_t j = 0; j < outputs.size(); ++j) {
    for (std::size_t p = 0; p < asked.size(); ++p)
      largest[j] = std::max(largest[j], std::abs(found.adjoint.of(j, p)) * size[p]);
  }
  for (std::size_t p = 0; p < asked.size(); ++p) {
    const std::vector<double> wanted = difference(knobs, asked[p].knob, end_step, values);
    for (std::size_t j = 0; j < outputs.size(); ++j) {
      INFO(outputs[j] << " by " << asked[p].name);
      const double scale = largest[j] / size[p];
      // Points inside of cells stay where they are in the mesh, and the judge looks them up anew.
      if (outputs[j] != "point" || asked[p].name != "shape")
        CHECK_THAT(found.adjoint.of(j, p), WithinAbs(wanted[j], 1e-6 * scale));
      CHECK_THAT(found.adjoint.of(j, p), WithinAbs(found.tangent.of(j, p), 1e-10 * scale));
    }
  }
}

template <class T>
std::string refusal(const isochor::Result<T>& result) {
  REQUIRE_FALSE(result.ok());
  return result.error();
}

}  // namespace test
