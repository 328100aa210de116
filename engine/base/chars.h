// std::from_chars and std::to_chars of real numbers, also where the standard library has them for whole
// numbers alone (libc++ 13, which is that of Debian's Emscripten).
#pragma once

#include <charconv>

#ifndef __cpp_lib_to_chars
#include <clocale>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#endif

namespace isochor {

template <class Whole>
std::from_chars_result from_chars(const char* first, const char* last, Whole& value) {
  return std::from_chars(first, last, value);
}

inline std::from_chars_result from_chars(const char* first, const char* last, double& value) {
#ifdef __cpp_lib_to_chars
  return std::from_chars(first, last, value);
#else
  // What strtod takes beyond: blanks, a plus and hexadecimal digits.
  const char* digits = first < last && *first == '-' ? first + 1 : first;
  const char* end = digits;
  while (end < last && std::strchr("0123456789.eE+-infatyINFATY", *end) && *end) ++end;
  const bool plain = digits < end && *digits != '+' && *digits != '-';
  if (!plain) return {first, std::errc::invalid_argument};
  static const locale_t c = newlocale(LC_ALL_MASK, "C", nullptr);
  const std::string text(first, end);
  char* stop = nullptr;
  const double read = strtod_l(text.c_str(), &stop, c);
  if (stop == text.c_str()) return {first, std::errc::invalid_argument};
  value = read;
  return {first + (stop - text.c_str()), std::errc()};
#endif
}

// As few digits as give the number back.
inline std::to_chars_result to_chars(char* first, char* last, double value) {
#ifdef __cpp_lib_to_chars
  return std::to_chars(first, last, value);
#else
  char text[32];
  int length = 0;
  for (int digits = 1; digits <= 17; ++digits) {
    length = std::snprintf(text, sizeof text, "%.*g", digits, value);
    if (std::strtod(text, nullptr) == value) break;
  }
  if (last - first < length) return {last, std::errc::value_too_large};
  std::memcpy(first, text, static_cast<std::size_t>(length));
  return {first + length, std::errc()};
#endif
}

}  // namespace isochor
