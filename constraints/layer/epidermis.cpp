// A thin layer that resists changes of area and nothing else: one row a face, of a strain that stiffens.
#include <cmath>
#include <limits>

#include "constraints/layer/face_strain.h"
#include "engine/base/text.h"
#include "engine/scene/builder.h"
#include "engine/scene/embedding.h"
#include "isochor/effects/layer.h"

namespace isochor {

namespace {

// Phi = m sqrt(1 + gamma m^2 / 6) with m = sqrt(q) - 1, so that Phi^2 / 2 is the penalty U(area ratio;
// gamma).
class AreaPool final : public FaceStrainPool {
 public:
  AreaPool(std::string name, std::size_t nodes_per_face, std::span<const Index> faces,
           std::span<const Vec3> rest, double gamma)
      : FaceStrainPool(std::move(name), Gives::function, nodes_per_face, faces, rest), gamma_(gamma) {}

 protected:
  FaceResponse respond(double, double d) const override {
    FaceResponse w;
    if (!(d > -1)) {
      w.value = std::numeric_limits<double>::infinity();
      return w;
    }
    const double ratio = std::sqrt(1 + d), m = d / (1 + ratio);
    const double square = gamma_ * m * m, root = std::sqrt(1 + square / 6);
    const double first = (1 + square / 3) / root;
    const double second = gamma_ * m * (0.5 + square / 18) / (root * root * root);
    const double dm = 0.5 / ratio, ddm = -0.25 / (ratio * ratio * ratio);
    w.value = m * root;
    w.q = first * dm;
    w.qq = second * dm * dm + first * ddm;
    return w;
  }

 private:
  double gamma_;
};

class AreaRows final : public RowPool {
 public:
  explicit AreaRows(std::string name) : name_(std::move(name)) {}
  std::string_view name() const override { return name_; }

 private:
  std::string name_;
};

class EpidermisInstance final : public EffectInstance {
 public:
  EpidermisInstance(std::string name, std::shared_ptr<const AreaPool> pool, Index row_pool)
      : name_(std::move(name)), pool_(std::move(pool)), row_pool_(row_pool) {}
  void gauges(const GaugeContext& c, std::vector<Gauge>& out) const override {
    double tension = 0, area = 0;
    for (Index f = 0; f < pool_->stencils(); ++f) {
      tension += pool_->rest_area(f) * c.state.lambda[at(c.system.first_row(row_pool_) + f)];
      area += pool_->rest_area(f);
    }
    out.push_back({name_, "epidermis", "area", "m^2", pool_->area(c.state.x, c.system.parts().rest)});
    out.push_back({name_, "epidermis", "mean tension", "N/m", tension / area});
  }

 private:
  std::string name_;
  std::shared_ptr<const AreaPool> pool_;
  Index row_pool_;
};

class EpidermisEffect final : public EffectSource {
 public:
  explicit EpidermisEffect(EpidermisDef def) : def_(std::move(def)) {}
  const std::string& name() const override { return def_.name; }
  void describe(Fingerprint& f) const override { f.add(def_); }

  Result<void> check() const override {
    if (def_.surfaces.empty()) {
      return Error{who() + "surfaces is empty; name the surfaces that carry the skin"};
    }
    if (!(def_.gamma >= 0) || !std::isfinite(def_.gamma)) {
      return Error{who() + "gamma = " + number(def_.gamma) + "; it must be zero (no stiffening) or positive"};
    }
    const bool by_layer = def_.young != 0 || def_.poisson != 0 || def_.thickness != 0;
    if (by_layer == (def_.stiffness != 0)) {
      return Error{who() +
                   (by_layer ? "stiffness is given beside young, poisson and thickness"
                             : "neither stiffness nor young, poisson and thickness are given") +
                   "; give exactly one of the two"};
    }
    if (!by_layer) {
      if (def_.stiffness > 0) return {};
      return Error{who() + "stiffness = " + number(def_.stiffness) +
                   " N/m; it must be positive, infinity keeps the area of every face"};
    }
    if (!(def_.young > 0) || !std::isfinite(def_.young)) {
      return Error{who() + "young = " + number(def_.young) + " Pa; it must be positive"};
    }
    if (!(def_.thickness > 0) || !std::isfinite(def_.thickness)) {
      return Error{who() + "thickness = " + number(def_.thickness) + " m; it must be positive"};
    }
    if (!(def_.poisson > 0) || !(def_.poisson <= 0.5)) {
      return Error{who() + "poisson = " + number(def_.poisson) +
                   "; it must lie above 0 (no resistance to area) and at most at 0.5 (area of every face "
                   "kept)"};
    }
    return {};
  }

  Result<std::unique_ptr<EffectInstance>> build(Builder& builder) const override {
    auto named = builder.faces(def_.body, def_.surfaces, def_.name);
    if (!named) return named.failure();
    const BodyData& body = builder.body(def_.body);
    const auto per_face = static_cast<std::size_t>(nodes_per_face(body.mesh.cell_type));
    const auto faces = distinct_faces(named.value(), per_face);
    const auto pool = std::make_shared<AreaPool>(def_.name, per_face, faces, builder.rest(), def_.gamma);
    const double mu = stiffest(body);
    auto rows = std::make_shared<AreaRows>(def_.name);
    rows->stencil_pool = builder.add_stencils(pool);
    const double compliance = inverse_stiffness();
    for (Index f = 0; f < pool->stencils(); ++f) {
      const double area = pool->rest_area(f);
      rows->map.push(std::array{f});
      rows->weight.push_back(1);
      if (compliance > 0) rows->compliance.push_back({f, f, area * compliance});
      // As much distortion as a layer of the body below, as deep as the face is wide.
      rows->metric.push_back(std::sqrt(area) / mu);
      rows->measure.push_back(area);
    }
    const Index row_pool = builder.add_rows(rows);
    return std::unique_ptr<EffectInstance>(std::make_unique<EpidermisInstance>(def_.name, pool, row_pool));
  }

 private:
  std::string who() const { return "epidermis \"" + def_.name + "\": "; }
  // 1/lambda_e [m/N].
  double inverse_stiffness() const {
    if (def_.stiffness != 0) return 1 / def_.stiffness;
    return (1 + def_.poisson) * (1 - 2 * def_.poisson) / (def_.young * def_.poisson * def_.thickness);
  }

  EpidermisDef def_;
};

}  // namespace

EffectPtr epidermis(EpidermisDef def) {
  return std::make_shared<EpidermisEffect>(std::move(def));
}

}  // namespace isochor
