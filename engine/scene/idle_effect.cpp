#include "engine/base/fingerprint.h"
#include "engine/scene/builder.h"
#include "isochor/effects/idle.h"

namespace isochor {

namespace {

class IdleInstance final : public EffectInstance {};

class IdleEffect final : public EffectSource {
 public:
  explicit IdleEffect(std::string name) : name_(std::move(name)) {}
  const std::string& name() const override { return name_; }
  void describe(Fingerprint& f) const override { f.add(std::string("idle"), name_); }
  Result<std::unique_ptr<EffectInstance>> build(Builder&) const override {
    return std::unique_ptr<EffectInstance>(std::make_unique<IdleInstance>());
  }

 private:
  std::string name_;
};

}  // namespace

EffectPtr idle(std::string name) {
  return std::make_shared<IdleEffect>(std::move(name));
}

}  // namespace isochor
