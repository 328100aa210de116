#include "isochor/effects/cable.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "constraints/stencil/segment_pool.h"
#include "engine/base/text.h"

namespace isochor {

namespace {

class CableRow final : public RowPool {
 public:
  CableRow(std::string name, CableControl control, double rest_length, std::shared_ptr<Amount> amount)
      : name_(std::move(name)), control_(control), rest_length_(rest_length), amount_(std::move(amount)) {}
  std::string_view name() const override { return name_; }
  void update(double t, std::span<double> value) const override { value[0] = amount_value(t); }

  // The tension, or by how much the cable is to be longer than at rest.
  double amount_value(double t) const {
    const double a = amount_->value(t);
    if (control_ == CableControl::tension) return std::max(a, 0.0);
    return (control_ == CableControl::length ? a : a * rest_length_) - rest_length_;
  }

 private:
  std::string name_;
  CableControl control_;
  double rest_length_;
  std::shared_ptr<Amount> amount_;
};

class CableInstance final : public EffectInstance {
 public:
  CableInstance(std::shared_ptr<const SegmentPool> pool, std::shared_ptr<const CableRow> row, Index row_pool,
                std::shared_ptr<Amount> amount)
      : pool_(std::move(pool)), row_(std::move(row)), row_pool_(row_pool), amount_(std::move(amount)) {}
  Amount* amount() override { return amount_.get(); }
  void gauges(const GaugeContext& c, std::vector<Gauge>& out) const override {
    const std::string name(row_->name());
    const double tension = row_->law == RowLaw::prescribed
                               ? row_->amount_value(c.state.t)
                               : c.state.lambda[at(c.system.first_row(row_pool_))];
    out.push_back({name, "cable", "tension", "N", tension});
    out.push_back({name, "cable", "length", "m", pool_->length(c.state.x)});
  }
  std::vector<GaugeSource> gauge_sources() const override {
    return {{"tension", row_pool_, 0, true, 1}, {"length", row_pool_, 0, false, 1}};
  }

 private:
  std::shared_ptr<const SegmentPool> pool_;
  std::shared_ptr<const CableRow> row_;
  Index row_pool_;
  std::shared_ptr<Amount> amount_;
};

class CableEffect final : public EffectSource {
 public:
  explicit CableEffect(CableDef def) : def_(std::move(def)) {}
  const std::string& name() const override { return def_.name; }
  void describe(Fingerprint& f) const override { f.add(def_); }

  Result<void> check() const override {
    if (def_.points.size() + (def_.from ? 1 : 0) + (def_.to ? 1 : 0) < 2 || def_.points.empty()) {
      return Error{who() + ": it has " + std::to_string(def_.points.size()) +
                   " points; give at least two, or one and a fixed end"};
    }
    if (!(def_.stiffness >= 0) || !std::isfinite(def_.stiffness)) {
      return Error{who() + ": stiffness = " + number(def_.stiffness) +
                   " N/m; it must be positive, or 0 for an inextensible cable"};
    }
    if (def_.stiffness > 0 && def_.control == CableControl::tension) {
      return Error{who() +
                   ": a stiffness has no effect when the tension is given; leave it out, or control "
                   "the length"};
    }
    for (const auto& p : def_.amount.points) {
      if (!std::isfinite(p[1])) return Error{who() + ": its amount has a value that is no number"};
      if (def_.control != CableControl::tension && p[1] <= 0) {
        return Error{who() + ": length amount " + number(p[1]) + "; a cable's length must stay positive"};
      }
    }
    return {};
  }

  Result<std::unique_ptr<EffectInstance>> build(Builder& builder) const override {
    if (!builder.has_body(def_.body)) return Error{who() + ": " + builder.no_body(def_.body)};
    const BodyData& body = builder.body(def_.body);
    std::vector<PointInBody> points;
    for (const Vec3& X : def_.points) {
      auto point = embed(body, builder.rest(), X, who());
      if (!point) return point.failure();
      points.push_back(std::move(point).value());
    }
    auto pool = std::make_shared<SegmentPool>(def_.name, def_.from || def_.to);
    Result<void> added;
    const auto keep = [&](Result<void> r) {
      if (added.ok() && !r.ok()) added = std::move(r);
    };
    if (def_.from) keep(pool->add_anchor(points.front(), *def_.from, builder.rest()));
    for (std::size_t i = 0; i + 1 < points.size(); ++i)
      keep(pool->add(points[i], points[i + 1], builder.rest()));
    if (def_.to) keep(pool->add_anchor(points.back(), *def_.to, builder.rest()));
    if (!added) return Error{who() + ": " + added.error()};
    pool->finish();

    const double length = pool->rest_length();
    auto amount = std::make_shared<Amount>(def_.amount);
    auto row = std::make_shared<CableRow>(def_.name, def_.control, length, amount);
    row->stencil_pool = builder.add_stencils(pool);
    for (Index s = 0; s < pool->stencils(); ++s) {
      row->map.item.push_back(s);
      row->weight.push_back(1);
    }
    row->map.offset.push_back(pool->stencils());
    row->metric.push_back(1 / (stiffest(body) * builder.length()));
    row->measure.push_back(length);
    if (def_.control == CableControl::tension) {
      row->law = RowLaw::prescribed;
    } else {
      if (def_.stiffness > 0) row->compliance.push_back({0, 0, 1 / def_.stiffness});
      row->lower = {0};
      row->upper = {std::numeric_limits<double>::infinity()};
    }
    const Index row_pool = builder.add_rows(row);
    return std::unique_ptr<EffectInstance>(
        std::make_unique<CableInstance>(pool, row, row_pool, std::move(amount)));
  }

 private:
  std::string who() const { return "cable \"" + def_.name + "\""; }
  CableDef def_;
};

}  // namespace

EffectPtr cable(CableDef def) {
  return std::make_shared<CableEffect>(std::move(def));
}

}  // namespace isochor
