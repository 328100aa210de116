// What is made around a material and leaves its numbers as they are: an addition overrides what it changes.
#pragma once

#include <utility>

#include "engine/elements/material_model.h"

namespace isochor {

class WrappedModel : public MaterialModel {
 public:
  std::string_view name() const override { return base_->name(); }
  double shear_modulus() const override { return base_->shear_modulus(); }
  double inverse_bulk() const override { return base_->inverse_bulk(); }
  double poisson() const override { return base_->poisson(); }
  double young() const override { return base_->young(); }
  bool defined_inverted() const override { return base_->defined_inverted(); }
  VolumeStrain volume_strain() const override { return base_->volume_strain(); }
  bool has_separate_volume() const override { return base_->has_separate_volume(); }
  std::vector<std::string> warnings() const override { return base_->warnings(); }
  const MaterialMemory* memory() const override { return base_->memory(); }
  std::size_t field_cells() const override { return base_->field_cells(); }
  double stiffness_factor(Index cell) const override { return base_->stiffness_factor(cell); }
  double inverse_bulk_of(Index cell) const override { return base_->inverse_bulk_of(cell); }
  double poisson_of(Index cell) const override { return base_->poisson_of(cell); }

 protected:
  explicit WrappedModel(std::shared_ptr<const MaterialModel> base) : base_(std::move(base)) {}
  const MaterialModel& base() const { return *base_; }

 private:
  std::shared_ptr<const MaterialModel> base_;
};

}  // namespace isochor
