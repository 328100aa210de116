#include <algorithm>
#include <cmath>

#include "constraints/stencil/point_pool.h"
#include "engine/base/text.h"
#include "isochor/effects/support.h"

namespace isochor {

namespace {

class TieRows final : public RowPool {
 public:
  explicit TieRows(std::string name) : name_(std::move(name)) {}
  std::string_view name() const override { return name_; }

 private:
  std::string name_;
};

class TieInstance final : public EffectInstance {
 public:
  TieInstance(std::string name, std::shared_ptr<const TieRows> rows, Index row_pool)
      : name_(std::move(name)), rows_(std::move(rows)), row_pool_(row_pool) {}
  // The force on the attached nodes.
  void gauges(const GaugeContext& c, std::vector<Gauge>& out) const override {
    Vec3 force{};
    const std::size_t first = at(c.system.first_row(row_pool_));
    for (Index r = 0; r < rows_->rows(); ++r) force[r % 3] -= c.state.lambda[first + at(r)];
    for (int k = 0; k < 3; ++k) {
      out.push_back({name_, "tie", std::string("force_") + "xyz"[k], "N", force[k]});
    }
  }

 private:
  std::string name_;
  std::shared_ptr<const TieRows> rows_;
  Index row_pool_;
};

class TieEffect final : public EffectSource {
 public:
  explicit TieEffect(TieDef def) : def_(std::move(def)) {}
  const std::string& name() const override { return def_.name; }
  void describe(Fingerprint& f) const override { f.add(def_); }

  Result<void> check() const override {
    if (!(def_.stiffness >= 0) || !std::isfinite(def_.stiffness)) {
      return Error{who() + ": stiffness = " + number(def_.stiffness) +
                   " N/m; it must be positive, or 0 for a hard tie"};
    }
    return {};
  }

  Result<std::unique_ptr<EffectInstance>> build(Builder& builder) const override {
    auto nodes = builder.select(def_.where, def_.name);
    if (!nodes) return nodes.failure();
    if (!builder.has_body(def_.to)) {
      return Error{who() + ": " + builder.no_body(def_.to)};
    }
    const BodyData& to = builder.body(def_.to);
    const double mu = std::max(stiffest(to), stiffest(builder.body(def_.where.body)));
    const double length = builder.length();
    const double compliance =
        def_.stiffness > 0 ? static_cast<double>(nodes.value().size()) / def_.stiffness : 0;
    auto pool = std::make_shared<PointPool>(def_.name, false);
    auto rows = std::make_shared<TieRows>(def_.name);
    for (std::size_t i = 0; i < nodes.value().size(); ++i) {
      const Index node = nodes.value()[i];
      if (def_.stiffness == 0 && builder.given_directions(node) > 0) {
        return Error{
            who() + ": node " + std::to_string(node - builder.body(def_.where.body).first_node) +
            " is held by a support already, a hard tie on top has nothing to move; take it out of one of "
            "the two, or give the tie a stiffness"};
      }
      auto point = embed(to, builder.rest(), builder.rest()[at(node)], who());
      if (!point) return point.failure();
      const PointInBody gap = difference(point.value(), {{node}, {1.0}});
      if (gap.nodes.empty()) {
        return Error{who() + ": node " + std::to_string(node - builder.body(def_.where.body).first_node) +
                     " would be tied to itself; tie nodes to another part"};
      }
      pool->add(gap);
      for (int k = 0; k < 3; ++k) {
        add_point_row(*rows, static_cast<Index>(i), k, compliance, 1 / (mu * length), length);
      }
    }
    pool->finish();
    rows->stencil_pool = builder.add_stencils(pool);
    const Index row_pool = builder.add_rows(rows);
    return std::unique_ptr<EffectInstance>(std::make_unique<TieInstance>(def_.name, rows, row_pool));
  }

 private:
  std::string who() const { return "tie \"" + def_.name + "\""; }
  TieDef def_;
};

}  // namespace

EffectPtr tie(TieDef def) {
  return std::make_shared<TieEffect>(std::move(def));
}

}  // namespace isochor
