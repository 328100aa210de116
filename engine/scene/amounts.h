// What a host has set that changes from increment to increment: amounts and poses of effects, and gravity.
#pragma once

#include "engine/scene/builder.h"

namespace isochor {

// Gravity as its curve has it, until a host sets another.
class Gravity {
 public:
  Gravity(const Vec3& said, const Curve& curve) : said_(said), curve_(curve) {
    for (std::size_t k = 0; k < 3; ++k) {
      Curve own = curve;
      for (auto& point : own.points) point[1] *= said[static_cast<int>(k)];
      set_[k].emplace(std::move(own));
    }
  }
  Vec3 at(double t) const {
    if (!set_[0]->held()) return evaluate(curve_, t) * said_;
    return {set_[0]->value(t), set_[1]->value(t), set_[2]->value(t)};
  }
  void set(const Vec3& g) {
    for (std::size_t k = 0; k < 3; ++k) set_[k]->set(g[static_cast<int>(k)]);
  }
  std::array<std::optional<Amount>, 3>& components() { return set_; }
  const std::array<std::optional<Amount>, 3>& components() const { return set_; }

 private:
  Vec3 said_;
  Curve curve_;
  std::array<std::optional<Amount>, 3> set_;
};

class Amounts {
 public:
  // Instances by the number of their effect; null where there is none.
  Amounts(const std::vector<std::unique_ptr<EffectInstance>>& instances, Gravity of_scene)
      : gravity(std::move(of_scene)), instances_(instances) {}

  Gravity gravity;

  // Announces the increment [t0, t1] to those that a host has set; `ramps`: amounts get there gradually,
  // otherwise they are there at once. Poses move to where they are set in any case.
  void begin(double t0, double t1, bool ramps) {
    for (auto& g : gravity.components()) g->begin(ramps ? t0 : t1, t1);
    each([&](EffectInstance& instance) {
      if (Amount* a = instance.amount()) a->begin(ramps ? t0 : t1, t1);
      if (LivePose* p = instance.pose()) p->begin(t0, t1);
    });
  }
  // As if a host had set nothing.
  void forget() {
    for (auto& g : gravity.components()) g->forget();
    each([&](EffectInstance& instance) {
      if (Amount* a = instance.amount()) a->forget();
      if (LivePose* p = instance.pose()) p->forget();
    });
  }
  // As numbers, and back.
  void save(std::vector<double>& all) const {
    for (const auto& g : gravity.components()) g->save(all);
    each([&](EffectInstance& instance) {
      if (const Amount* a = instance.amount()) a->save(all);
      if (const LivePose* p = instance.pose()) p->save(all);
    });
  }
  void load(std::span<const double> all) {
    for (auto& g : gravity.components()) g->load(all);
    each([&](EffectInstance& instance) {
      if (Amount* a = instance.amount()) a->load(all);
      if (LivePose* p = instance.pose()) p->load(all);
    });
  }
  // Whether numbers are amounts of these effects.
  bool fit(std::span<const double> all) const {
    bool fits = true;
    for (std::size_t k = 0; k < gravity.components().size(); ++k) fits = fits && Amount::take(all);
    each([&](EffectInstance& instance) {
      fits = fits && (!instance.amount() || Amount::take(all)) && (!instance.pose() || LivePose::take(all));
    });
    return fits && all.empty();
  }
  // Adds what a host has set; false where it has set nothing.
  bool add_set_by_host(Hash& hash) const {
    bool any = false;
    const auto add = [&](const auto& one) {
      if (!one.set_by_host()) return;
      std::vector<double> numbers;
      one.save(numbers);
      hash.add(std::span<const double>(numbers));
      any = true;
    };
    for (const auto& g : gravity.components()) add(*g);
    each([&](EffectInstance& instance) {
      if (const Amount* a = instance.amount()) add(*a);
      if (const LivePose* p = instance.pose()) add(*p);
    });
    return any;
  }

 private:
  template <class F>
  void each(F&& f) const {
    for (const auto& instance : instances_) {
      if (instance) f(*instance);
    }
  }

  const std::vector<std::unique_ptr<EffectInstance>>& instances_;
};

}  // namespace isochor
