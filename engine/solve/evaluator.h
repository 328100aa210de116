// Evaluates a saddle point at iterates: energies, residuals and their scaled norms.
#pragma once

#include "engine/solve/iterate.h"
#include "engine/solve/saddle_problem.h"
#include "engine/system/assembly.h"

namespace isochor {

class Evaluator {
 public:
  Evaluator(std::shared_ptr<const System> system, const Parallel& parallel);

  // Measures the stiffness of the system at rest.
  void calibrate();
  // Of a solve: nothing of an earlier one is left.
  void begin(const SaddleProblem& p);

  // Everything at the iterate's positions and multipliers, up to `want` (at least a gradient).
  void evaluate(const SaddleProblem& p, Want want, Definiteness definiteness, Iterate& it);
  // What pools with a lag hold on to from now on.
  void renew_lag(const SaddleProblem& p, const Iterate& it) {
    assembly_.renew_lag(it.x, it.lambda, p.prescribed);
  }
  // The same for a lag that was renewed since the last evaluation, which was here.
  void evaluate_lagging(const SaddleProblem& p, Iterate& it);
  // Functions and energies alone, without forces.
  void evaluate_values(const SaddleProblem& p, Iterate& it);
  // Reads the last evaluation of the assembly, which was at it.x, whatever its multipliers.
  void read_forces(const SaddleProblem& p, Iterate& it);
  void read_rows(const SaddleProblem& p, Iterate& it);

  // Strains of the rows with a law of their own, and their tangents where asked; their energy
  // lambda . c - U.
  double apply_laws(const SaddleProblem& p, std::span<const double> lambda, bool tangents);
  std::span<const double> tangents() const { return tangent_; }  // one for each compliance entry

  // Energy of stencils, inertia, loads and given multipliers [J].
  double potential(const SaddleProblem& p, const Iterate& it) const;
  // Size of the numbers that cancel in it: what its rounding error is relative to [J].
  double potential_magnitude(const SaddleProblem& p, const Iterate& it) const;

  struct RowResiduals {
    double row = 0, position = 0;
  };
  struct Residuals {
    double force = 0, row = 0, position = 0;
  };
  RowResiduals measure_rows(const SaddleProblem& p, const Iterate& it) const;
  Residuals measure(const SaddleProblem& p, const Iterate& it) const;
  // Writes the residuals into the report and says whether they are within tolerance.
  bool balanced(const SaddleProblem& p, const SaddleOptions& o, const Iterate& it,
                SaddleReport& report) const;
  // Energy that positions and multipliers hold.
  StoredEnergy stored(const SaddleProblem& p, const Iterate& it) const;

  void find_gap(const SaddleProblem& p, std::span<const Vec3> x, Gap& gap) const;
  // y += mass_scale M way: the lumped part of it falls on given directions alone and is left out.
  void add_inertia_of_gap(const Gap& gap, std::span<Vec3> y);
  void clamp(std::span<double> lambda) const;  // into the bounds of the rows

  const System& system() const { return *system_; }
  Assembly& assembly() { return assembly_; }
  const Assembly& assembly() const { return assembly_; }
  double mass_scale() const { return mass_scale_; }  // of this solve [1/s^2]
  // Stiffness of a node: at rest, and with its inertia in this solve [N/m].
  std::span<const double> rest_stiffness() const { return rest_stiffness_; }
  std::span<const double> stiffness() const { return stiffness_; }

 private:
  double force_norm(const Iterate& it, double floor) const;

  std::shared_ptr<const System> system_;
  Assembly assembly_;
  double mass_scale_ = 0;
  std::vector<double> rest_stiffness_, stiffness_;
  // Rows with laws: strain and tangent (one for each compliance entry).
  std::vector<double> strain_, tangent_;
  std::vector<Vec3> way_, inertia_;
};

// y += alpha * C v over the compliance entries.
void add_compliance(const System& s, double alpha, std::span<const double> v, std::span<double> y);
// v^T C v / 2 over the compliance entries.
double compliance_energy(const System& s, std::span<const double> v);

}  // namespace isochor
