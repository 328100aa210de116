// Laws W(I, II) written once, in their two forms: of the invariants of F with a term in J that balances the
// stress at rest, and of those of J^(-1/3) F; each with a volume part U(J).
#pragma once

#include "engine/math/lane_functions.h"
#include "isochor/materials.h"
#include "materials/elastic_constants.h"
#include "materials/energy_model.h"
#include "materials/strain_batch.h"

namespace isochor {

// W and its derivatives in the two invariants (1: I, 2: II), of a batch.
struct StrainPartBatch {
  Lanes value{};
  Lanes d1{}, d2{}, d11{}, d12{}, d22{};
};

// A strain part `W` has: StrainPartBatch operator()(const Lanes& I, const Lanes& II) const, pure, zero at I =
// II = 3, and kSecond: whether II matters. Where it has no value it gives what is no finite number.

// kappa U(J) - c B(J), added to a response; needs_log: whether log J is asked for.
struct VolumeTerms {
  VolumeEnergy energy = VolumeEnergy::quadratic;
  double kappa = 0;    // [Pa]
  double balance = 0;  // c [Pa]

  bool needs_log() const { return energy != VolumeEnergy::quadratic; }
  void add(const Lanes& J, const Lanes& log_J, StrainResponse& r) const {
    if (energy == VolumeEnergy::quadratic) {
      const Lanes d = J - 1;
      r.psi += d * (0.5 * kappa * d - balance);
      r.J += kappa * d - balance;
      r.J_J += broadcast(kappa);
      return;
    }
    const Lanes inverse = 1 / J;
    if (energy == VolumeEnergy::logarithmic) {
      const Lanes q = kappa * log_J - balance;
      r.psi += log_J * (0.5 * kappa * log_J - balance);
      r.J += q * inverse;
      r.J_J += (kappa - q) * inverse * inverse;
    } else {
      const Lanes d = J - 1;
      r.psi += 0.25 * kappa * (d * (2 + d) - 2 * log_J) - balance * log_J;
      r.J += 0.5 * kappa * (J - inverse) - balance * inverse;
      r.J_J += 0.5 * kappa + (0.5 * kappa + balance) * inverse * inverse;
    }
  }
};

template <class W>
struct FullStrainEnergy {
  static constexpr bool kSecond = W::kSecond;
  W strain;
  VolumeTerms volume;

  StrainResponse operator()(const Lanes& I, const Lanes& II, const Lanes& J) const {
    const StrainPartBatch w = strain(I, II);
    StrainResponse r;
    r.psi = w.value;
    r.I = w.d1, r.II = w.d2;
    r.I_I = w.d11, r.I_II = w.d12, r.II_II = w.d22;
    volume.add(J, volume.needs_log() ? log(J) : Lanes{}, r);
    return r;
  }
};

template <class W>
struct IsochoricStrainEnergy {
  static constexpr bool kSecond = W::kSecond;
  W strain;
  VolumeTerms volume;

  StrainResponse operator()(const Lanes& I, const Lanes& II, const Lanes& J) const {
    const Lanes log_J = log(J), inverse = 1 / J, third = exp(log_J * (-1.0 / 3)), a = third * third;
    const Lanes b = a * a, I_bar = a * I, II_bar = b * II;
    const StrainPartBatch w = strain(I_bar, II_bar);
    StrainResponse r;
    r.psi = w.value;
    r.I = a * w.d1;
    r.I_I = a * a * w.d11;
    // D = J d/dJ at fixed I and II: J^(-2/3) I falls by 2/3 of itself, J^(-4/3) II by 4/3.
    constexpr double x = -2.0 / 3, y = -4.0 / 3;
    Lanes D = x * I_bar * w.d1, DD = x * x * (I_bar * w.d1 + I_bar * I_bar * w.d11);
    Lanes D1 = x * (w.d1 + I_bar * w.d11);
    if constexpr (kSecond) {
      r.II = b * w.d2;
      r.I_II = a * b * w.d12;
      r.II_II = b * b * w.d22;
      D += y * II_bar * w.d2;
      D1 += y * II_bar * w.d12;
      DD += y * y * (II_bar * w.d2 + II_bar * II_bar * w.d22) + 2 * x * y * I_bar * II_bar * w.d12;
      r.II_J = b * inverse * (y * (w.d2 + II_bar * w.d22) + x * I_bar * w.d12);
    }
    r.J = D * inverse;
    r.I_J = a * inverse * D1;
    r.J_J = (DD - D) * inverse * inverse;
    volume.add(J, log_J, r);
    return r;
  }
};

// What becomes of constants that are their own: the small-strain numbers of a law and of its form.
struct StrainLaw {
  std::string_view name;
  const char* shear_modulus;  // its formula, for messages
  double poisson = 0.5;
  VolumePart volume;
  bool isochoric = false;
};

enum class Stability : std::uint8_t { known, in_question };

// Small-strain constants of a law with shear modulus `mu`, where the strain part alone has lambda_L =
// `lambda_of_strain`, and 1/kappa of its volume part. Checks poisson and bulk.
struct SmallStrain {
  LinearElastic elastic;
  double inverse_kappa = 0;
};
Result<SmallStrain> small_strain_of(const StrainLaw& law, double mu, double lambda_of_strain);

VolumeStrain strain_of(VolumeEnergy energy);

// Sentences about stretches at which an incompressible block is unstable; empty where there are none between
// a tenth and ten times its length.
std::vector<std::string> stability_warnings(std::string_view name, const Material& distortional);

// The model of a law. `in_question`: some constants have signs with which it may be unstable.
template <class W>
Result<MaterialPtr> strain_model(const StrainLaw& law, const W& strain, Stability stability) {
  const StrainPartBatch rest = strain(broadcast(3), broadcast(3));
  const double w1 = rest.d1[0], w2 = rest.d2[0];
  const double second = rest.d11[0] + 4 * rest.d12[0] + 4 * rest.d22[0];
  const double mu = 2 * (w1 + w2), balance = law.isochoric ? 0 : 2 * w1 + 4 * w2;
  double lambda = -2 * mu / 3;  // of the strain part
  if (!law.isochoric) {
    lambda = 4 * second + (law.volume.energy == VolumeEnergy::quadratic ? -2 * w1 : 4 * w2);
  }
  auto small = small_strain_of(law, mu, lambda);
  if (!small) return small.failure();
  const double inverse = small.value().inverse_kappa;
  const auto energy = [&](double kappa) -> std::shared_ptr<const Material> {
    const VolumeTerms terms{law.volume.energy, kappa, balance};
    if (law.isochoric) {
      using Energy = IsochoricStrainEnergy<W>;
      return std::make_shared<StrainMaterial<Energy>>(law.name, Energy{strain, terms});
    }
    using Energy = FullStrainEnergy<W>;
    return std::make_shared<StrainMaterial<Energy>>(law.name, Energy{strain, terms});
  };
  const bool turns_over = !law.isochoric && law.volume.energy == VolumeEnergy::quadratic;
  EnergyModel m{law.name, small.value().elastic, inverse, energy(0), nullptr, turns_over};
  if (inverse != 0) m.complete = energy(kappa_of(inverse));
  m.strain = strain_of(law.volume.energy);
  if (stability == Stability::in_question) m.warnings = stability_warnings(law.name, *m.distortional);
  return make_model(std::move(m));
}

}  // namespace isochor
