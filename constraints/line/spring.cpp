#include <cmath>
#include <limits>

#include "constraints/stencil/segment_pool.h"
#include "engine/base/text.h"
#include "isochor/effects/cable.h"

namespace isochor {

namespace {

class SpringRow final : public RowPool {
 public:
  SpringRow(std::string name, double rest, double length, std::shared_ptr<const Amount> amount)
      : name_(std::move(name)), rest_(rest), length_(length), amount_(std::move(amount)) {}
  std::string_view name() const override { return name_; }
  // By how much it is to be longer than at rest.
  void update(double t, std::span<double> value) const override {
    value[0] = amount_->value(t) * length_ - rest_;
  }

 private:
  std::string name_;
  double rest_, length_;
  std::shared_ptr<const Amount> amount_;
};

class SpringInstance final : public EffectInstance {
 public:
  SpringInstance(std::string name, std::shared_ptr<const SegmentPool> pool, Index row_pool,
                 std::shared_ptr<Amount> amount)
      : name_(std::move(name)), pool_(std::move(pool)), row_pool_(row_pool), amount_(std::move(amount)) {}
  Amount* amount() override { return amount_.get(); }
  void gauges(const GaugeContext& c, std::vector<Gauge>& out) const override {
    out.push_back({name_, "spring", "tension", "N", c.state.lambda[at(c.system.first_row(row_pool_))]});
    out.push_back({name_, "spring", "length", "m", pool_->length(c.state.x)});
  }
  std::vector<GaugeSource> gauge_sources() const override {
    return {{"tension", row_pool_, 0, true, 1}, {"length", row_pool_, 0, false, 1}};
  }

 private:
  std::string name_;
  std::shared_ptr<const SegmentPool> pool_;
  Index row_pool_;
  std::shared_ptr<Amount> amount_;
};

class SpringEffect final : public EffectSource {
 public:
  explicit SpringEffect(SpringDef def) : def_(std::move(def)) {}
  const std::string& name() const override { return def_.name; }
  void describe(Fingerprint& f) const override { f.add(def_); }

  Result<void> check() const override {
    if (!finite(def_.from) || !finite(def_.to)) return Error{who() + ": its ends must be finite numbers"};
    if (!(def_.stiffness > 0) || !std::isfinite(def_.stiffness)) {
      return Error{who() + ": stiffness = " + number(def_.stiffness) +
                   " N/m; it must be positive (a cable without stiffness keeps its length)"};
    }
    if (def_.length && (!(*def_.length >= 0) || !std::isfinite(*def_.length))) {
      return Error{who() + ": length = " + number(*def_.length) +
                   " m; the length without tension must be zero or positive"};
    }
    for (const auto& p : def_.amount.points) {
      if (!(p[1] >= 0) || !std::isfinite(p[1])) {
        return Error{who() + ": amount " + number(p[1]) +
                     "; the factor on the length without tension must be zero or positive"};
      }
    }
    return {};
  }

  Result<std::unique_ptr<EffectInstance>> build(Builder& builder) const override {
    for (const BodyId id : {def_.body, def_.to_body.value_or(def_.body)}) {
      if (!builder.has_body(id)) return Error{who() + ": " + builder.no_body(id)};
    }
    const BodyData& body = builder.body(def_.body);
    auto from = embed(body, builder.rest(), def_.from, who());
    if (!from) return from.failure();
    auto pool = std::make_shared<SegmentPool>(def_.name, !def_.to_body);
    Result<void> added;
    double mu = stiffest(body);
    if (def_.to_body) {
      mu = std::max(mu, stiffest(builder.body(*def_.to_body)));
      auto to = embed(builder.body(*def_.to_body), builder.rest(), def_.to, who());
      if (!to) return to.failure();
      added = pool->add(from.value(), to.value(), builder.rest());
    } else {
      added = pool->add_anchor(from.value(), def_.to, builder.rest());
    }
    if (!added)
      return Error{who() +
                   ": its ends coincide at rest; move them apart, or take a tie or a support with a "
                   "stiffness, which have no length"};
    pool->finish();
    const double rest = pool->rest_length();
    auto amount = std::make_shared<Amount>(def_.amount);
    auto row = std::make_shared<SpringRow>(def_.name, rest, def_.length.value_or(rest), amount);
    row->stencil_pool = builder.add_stencils(pool);
    const Index segment = 0;
    row->map.push(std::span(&segment, 1));
    row->weight.push_back(1);
    row->compliance.push_back({0, 0, 1 / def_.stiffness});
    row->metric.push_back(1 / (mu * builder.length()));
    row->measure.push_back(rest);
    if (def_.pulls_only) {
      row->lower = {0};
      row->upper = {std::numeric_limits<double>::infinity()};
    }
    const Index row_pool = builder.add_rows(row);
    return std::unique_ptr<EffectInstance>(
        std::make_unique<SpringInstance>(def_.name, pool, row_pool, std::move(amount)));
  }

 private:
  std::string who() const { return "spring \"" + def_.name + "\""; }
  SpringDef def_;
};

}  // namespace

EffectPtr spring(SpringDef def) {
  return std::make_shared<SpringEffect>(std::move(def));
}

}  // namespace isochor
