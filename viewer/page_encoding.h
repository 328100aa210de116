// How numbers and words stand in the results page. viewer/web/src/data.js reads what this writes.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "isochor/types.h"

namespace isochor::page {

// zlib stream in base64; empty when zlib failed (out of memory).
std::string packed(std::span<const std::uint8_t> bytes);

// Bytes of one block before compression.
class BlockWriter {
 public:
  // Differences to the predecessor, split in byte planes: neighbors are alike, so the upper planes are
  // nearly constant and compress to little.
  void integers(std::span<const std::uint16_t> values);
  void integers(std::span<const std::uint32_t> values);
  // A count and the points as little-endian floats.
  void points(std::span<const Vec3> points);

  std::string packed() const { return page::packed(bytes_); }

 private:
  void u32(std::uint32_t value);
  std::vector<std::uint8_t> bytes_;
};

// Smallest box around the finite points.
struct Box {
  Vec3 low, high;
  bool empty = true;

  void add(const Vec3& p);
  void add(const Box& other);
};

bool finite(const Vec3& p);

// Coordinates as 16-bit steps of the box, axis after axis. Points that are not finite take those of rest.
std::vector<std::uint16_t> quantize_points(std::span<const Vec3> points, std::span<const Vec3> rest,
                                           const Box& box);

inline constexpr std::uint16_t invalid_code = 65535;
inline constexpr int field_levels = 4095;  // finer than any display, and the noise below is not stored

struct FieldRange {
  double low = 0, high = 0;
};

struct QuantizedField {
  std::vector<std::uint16_t> codes;
  double low = 0, high = 0;
  std::size_t invalid = 0;  // values that were not finite
  // From the first to the 99th hundredth of the values, and from the fifth to the 95th: what one hot spot, or
  // a stiff layer, does not set. Exact zeros, where nothing is (no contact), are in the range but not among
  // the values it is taken from.
  FieldRange usual, middle;
};
// Values whose entry in skip is not zero are coded as invalid, but neither counted nor in the range. An empty
// skip skips nothing.
QuantizedField quantize_field(std::span<const double> values, std::span<const std::uint8_t> skip = {});

// JSON text, safe inside a <script> element. Numbers that are not finite become null.
void append_json(std::string& out, double value);
void append_json(std::string& out, std::string_view text);

std::string escape_html(std::string_view text);

}  // namespace isochor::page
