// What a body asks of a material: its energy with or without the volume part, and the small-strain numbers
// that the rows need.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/elements/material.h"
#include "isochor/choices.h"

namespace isochor {

// What of a material flows: springs with a dashpot each, beside its energy
// (engine/elements/relaxation_pool.h).
struct MaterialMemory {
  struct Branch {
    std::shared_ptr<const Material> spring;
    double time = 0;  // of relaxation [s]
  };
  std::vector<Branch> branches;
  bool in_statics = false;  // else all has relaxed there
};

class MaterialModel {
 public:
  virtual ~MaterialModel() = default;
  virtual std::string_view name() const = 0;
  // Energy without the volumetric part, for use with volume rows.
  virtual std::shared_ptr<const Material> distortional() const = 0;
  // One-field energy; refused where it does not exist (nu = 0.5).
  virtual Result<std::shared_ptr<const Material>> complete() const = 0;
  virtual double shear_modulus() const = 0;  // mu_L [Pa]
  virtual double inverse_bulk()
      const = 0;                       // 1/kappa of the volume rows [1/Pa]; 0: incompressible; inf: no rows
  virtual double poisson() const = 0;  // small-strain nu
  virtual double young() const = 0;    // small-strain E [Pa]
  virtual bool defined_inverted() const = 0;  // finite energy for J <= 0
  // The strain whose square over 2 inverse_bulk() is the volume part of the law: linear, logarithmic or
  // mixed.
  virtual VolumeStrain volume_strain() const { return VolumeStrain::linear; }
  // complete() is distortional() and a multiple of a function of J.
  virtual bool has_separate_volume() const { return true; }
  // What the world should say about its constants, a sentence each.
  virtual std::vector<std::string> warnings() const { return {}; }
  // Null: none.
  virtual const MaterialMemory* memory() const { return nullptr; }
  // Fields of parameters: how many cells they were given for (those of the body's mesh; 0: none), and by how
  // much a cell is stiffer than the numbers above.
  virtual std::size_t field_cells() const { return 0; }
  virtual double stiffness_factor(Index cell) const {
    (void)cell;
    return 1;
  }
  // 1/kappa and small-strain nu of a cell.
  virtual double inverse_bulk_of(Index cell) const { return inverse_bulk() / stiffness_factor(cell); }
  virtual double poisson_of(Index cell) const {
    (void)cell;
    return poisson();
  }
};

}  // namespace isochor
