#include "tendon.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/scene/builder.h"

namespace isochor {

namespace {

// The kernel: one stencil a segment, two nodes each, one function: how much longer it is than at rest [m].
class SegmentPool final : public StencilPool {
 public:
  SegmentPool(std::string name, std::span<const Index> nodes, std::span<const Vec3> rest)
      : name_(std::move(name)) {
    for (std::size_t i = 0; i + 1 < nodes.size(); ++i) {
      nodes_.push(nodes.subspan(i, 2));
      const Vec3 d = rest[at(nodes[i + 1])] - rest[at(nodes[i])];
      rest_length_.push_back(std::sqrt(dot(d, d)));
    }
    finish_topology();
  }
  std::string_view name() const override { return name_; }
  StencilShape shape() const override { return {.functions = 1}; }

  void evaluate(const StencilRequest& request, const StencilSlots& slots) const override {
    for (Index s = request.begin; s < request.end; ++s) {
      const auto nodes = nodes_[s];
      const Vec3 d = request.x[at(nodes[1])] - request.x[at(nodes[0])];
      const double length = std::sqrt(dot(d, d));
      // Two nodes in one place have no direction: outside the domain, the line search stays away.
      slots.energy[at(s)] = length > 0 ? 0 : std::numeric_limits<double>::infinity();
      slots.value[at(s)] = length - rest_length_[at(s)];
      if (request.want == Want::value) continue;
      const std::size_t first = at(nodes_.offset[at(s)]);
      const Vec3 u = length > 0 ? (1 / length) * d : Vec3{};
      const double tension = request.function_multiplier[at(s)];
      slots.jacobian[first] = -u;
      slots.jacobian[first + 1] = u;
      slots.gradient[first] = -tension * u;
      slots.gradient[first + 1] = tension * u;
      if (request.want == Want::hessian) write_hessian(request, slots, s, u, length);
    }
  }

  double rest_length() const {
    double sum = 0;
    for (const double l : rest_length_) sum += l;
    return sum;
  }

 private:
  // tension (1 - u u^T) / length, with signs + - +, in the order (0,0), (1,0), (1,1).
  void write_hessian(const StencilRequest& request, const StencilSlots& slots, Index s, const Vec3& u,
                     double length) const {
    double k = length > 0 ? request.function_multiplier[at(s)] / length : 0;
    if (request.definiteness != Definiteness::exact) k = std::max(k, 0.0);
    Mat3* block = slots.hessian.data() + hessian_offset()[at(s)];
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        const double h = k * ((i == j ? 1.0 : 0.0) - u[i] * u[j]);
        block[0](i, j) = h;
        block[1](i, j) = -h;
        block[2](i, j) = h;
      }
    }
  }

  std::string name_;
  std::vector<double> rest_length_;
};

// The row map: one row that sums all segments. Its target is minus the length pulled in.
class TendonRow final : public RowPool {
 public:
  TendonRow(std::string name, std::shared_ptr<const Amount> amount)
      : name_(std::move(name)), amount_(std::move(amount)) {}
  std::string_view name() const override { return name_; }
  void update(double t, std::span<double> value) const override { value[0] = -amount_->value(t); }

 private:
  std::string name_;
  std::shared_ptr<const Amount> amount_;
};

// What a host can set and read.
class TendonInstance final : public EffectInstance {
 public:
  TendonInstance(std::string name, std::shared_ptr<Amount> amount, Index row_pool)
      : name_(std::move(name)), amount_(std::move(amount)), row_pool_(row_pool) {}
  Amount* amount() override { return amount_.get(); }
  void gauges(const GaugeContext& c, std::vector<Gauge>& out) const override {
    const double tension = c.state.lambda[at(c.system.first_row(row_pool_))];
    out.push_back({name_, "tendon", "tension", "N", tension});
  }

 private:
  std::string name_;
  std::shared_ptr<Amount> amount_;
  Index row_pool_;
};

// The effect: checks its parameters, then builds pools and rows.
class TendonEffect final : public EffectSource {
 public:
  explicit TendonEffect(TendonDef def) : def_(std::move(def)) {}
  const std::string& name() const override { return def_.name; }
  // All members of the definition: a saved state is refused by a world whose tendon differs.
  void describe(Fingerprint& f) const override { f.add(def_); }

  Result<void> check() const override {
    const std::string who = "tendon \"" + def_.name + "\": ";
    if (def_.points.size() < 2) return Error{who + "it needs at least two points"};
    if (!(def_.stiffness >= 0) || !std::isfinite(def_.stiffness)) {
      return Error{who + "stiffness = " + std::to_string(def_.stiffness) +
                   " N/m; it must be positive, or 0 for an inextensible tendon"};
    }
    return {};
  }

  Result<std::unique_ptr<EffectInstance>> build(Builder& builder) const override {
    const std::string who = "tendon \"" + def_.name + "\": ";
    std::vector<Index> nodes;
    for (const Vec3& point : def_.points) {
      Selection nearest;
      nearest.body = def_.body;
      nearest.nearest = {point};
      auto found = builder.select(nearest, def_.name);
      if (!found) return Error{found.error()};
      nodes.push_back(found.value().front());
    }
    auto pool = std::make_shared<SegmentPool>(def_.name, nodes, builder.rest());
    const double length = pool->rest_length();
    if (!(length > 0)) return Error{who + "its points lead to one node; move them apart"};

    auto amount = std::make_shared<Amount>(def_.amount);
    auto row = std::make_shared<TendonRow>(def_.name, amount);
    row->stencil_pool = builder.add_stencils(pool);
    for (Index s = 0; s < pool->stencils(); ++s) {
      row->map.item.push_back(s);  // stencil * functions + k, here one function
      row->weight.push_back(1);
    }
    row->map.offset.push_back(pool->stencils());
    if (def_.stiffness > 0) row->compliance.push_back({0, 0, 1 / def_.stiffness});
    double mu = 0;
    for (const RegionData& r : builder.body(def_.body).regions)
      mu = std::max(mu, r.material->shear_modulus());
    row->metric.push_back(1 / (mu * length));  // phi^2 / D in joules
    row->measure.push_back(length);
    const Index row_pool = builder.add_rows(row);
    return std::unique_ptr<EffectInstance>(
        std::make_unique<TendonInstance>(def_.name, std::move(amount), row_pool));
  }

 private:
  TendonDef def_;
};
}  // namespace

EffectPtr tendon(TendonDef def) {
  return std::make_shared<TendonEffect>(std::move(def));
}

}  // namespace isochor
