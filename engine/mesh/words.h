// Messages about meshes, put together from texts and numbers.
#pragma once

#include <string>
#include <string_view>
#include <type_traits>

namespace isochor::mesh_files {

// A number in its shortest exact form.
std::string shown(double value);
inline std::string shown(std::string_view text) {
  return std::string(text);
}
inline std::string shown(const char* text) {
  return text;
}
inline std::string shown(const std::string& text) {
  return text;
}
template <class T>
requires std::is_integral_v<T> std::string shown(T value) {
  return std::to_string(value);
}

template <class... Parts>
std::string join(const Parts&... parts) {
  std::string text;
  (text.append(shown(parts)), ...);
  return text;
}

// Text of a file fit for a message: short, quoted, without control characters.
std::string quoted(std::string_view raw);

}  // namespace isochor::mesh_files
