#include "live/guard.h"

#include <arpa/inet.h>
#include <unistd.h>

#include <algorithm>
#include <array>

namespace isochor::live {

std::string random_token() {
  std::array<unsigned char, 16> bytes{};
  if (getentropy(bytes.data(), bytes.size()) != 0) return {};
  static constexpr std::string_view digits = "0123456789abcdef";
  std::string out;
  for (const unsigned char b : bytes) {
    out += digits[b >> 4];
    out += digits[b & 15];
  }
  return out;
}

bool same_secret(std::string_view given, std::string_view secret) {
  if (given.size() != secret.size() || secret.empty()) return false;
  volatile unsigned char difference = 0;
  for (std::size_t i = 0; i < given.size(); ++i)
    difference = static_cast<unsigned char>(difference | (given[i] ^ secret[i]));
  return difference == 0;
}

namespace {

bool is_number(const std::string& name) {
  std::array<unsigned char, 16> bytes{};
  return inet_pton(AF_INET, name.c_str(), bytes.data()) == 1 ||
         inet_pton(AF_INET6, name.c_str(), bytes.data()) == 1;
}

std::string lower(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  return out;
}

}  // namespace

bool is_loopback(std::string_view host) {
  return host == "localhost" || host == "::1" || host.starts_with("127.");
}

Names::Names(std::string host, int port)
    : any_(host == "0.0.0.0" || host == "::"), port_(std::to_string(port)), names_{lower(host)} {
  if (any_ || is_loopback(host)) {
    for (const char* name : {"localhost", "127.0.0.1", "::1"}) names_.emplace_back(name);
  }
}

bool Names::host_allowed(std::string_view header) const {
  const std::string text = lower(header);
  const auto colon = text.rfind(':');
  if (colon == std::string::npos || text.substr(colon + 1) != port_) return false;
  std::string name = text.substr(0, colon);
  if (name.size() > 2 && name.front() == '[' && name.back() == ']')
    name = name.substr(1, name.size() - 2);
  else if (name.find(':') != std::string::npos)
    return false;
  if (any_ && is_number(name)) return true;
  return std::find(names_.begin(), names_.end(), name) != names_.end();
}

bool Names::origin_allowed(std::string_view origin, std::string_view host) const {
  if (origin.empty()) return true;
  return lower(origin) == "http://" + lower(host) && host_allowed(host);
}

bool Rate::take(Clock::time_point now) {
  if (begun_) {
    const double passed = std::chrono::duration<double>(now - last_).count();
    left_ = std::min(burst_, left_ + per_second_ * std::max(0.0, passed));
  }
  begun_ = true;
  last_ = now;
  if (left_ < 1) return false;
  left_ -= 1;
  return true;
}

}  // namespace isochor::live
