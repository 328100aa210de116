#include "page_encoding.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstddef>

namespace isochor::page {

namespace {

template <class T>
void append_planes(std::vector<std::uint8_t>& bytes, std::span<const T> values) {
  const std::size_t start = bytes.size();
  const std::size_t count = values.size();
  bytes.resize(start + count * sizeof(T));
  T previous = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const T step = static_cast<T>(values[i] - previous);
    previous = values[i];
    for (std::size_t k = 0; k < sizeof(T); ++k) {
      bytes[start + k * count + i] = static_cast<std::uint8_t>(step >> (8 * k));
    }
  }
}

std::string base64(std::span<const std::uint8_t> bytes) {
  static constexpr std::string_view digits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t here = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = group << 8 | (k < here ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) out += k <= here ? digits[group >> (18 - 6 * k) & 63u] : '=';
  }
  return out;
}

// Length of the valid UTF-8 sequence at the start of the text; 0 when there is none. Browsers replace broken
// bytes silently, but a JSON string must not swallow the quote that follows them.
std::size_t utf8_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char lead = byte(0);
  if (lead < 0x80) return 1;
  const std::size_t length = lead >= 0xf0 && lead < 0xf5 ? 4 : lead >= 0xe0 ? 3 : lead >= 0xc2 ? 2 : 0;
  if (length == 0 || lead >= 0xf5 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xc0) != 0x80) return 0;
  }
  return length;
}

}  // namespace

void BlockWriter::integers(std::span<const std::uint16_t> values) {
  append_planes(bytes_, values);
}
void BlockWriter::integers(std::span<const std::uint32_t> values) {
  append_planes(bytes_, values);
}

void BlockWriter::u32(std::uint32_t value) {
  for (int k = 0; k < 4; ++k) bytes_.push_back(static_cast<std::uint8_t>(value >> (8 * k)));
}

void BlockWriter::points(std::span<const Vec3> points) {
  u32(static_cast<std::uint32_t>(points.size()));
  for (const Vec3& p : points) {
    for (int axis = 0; axis < 3; ++axis) u32(std::bit_cast<std::uint32_t>(static_cast<float>(p[axis])));
  }
}

std::string packed(std::span<const std::uint8_t> bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::vector<std::uint8_t> out(size);
  const int status =
      compress2(out.data(), &size, bytes.data(), static_cast<uLong>(bytes.size()), Z_DEFAULT_COMPRESSION);
  if (status != Z_OK) return {};
  return base64({out.data(), static_cast<std::size_t>(size)});
}

bool finite(const Vec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

void Box::add(const Vec3& p) {
  if (!finite(p)) return;
  if (empty) low = high = p;
  empty = false;
  for (int axis = 0; axis < 3; ++axis) {
    low[axis] = std::min(low[axis], p[axis]);
    high[axis] = std::max(high[axis], p[axis]);
  }
}

void Box::add(const Box& other) {
  if (other.empty) return;
  add(other.low);
  add(other.high);
}

std::vector<std::uint16_t> quantize_points(std::span<const Vec3> points, std::span<const Vec3> rest,
                                           const Box& box) {
  std::vector<std::uint16_t> codes;
  codes.reserve(points.size() * 3);
  for (int axis = 0; axis < 3; ++axis) {
    const double extent = box.high[axis] - box.low[axis];
    const double steps = extent > 0 ? 65535 / extent : 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3& p = finite(points[i]) ? points[i] : rest[i];
      const double code = std::clamp((p[axis] - box.low[axis]) * steps, 0.0, 65535.0);
      codes.push_back(static_cast<std::uint16_t>(std::lround(code)));
    }
  }
  return codes;
}

namespace {

// What is left without the lowest and the highest 1/part of the values, which are put in another order.
FieldRange range_without(std::size_t part, std::vector<double>& values, bool zeros, FieldRange all) {
  if (values.empty()) return all;
  const auto quantile = [&](std::size_t place) {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(place);
    std::nth_element(values.begin(), at, values.end());
    return *at;
  };
  const std::size_t cut = values.size() / part;
  FieldRange out{quantile(cut), quantile(values.size() - 1 - cut)};
  if (zeros) out = {std::min(out.low, 0.0), std::max(out.high, 0.0)};
  return out;
}

}  // namespace

QuantizedField quantize_field(std::span<const double> values, std::span<const std::uint8_t> skip) {
  const auto skipped = [&](std::size_t i) { return !skip.empty() && skip[i] != 0; };
  QuantizedField out;
  bool any = false, zeros = false;
  std::vector<double> counted;
  counted.reserve(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double v = values[i];
    if (skipped(i)) continue;
    if (!std::isfinite(v)) {
      ++out.invalid;
      continue;
    }
    out.low = any ? std::min(out.low, v) : v;
    out.high = any ? std::max(out.high, v) : v;
    any = true;
    zeros = zeros || v == 0;
    if (v != 0) counted.push_back(v);
  }
  if (!any) out.low = out.high = std::nan("");
  out.usual = range_without(100, counted, zeros, {out.low, out.high});
  out.middle = range_without(20, counted, zeros, {out.low, out.high});
  // Halves first: the difference of two large numbers of opposite sign may overflow.
  const double half_span = 0.5 * out.high - 0.5 * out.low;
  out.codes.reserve(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double v = values[i];
    const double t = half_span > 0 ? (0.5 * v - 0.5 * out.low) / half_span : 0;
    const bool shown = std::isfinite(v) && !skipped(i);
    out.codes.push_back(shown ? static_cast<std::uint16_t>(std::lround(t * field_levels)) : invalid_code);
  }
  return out;
}

void append_json(std::string& out, double value) {
  if (!std::isfinite(value)) {
    out += "null";
    return;
  }
  std::array<char, 32> text{};
  // Nine digits: more than a plot or a color can show, and shorter by half than a full double.
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 9);
  out.append(text.data(), end.ptr);
}

void append_json(std::string& out, std::string_view text) {
  static constexpr std::string_view hex = "0123456789abcdef";
  out += '"';
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    const auto c = static_cast<unsigned char>(text.front());
    if (length == 0) {
      out += "\\ufffd";
    } else if (c < 0x20 || c == '"' || c == '\\' || c == '<' || c == '>' || c == '&') {
      out += "\\u00";
      out += hex[c >> 4];
      out += hex[c & 15];
    } else {
      out += text.substr(0, length);
    }
    text.remove_prefix(std::max<std::size_t>(1, length));
  }
  out += '"';
}

std::string escape_html(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '&')
      out += "&amp;";
    else
      out += c;
  }
  return out;
}

}  // namespace isochor::page
