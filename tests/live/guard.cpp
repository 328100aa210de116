// Who may talk to the server.
#include "live/guard.h"

#include <set>

#include "catch.h"

using namespace isochor::live;

TEST_CASE("tokens are long, of hexadecimal digits, and never the same") {
  std::set<std::string> seen;
  for (int i = 0; i < 100; ++i) {
    const std::string t = random_token();
    CHECK(t.size() == 32);
    CHECK(t.find_first_not_of("0123456789abcdef") == std::string::npos);
    seen.insert(t);
  }
  CHECK(seen.size() == 100);
}

TEST_CASE("a secret is the same in every digit or not at all") {
  const std::string secret = random_token();
  CHECK(same_secret(secret, secret));
  for (std::size_t i = 0; i < secret.size(); ++i) {
    std::string other = secret;
    other[i] = other[i] == '0' ? '1' : '0';
    CHECK_FALSE(same_secret(other, secret));
  }
  CHECK_FALSE(same_secret("", secret));
  CHECK_FALSE(same_secret(secret.substr(1), secret));
  CHECK_FALSE(same_secret(secret + "0", secret));
  // Without a secret nobody may.
  CHECK_FALSE(same_secret("", ""));
}

TEST_CASE("a server on loopback has the names of loopback, with its port") {
  const Names names("127.0.0.1", 8421);
  for (const char* good : {"127.0.0.1:8421", "localhost:8421", "LOCALHOST:8421", "[::1]:8421"}) {
    INFO(good);
    CHECK(names.host_allowed(good));
  }
  for (const char* bad :
       {"", "127.0.0.1", "localhost", "127.0.0.1:8422", "evil.com:8421", "127.0.0.1.evil.com:8421",
        "localhost.:8421", "::1:8421", "192.168.0.2:8421", "localhost:8421:8421", "127.0.0.1:8421 ",
        "user@127.0.0.1:8421", "0x7f000001:8421"}) {
    INFO(bad);
    CHECK_FALSE(names.host_allowed(bad));
  }
}

TEST_CASE("a server on all addresses is known by numbers, which cannot be rebound") {
  const Names names("0.0.0.0", 80);
  CHECK(names.host_allowed("192.168.0.2:80"));
  CHECK(names.host_allowed("[fe80::1]:80"));
  CHECK(names.host_allowed("localhost:80"));
  CHECK_FALSE(names.host_allowed("evil.com:80"));
  const Names named("robot.lab", 80);
  CHECK(named.host_allowed("robot.lab:80"));
  CHECK_FALSE(named.host_allowed("localhost:80"));
}

TEST_CASE("a page of another site may not ask") {
  const Names names("127.0.0.1", 8421);
  CHECK(names.origin_allowed("", "127.0.0.1:8421"));
  CHECK(names.origin_allowed("http://127.0.0.1:8421", "127.0.0.1:8421"));
  for (const char* bad : {"null", "http://evil.com", "https://127.0.0.1:8421", "http://127.0.0.1:9999",
                          "http://localhost:8421", "http://127.0.0.1:8421.evil.com"}) {
    INFO(bad);
    CHECK_FALSE(names.origin_allowed(bad, "127.0.0.1:8421"));
  }
  CHECK_FALSE(names.origin_allowed("http://evil.com:8421", "evil.com:8421"));
}

TEST_CASE("a rate lets a burst through, and then so many a second") {
  Rate rate(10, 5);
  Rate::Clock::time_point now{};
  int taken = 0;
  for (int i = 0; i < 100; ++i) taken += rate.take(now);
  CHECK(taken == 5);
  for (int i = 0; i < 1000; ++i) taken += rate.take(now += std::chrono::milliseconds(10));
  CHECK(taken >= 5 + 99);
  CHECK(taken <= 5 + 101);
  // A clock that goes back gives nothing away.
  Rate still(10, 1);
  CHECK(still.take(now));
  CHECK_FALSE(still.take(now - std::chrono::hours(1)));
}
