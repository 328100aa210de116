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

// Functions of a stencil whose c is held where the iteration began have no potential in x. The slots of
// stencil `s`: value c . (x - origin), the Jacobian c. Linear in the positions; the places of the Hessian are
// for what the lag adds. `origin(a)`: of the a-th node [m].
template <class Origin>
void write_held_function(const StencilRequest& request, const StencilSlots& slots, const StencilPool& pool,
                         Index s, const Vec3* c, Origin origin) {
  const auto nodes = pool.nodes()[s];
  const std::size_t n = nodes.size(), first = at(pool.nodes().offset[at(s)]);
  slots.energy[at(s)] = 0;
  double value = 0;
  for (std::size_t a = 0; a < n; ++a) value += dot(c[a], request.x[at(nodes[a])] - origin(a));
  slots.value[at(s)] = value;
  if (request.want == Want::value) return;
  const double multiplier = request.function_multiplier[at(s)];
  for (std::size_t a = 0; a < n; ++a) {
    slots.jacobian[first + a] = c[a];
    slots.gradient[first + a] = multiplier * c[a];
  }
  if (request.want == Want::hessian)
    std::fill_n(slots.hessian.data() + pool.hessian_offset()[at(s)], n * (n + 1) / 2, Mat3{});
}

}  // namespace isochor
