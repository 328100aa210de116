#include <cmath>

#include "engine/builder.h"

namespace isochor {

namespace {

double norm(const Vec3& v) {
  return std::sqrt(dot(v, v));
}

// amount * displacement, and a rotation by amount * angle about an axis (Rodrigues).
class RigidMotion final : public Motion {
 public:
  RigidMotion(const DirichletDef& def, std::shared_ptr<Amount> amount)
      : displacement_(def.displacement),
        point_(def.axis_point),
        axis_(def.angle != 0 ? (1 / norm(def.axis)) * def.axis : Vec3{}),
        angle_(def.angle),
        amount_(std::move(amount)) {}

  Vec3 displacement(double t, const Vec3& rest) const override {
    const double a = amount_->value(t);
    Vec3 u = a * displacement_;
    if (angle_ != 0) {
      const Vec3 r = rest - point_;
      const double s = std::sin(a * angle_), half = std::sin(0.5 * a * angle_);
      const Vec3 k = cross(axis_, r);
      u += s * k + (2 * half * half) * cross(axis_, k);
    }
    return u;
  }
  bool never_moves() const override { return angle_ == 0 && norm(displacement_) == 0; }

 private:
  Vec3 displacement_, point_, axis_;
  double angle_;
  std::shared_ptr<Amount> amount_;
};

class DirichletInstance final : public EffectInstance {
 public:
  explicit DirichletInstance(std::shared_ptr<Amount> amount) : amount_(std::move(amount)) {}
  Amount* amount() override { return amount_.get(); }

 private:
  std::shared_ptr<Amount> amount_;
};

class DirichletEffect final : public EffectSource {
 public:
  explicit DirichletEffect(DirichletDef def) : def_(std::move(def)) {}
  const std::string& name() const override { return def_.name; }

  Result<void> check() const override {
    for (const Vec3& d : def_.directions) {
      if (!(norm(d) > 0) || !std::isfinite(norm(d))) {
        return Error{who() + "a direction has no length; give vectors such as (0, 1, 0)"};
      }
    }
    if (!std::isfinite(norm(def_.displacement)) || !std::isfinite(def_.angle) ||
        !std::isfinite(norm(def_.axis_point))) {
      return Error{who() + "displacement, angle and axis must be finite numbers"};
    }
    if (def_.angle != 0 && !(norm(def_.axis) > 0)) {
      return Error{who() + "angle is given without an axis; give axis = (0, 0, 1) or another direction"};
    }
    return {};
  }

  Result<std::unique_ptr<EffectInstance>> build(Builder& builder) const override {
    auto nodes = builder.select(def_.where, def_.name);
    if (!nodes) return Error{nodes.error()};
    auto amount = std::make_shared<Amount>(def_.amount);
    const auto motion = std::make_shared<RigidMotion>(def_, amount);
    std::vector<Vec3> directions = def_.directions;
    if (directions.empty()) directions = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (const Index node : nodes.value()) {
      for (const Vec3& d : directions) {
        if (auto r = builder.prescribe(node, (1 / norm(d)) * d, motion, def_.name); !r)
          return Error{r.error()};
      }
    }
    return std::unique_ptr<EffectInstance>(std::make_unique<DirichletInstance>(std::move(amount)));
  }

 private:
  std::string who() const { return "dirichlet \"" + def_.name + "\": "; }
  DirichletDef def_;
};

}  // namespace

EffectPtr dirichlet(DirichletDef def) {
  return std::make_shared<DirichletEffect>(std::move(def));
}

}  // namespace isochor
