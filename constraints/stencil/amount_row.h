// A row whose multiplier is given: an amount over time on all functions of a pool.
#pragma once

#include "engine/scene/builder.h"

namespace isochor {

// For pools with one function a stencil: the forces on the nodes are -amount times the gradient of their sum.
class AmountRow final : public RowPool {
 public:
  AmountRow(std::string name, std::shared_ptr<const Amount> amount, Index stencils)
      : name_(std::move(name)), amount_(std::move(amount)) {
    law = RowLaw::prescribed;
    for (Index s = 0; s < stencils; ++s) map.item.push_back(s);
    weight.assign(at(stencils), 1);
    map.offset.push_back(stencils);
    metric.push_back(1);
    measure.push_back(1);
  }
  std::string_view name() const override { return name_; }
  void update(double t, std::span<double> value) const override { value[0] = amount_->value(t); }

 private:
  std::string name_;
  std::shared_ptr<const Amount> amount_;
};

// Adds the pool with its row.
inline void add_given(Builder& builder, const std::string& name, std::shared_ptr<const StencilPool> pool,
                      const std::shared_ptr<const Amount>& amount) {
  auto row = std::make_shared<AmountRow>(name, amount, pool->stencils());
  row->stencil_pool = builder.add_stencils(std::move(pool));
  builder.add_rows(row);
}

}  // namespace isochor
