#include "engine/mesh/words.h"

#include "engine/base/chars.h"

namespace isochor::mesh_files {

std::string shown(double value) {
  char buffer[32];
  const auto [end, status] = isochor::to_chars(buffer, buffer + sizeof buffer, value);
  return status == std::errc() ? std::string(buffer, end) : std::string("?");
}

std::string quoted(std::string_view raw) {
  constexpr std::size_t longest = 40;
  std::string text = "'";
  for (const char c : raw.substr(0, longest)) text += (c >= ' ' && c <= '~') ? c : '?';
  return text + (raw.size() > longest ? "...'" : "'");
}

}  // namespace isochor::mesh_files
