// Plain structs as bytes and back, for states and checkpoints of one machine's kind: numbers stand as they do
// in memory. A reader takes nothing on trust: lengths are held against what is there.
#pragma once

#include <optional>

#include "engine/base/base.h"
#include "engine/base/fields.h"

namespace isochor {

class ByteWriter {
 public:
  // Numbers, texts, lists, optional values, and plain structs of these.
  template <class T>
  void put(const T& v) {
    if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>)
      raw(&v, sizeof v);
    else
      for_each_field(v, [this](const auto& member) { this->put(member); });
  }
  void put(const std::string& text) {
    put(static_cast<std::uint64_t>(text.size()));
    raw(text.data(), text.size());
  }
  template <class T>
  void put(const std::vector<T>& list) {
    put(static_cast<std::uint64_t>(list.size()));
    if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, Vec3>)
      raw(list.data(), list.size() * sizeof(T));
    else
      for (const T& item : list) put(item);
  }
  template <class T>
  void put(const std::optional<T>& v) {
    put(v.has_value());
    if (v) put(*v);
  }
  // Ends the bytes with a checksum over all of them; their number goes where a zero of 64 bits was put for
  // it.
  std::vector<std::byte> sealed(std::size_t length_at) && {
    const std::uint64_t length = bytes_.size() + sizeof(std::uint64_t);
    std::memcpy(bytes_.data() + length_at, &length, sizeof length);
    Hash h;
    h.add(std::span<const std::byte>(bytes_));
    put(h.value());
    return std::move(bytes_);
  }

 private:
  void raw(const void* data, std::size_t count) {
    const auto* p = static_cast<const std::byte*>(data);
    bytes_.insert(bytes_.end(), p, p + count);
  }
  std::vector<std::byte> bytes_;
};

class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : left_(bytes) {}
  // Whether the checksum at the end fits; it is taken off.
  bool unseal() {
    constexpr std::size_t size = sizeof(std::uint64_t);
    if (left_.size() < size) return false;
    std::uint64_t kept = 0;
    std::memcpy(&kept, left_.data() + left_.size() - size, size);
    left_ = left_.first(left_.size() - size);
    Hash h;
    h.add(left_);
    return h.value() == kept;
  }
  // False where the bytes end too early or cannot be such a value.
  template <class T>
  bool take(T& v) {
    if constexpr (std::is_same_v<T, bool>) {
      std::uint8_t byte = 0;
      const bool good = raw(&byte, 1) && byte <= 1;
      v = byte == 1;
      return good;
    } else if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
      return raw(&v, sizeof v);
    } else {
      bool good = true;
      for_each_field(v, [&](auto& member) { good = good && take(member); });
      return good;
    }
  }
  bool take(std::string& text) {
    std::uint64_t size = 0;
    if (!take(size) || size > left_.size()) return false;
    text.resize(size);
    return raw(text.data(), size);
  }
  template <class T>
  bool take(std::vector<T>& list) {
    std::uint64_t size = 0;
    // No item takes less than a byte.
    if (!take(size) || size > left_.size()) return false;
    if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, Vec3>) {
      if (size > left_.size() / sizeof(T)) return false;
      list.resize(size);
      return raw(list.data(), size * sizeof(T));
    } else {
      list.clear();
      for (std::uint64_t i = 0; i < size; ++i) {
        if (!take(list.emplace_back())) return false;
      }
      return true;
    }
  }
  template <class T>
  bool take(std::optional<T>& v) {
    bool has = false;
    v.reset();
    return take(has) && (!has || take(v.emplace()));
  }
  std::size_t left() const { return left_.size(); }

 private:
  bool raw(void* data, std::size_t count) {
    if (left_.size() < count) return false;
    if (count > 0) std::memcpy(data, left_.data(), count);  // of nothing there is no address
    left_ = left_.subspan(count);
    return true;
  }
  std::span<const std::byte> left_;
};

}  // namespace isochor
