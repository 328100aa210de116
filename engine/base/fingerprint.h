// A number for what a definition says: two scenes whose fingerprints are equal are the same. It is made of
// the numbers and words of the definitions alone, so that it is the same in every build and on every machine.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string_view>

#include "engine/base/base.h"
#include "engine/base/fields.h"
#include "isochor/ids.h"
#include "isochor/poses.h"

namespace isochor {

class Fingerprint {
 public:
  // Numbers, words, lists, pairs of them, pointers to what describes itself, and plain structs of these with
  // all their members.
  template <class... T>
  Fingerprint& add(const T&... values) {
    (one(values), ...);
    return *this;
  }
  std::uint64_t value() const { return hash_.value(); }
  // Puts the numbers of all bodies that definitions name there, too.
  void list_bodies(std::vector<Index>& numbers) { bodies_ = &numbers; }

 private:
  template <class T>
  void one(const T& v) {
    if constexpr (requires { v.describe(*this); }) {
      v.describe(*this);
    } else if constexpr (requires { v.number(); }) {
      hash_.add(static_cast<std::uint64_t>(v.number()));  // an id: whose it is says nothing about a scene
      if constexpr (std::is_same_v<T, BodyId>) {
        if (bodies_) bodies_->push_back(v.number());
      }
    } else if constexpr (std::is_floating_point_v<T>) {
      const double d = v == 0 ? 0.0 : static_cast<double>(v);  // of both signs
      hash_.add(&d, sizeof d);
    } else if constexpr (std::is_enum_v<T> || std::is_integral_v<T>) {
      hash_.add(static_cast<std::uint64_t>(v));
    } else if constexpr (std::is_convertible_v<const T&, std::string_view>) {
      const std::string_view text = v;
      hash_.add(text.size());
      hash_.add(text.data(), text.size());
    } else {
      for_each_field(v, [this](const auto& member) { one(member); });
    }
  }
  template <class T>
  void one(const std::vector<T>& list) {
    hash_.add(list.size());
    if constexpr (std::is_same_v<T, Index> || std::is_same_v<T, Vec3>)
      hash_.add(std::span<const T>(list));
    else
      for (const T& item : list) one(item);
  }
  template <class T, std::size_t N>
  void one(const std::array<T, N>& list) {
    for (const T& item : list) one(item);
  }
  template <class T>
  void one(const std::optional<T>& v) {
    hash_.add(static_cast<std::uint64_t>(v.has_value()));
    if (v) one(*v);
  }
  template <class T>
  void one(const std::shared_ptr<T>& v) {
    hash_.add(static_cast<std::uint64_t>(v != nullptr));
    if (v) v->describe(*this);
  }
  // Where a track was read from does not matter.
  void one(const PoseTrack& track) { one(track.keys); }

  Hash hash_;
  std::vector<Index>* bodies_ = nullptr;
};

}  // namespace isochor
