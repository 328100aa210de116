#include "handles.h"

#include <algorithm>
#include <cstring>
#include <limits>

namespace isochor::c {

void Said::say(const std::string& message) noexcept {
  try {
    text_ = message;
    sentence_ = text_.c_str();
  } catch (...) {
    sentence_ = kNoMemory;
  }
}

void Said::turn_away(const char* sentence) {
  whom_ = std::this_thread::get_id();
  turned_away_ = sentence;
}

void Said::forget_turned_away() {
  if (whom_.load() == std::this_thread::get_id()) turned_away_ = nullptr;
}

const char* Said::get() const {
  const char* turned_away = turned_away_;
  if (turned_away != nullptr && whom_.load() == std::this_thread::get_id()) return turned_away;
  return sentence_;
}

void Buffer::say_fixed(const char* sentence) noexcept {
  if (text_ == nullptr || size_ == 0) return;
  std::size_t length = std::min(std::strlen(sentence), size_ - 1);
  // No character of several bytes is cut in two.
  while (length > 0 && (static_cast<unsigned char>(sentence[length]) & 0xc0u) == 0x80u) --length;
  std::memcpy(text_, sentence, length);
  text_[length] = '\0';
}

PartContext Keyring::context(const World& world) const {
  PartContext context;
  for (const auto& [name, id] : bodies) {
    if (world.check(id)) context.bodies.emplace_back(name, id);
  }
  for (const EffectId effect : world.effects()) context.names_taken.push_back(world.effect_name(effect));
  context.analysis = analysis;
  context.gravity = gravity;
  context.gravity_curve = gravity_curve;
  context.folder = folder;
  return context;
}

iso_status status_of(StepStatus status) {
  switch (status) {
    case StepStatus::converged:
      return ISO_OK;
    case StepStatus::rejected:
      return ISO_NOT_CONVERGED;
    case StepStatus::cancelled:
      return ISO_CANCELLED;
    case StepStatus::invalid:
      return ISO_REFUSED;
    case StepStatus::unfinished:
      return ISO_UNFINISHED;
  }
  return ISO_FAILED;
}

std::vector<std::string> texts(const char* const* list, std::size_t count, const char* name) {
  std::vector<std::string> all;
  if (count > 0) (void)given(list, name);
  for (std::size_t i = 0; i < count; ++i)
    all.push_back(text(list[i], (std::string(name) + "[" + std::to_string(i) + "]").c_str()));
  return all;
}

Vec3 vector(const double* xyz, const char* name) {
  (void)given(xyz, name);
  return {xyz[0], xyz[1], xyz[2]};
}

void put(const Vec3& v, double* xyz) {
  if (xyz == nullptr) return;
  xyz[0] = v.x;
  xyz[1] = v.y;
  xyz[2] = v.z;
}

std::vector<Vec3> vectors(const double* xyz, std::size_t count, std::size_t stride, const char* name) {
  constexpr std::size_t packed = 3 * sizeof(double);
  if (count > 0) (void)given(xyz, name);
  if (count > static_cast<std::size_t>(std::numeric_limits<Index>::max()))
    refuse(std::string(name) + " has " + std::to_string(count) + " vectors, more than a mesh can have");
  if (stride != 0 && stride < packed)
    refuse(std::string(name) + ": a stride of " + std::to_string(stride) +
           " bytes is less than the 24 of a vector; give 0 for vectors without gaps");
  std::vector<Vec3> all(count);
  const char* from = reinterpret_cast<const char*>(xyz);
  for (std::size_t i = 0; i < count; ++i) {
    double v[3];
    std::memcpy(v, from + i * (stride == 0 ? packed : stride), packed);
    all[i] = {v[0], v[1], v[2]};
  }
  return all;
}

BodyId body_of(const World& world, iso_body body) {
  if (body.world == 0) refuse("the body is no id that iso_add_body() or iso_find_body() gave");
  need(world.check(id(body)));
  return id(body);
}

EffectId effect_of(const World& world, iso_effect effect) {
  if (effect.world == 0) refuse("the effect is no id that iso_add() or iso_find_effect() gave");
  need(world.check(id(effect)));
  return id(effect);
}

}  // namespace isochor::c
