// Who may talk to the server: tokens, addresses and rates. Knows no network.
#pragma once

#include <chrono>
#include <string>
#include <string_view>
#include <vector>

namespace isochor::live {

// 128 bits of the system's random numbers in hexadecimal digits; empty where there are none.
std::string random_token();

// Takes the same time wherever two texts of one length differ.
bool same_secret(std::string_view given, std::string_view secret);

// Which names a browser may have for this server. A page of another site that has its own name lead to this
// machine (DNS rebinding) comes with that name, which is refused; numbers cannot be rebound.
class Names {
 public:
  // `host` is the address that is listened on, or a name of it.
  Names(std::string host, int port);
  // Of the header Host: this server under a name of its own, with its port.
  bool host_allowed(std::string_view header) const;
  // Of the header Origin, which is absent where no browser asks: a page of this server itself.
  bool origin_allowed(std::string_view origin, std::string_view host) const;

 private:
  bool any_ = false;  // listens on all addresses: any that is a number
  std::string port_;
  std::vector<std::string> names_;
};

bool is_loopback(std::string_view host);

// So many a second on average, a burst at once.
class Rate {
 public:
  using Clock = std::chrono::steady_clock;
  Rate(double per_second, double burst) : per_second_(per_second), burst_(burst), left_(burst) {}
  bool take(Clock::time_point now);

 private:
  double per_second_, burst_, left_;
  Clock::time_point last_{};
  bool begun_ = false;
};

}  // namespace isochor::live
