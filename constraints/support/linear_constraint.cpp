#include <algorithm>
#include <cmath>

#include "constraints/stencil/point_pool.h"
#include "engine/base/text.h"
#include "isochor/effects/support.h"

namespace isochor {

namespace {

class EquationRow final : public RowPool {
 public:
  EquationRow(std::string name, double at_one, std::shared_ptr<const Amount> amount)
      : name_(std::move(name)), at_one_(at_one), amount_(std::move(amount)) {}
  std::string_view name() const override { return name_; }
  void update(double t, std::span<double> value) const override { value[0] = at_one_ * amount_->value(t); }

 private:
  std::string name_;
  double at_one_;  // [m]
  std::shared_ptr<const Amount> amount_;
};

class EquationInstance final : public EffectInstance {
 public:
  EquationInstance(std::string name, Index row_pool, std::shared_ptr<Amount> amount)
      : name_(std::move(name)), row_pool_(row_pool), amount_(std::move(amount)) {}
  Amount* amount() override { return amount_.get(); }
  // A term is pulled by minus the multiplier times its weight along its direction.
  void gauges(const GaugeContext& c, std::vector<Gauge>& out) const override {
    out.push_back(
        {name_, "linear_constraint", "multiplier", "N", c.state.lambda[at(c.system.first_row(row_pool_))]});
  }
  std::vector<GaugeSource> gauge_sources() const override { return {{"multiplier", row_pool_, 0, true, 1}}; }

 private:
  std::string name_;
  Index row_pool_;
  std::shared_ptr<Amount> amount_;
};

class EquationEffect final : public EffectSource {
 public:
  explicit EquationEffect(LinearConstraintDef def) : def_(std::move(def)) {}
  const std::string& name() const override { return def_.name; }
  void describe(Fingerprint& f) const override { f.add(def_); }

  Result<void> check() const override {
    if (def_.terms.empty()) return Error{who() + ": it has no terms; give at least one"};
    for (std::size_t k = 0; k < def_.terms.size(); ++k) {
      const LinearConstraintDef::Term& term = def_.terms[k];
      const std::string where = who() + ": terms[" + std::to_string(k) + "]";
      const double length = norm(term.direction);
      if (!(length > 0) || !std::isfinite(length))
        return Error{where + ".direction has no length; give three numbers that are not all zero"};
      if (!(std::abs(term.weight) > 0) || !std::isfinite(term.weight))
        return Error{where + ".weight = " + number(term.weight) + "; give a number that is not zero"};
      if (!finite(term.point)) return Error{where + ".point must be finite numbers"};
    }
    if (!(def_.stiffness >= 0) || !std::isfinite(def_.stiffness)) {
      return Error{who() + ": stiffness = " + number(def_.stiffness) +
                   " N/m; it must be positive, or 0 for a hard equation"};
    }
    if (!std::isfinite(def_.value))
      return Error{who() + ": value = " + number(def_.value) + " m; give a finite number"};
    for (const auto& p : def_.amount.points) {
      if (!std::isfinite(p[1])) return Error{who() + ": its amount has a value that is no finite number"};
    }
    return {};
  }

  Result<std::unique_ptr<EffectInstance>> build(Builder& builder) const override {
    auto amount = std::make_shared<Amount>(def_.amount);
    auto pool = std::make_shared<PointPool>(def_.name, sees_rigid_motion(builder.length()));
    auto row = std::make_shared<EquationRow>(def_.name, def_.value, amount);
    double mu = 0, largest = 0;
    for (std::size_t k = 0; k < def_.terms.size(); ++k) {
      const LinearConstraintDef::Term& term = def_.terms[k];
      if (!builder.has_body(term.body)) return Error{who() + ": " + builder.no_body(term.body)};
      const BodyData& body = builder.body(term.body);
      auto point = embed(body, builder.rest(), term.point, who());
      if (!point) return point.failure();
      pool->add(point.value(), frame_of(term.direction));
      row->map.item.push_back(static_cast<Index>(3 * k));
      row->weight.push_back(term.weight);
      mu = std::max(mu, stiffest(body));
      largest = std::max(largest, std::abs(term.weight));
    }
    row->map.offset.push_back(static_cast<Index>(def_.terms.size()));
    pool->finish();
    row->stencil_pool = builder.add_stencils(pool);
    const double length = builder.length();
    row->metric.push_back(largest * largest / (mu * length));
    row->measure.push_back(largest * length);
    if (def_.stiffness > 0) row->compliance.push_back({0, 0, 1 / def_.stiffness});
    const Index row_pool = builder.add_rows(row);
    return std::unique_ptr<EffectInstance>(
        std::make_unique<EquationInstance>(def_.name, row_pool, std::move(amount)));
  }

 private:
  std::string who() const { return "linear constraint \"" + def_.name + "\""; }

  // The first axis along d.
  static PointPool::Frame frame_of(const Vec3& d) {
    const Vec3 first = direction(d);
    const Vec3 other = std::abs(first.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
    const Vec3 second = direction(cross(first, other));
    return {first, second, cross(first, second)};
  }

  // Some rigid motion of all bodies changes the sum: its force or its moment is not zero.
  bool sees_rigid_motion(double length) const {
    Vec3 force{}, moment{};
    double size = 0;
    for (const LinearConstraintDef::Term& term : def_.terms) {
      const Vec3 f = term.weight * direction(term.direction);
      force += f;
      moment += cross(term.point, f);
      size += norm(f);
    }
    return norm(force) > 1e-12 * size || norm(moment) > 1e-12 * size * length;
  }

  LinearConstraintDef def_;
};

}  // namespace

EffectPtr linear_constraint(LinearConstraintDef def) {
  return std::make_shared<EquationEffect>(std::move(def));
}

}  // namespace isochor
