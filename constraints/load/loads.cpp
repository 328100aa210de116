#include <cmath>

#include "constraints/load/varying_load.h"
#include "constraints/stencil/face_pool.h"
#include "engine/scene/builder.h"
#include "isochor/effects/load.h"

namespace isochor {

namespace {

// Fixed nodal forces times an amount.
class DeadLoad final : public LoadPool {
 public:
  DeadLoad(std::string name, std::vector<std::pair<Index, Vec3>> forces, std::shared_ptr<Amount> amount)
      : name_(std::move(name)), forces_(std::move(forces)), amount_(std::move(amount)) {}
  std::string_view name() const override { return name_; }
  void add(double t, std::span<Vec3> force) const override {
    const double a = amount_->value(t);
    for (const auto& [node, f] : forces_) force[at(node)] += a * f;
  }

 private:
  std::string name_;
  std::vector<std::pair<Index, Vec3>> forces_;
  std::shared_ptr<Amount> amount_;
};

// The same where factors change over time.
class MovingLoad final : public LoadPool {
 public:
  MovingLoad(std::string name, LoadedFaces faces, std::span<const Vec3> rest, std::shared_ptr<Amount> amount)
      : name_(std::move(name)), faces_(std::move(faces)), forces_(faces_, rest), amount_(std::move(amount)) {}
  std::string_view name() const override { return name_; }
  void add(double t, std::span<Vec3> force) const override {
    const double a = amount_->value(t);
    for (const RestAreaForces::Share& s : forces_.shares)
      force[at(s.node)] += (a * s.area * faces_.factor_at(s.entry, t)) * *faces_.traction;
  }

 private:
  std::string name_;
  LoadedFaces faces_;
  RestAreaForces forces_;
  std::shared_ptr<Amount> amount_;
};

class LoadInstance final : public EffectInstance {
 public:
  explicit LoadInstance(std::shared_ptr<Amount> amount) : amount_(std::move(amount)) {}
  Amount* amount() override { return amount_.get(); }

 private:
  std::shared_ptr<Amount> amount_;
};

std::unique_ptr<EffectInstance> add_dead_load(Builder& builder, const std::string& name,
                                              std::vector<std::pair<Index, Vec3>> forces,
                                              const Curve& curve) {
  auto amount = std::make_shared<Amount>(curve);
  builder.add_load(std::make_shared<DeadLoad>(name, std::move(forces), amount));
  return std::make_unique<LoadInstance>(std::move(amount));
}

class TractionEffect final : public EffectSource {
 public:
  explicit TractionEffect(TractionDef def) : def_(std::move(def)) {}
  const std::string& name() const override { return def_.name; }
  void describe(Fingerprint& f) const override { f.add(def_); }

  Result<void> check() const override {
    if (!finite(def_.traction) || !finite(def_.total_force)) {
      return Error{"traction \"" + def_.name + "\": traction and total_force must be finite numbers"};
    }
    const bool has_traction = dot(def_.traction, def_.traction) > 0,
               has_force = dot(def_.total_force, def_.total_force) > 0;
    if (has_traction && has_force) {
      return Error{"traction \"" + def_.name + "\": both traction and total_force are given; give one"};
    }
    if (has_force && (def_.current_area || varies())) {
      return Error{
          "traction \"" + def_.name +
          "\": a total_force has no current_area and no field or profile; give a traction with them"};
    }
    if (def_.lagged && !def_.current_area) {
      return Error{"traction \"" + def_.name +
                   "\": lagged is for current_area; a traction per area at rest has no need of it"};
    }
    return {};
  }

  Result<std::unique_ptr<EffectInstance>> build(Builder& builder) const override {
    const std::vector<std::string> surface = {def_.surface};
    auto faces = builder.faces(def_.body, surface, def_.name);
    if (!faces) return faces.failure();
    const auto per = static_cast<std::size_t>(nodes_per_face(builder.body(def_.body).mesh.cell_type));
    if (def_.current_area || varies()) return build_varying(builder, faces.value());
    std::vector<std::pair<Index, double>> area;
    double total = 0;
    for (std::size_t f = 0; f < faces.value().size(); f += per) {
      const std::span<const Index> nodes(faces.value().data() + f, per);
      for (const auto& [node, a] : nodal_areas(nodes, builder.rest())) {
        area.emplace_back(node, a);
        total += a;
      }
    }
    const Vec3 traction =
        dot(def_.total_force, def_.total_force) > 0 ? (1 / total) * def_.total_force : def_.traction;
    std::vector<std::pair<Index, Vec3>> forces;
    forces.reserve(area.size());
    for (const auto& [node, a] : area) forces.emplace_back(node, a * traction);
    return add_dead_load(builder, def_.name, std::move(forces), def_.amount);
  }

 private:
  bool varies() const { return !def_.field.empty() || !def_.profile.empty(); }

  // Over a surface that is as it is, or with factors.
  Result<std::unique_ptr<EffectInstance>> build_varying(Builder& builder,
                                                        const std::vector<Index>& faces) const {
    auto loaded = loaded_faces(builder, builder.body(def_.body), faces, def_.field, def_.profile);
    if (!loaded) return Error{"traction \"" + def_.name + "\": " + loaded.error()};
    loaded.value().traction = def_.traction;
    if (!def_.current_area && !loaded.value().varies_in_time()) {
      return add_dead_load(builder, def_.name, rest_area_forces(loaded.value(), builder.rest()), def_.amount);
    }
    auto amount = std::make_shared<Amount>(def_.amount);
    if (def_.current_area) {
      add_varying_load(builder, def_.name, std::move(loaded).value(), def_.lagged, amount);
    } else {
      builder.add_load(
          std::make_shared<MovingLoad>(def_.name, std::move(loaded).value(), builder.rest(), amount));
    }
    return std::unique_ptr<EffectInstance>(std::make_unique<LoadInstance>(std::move(amount)));
  }

  TractionDef def_;
};

class PointForceEffect final : public EffectSource {
 public:
  explicit PointForceEffect(PointForceDef def) : def_(std::move(def)) {}
  const std::string& name() const override { return def_.name; }
  void describe(Fingerprint& f) const override { f.add(def_); }

  Result<void> check() const override {
    if (!finite(def_.force)) return Error{"force \"" + def_.name + "\": force must be finite numbers"};
    return {};
  }

  Result<std::unique_ptr<EffectInstance>> build(Builder& builder) const override {
    auto nodes = builder.select(def_.where, def_.name);
    if (!nodes) return nodes.failure();
    std::vector<std::pair<Index, Vec3>> forces;
    for (const Index node : nodes.value()) {
      forces.emplace_back(node, (1 / static_cast<double>(nodes.value().size())) * def_.force);
    }
    return add_dead_load(builder, def_.name, std::move(forces), def_.amount);
  }

 private:
  PointForceDef def_;
};

}  // namespace

EffectPtr traction(TractionDef def) {
  return std::make_shared<TractionEffect>(std::move(def));
}
EffectPtr point_force(PointForceDef def) {
  return std::make_shared<PointForceEffect>(std::move(def));
}

}  // namespace isochor
